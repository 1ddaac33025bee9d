/// One link as the solver sees it: convex elements in the object's frame under a bounding volume hierarchy.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "collision_node/geometry/bvh.h"
#include "collision_node/geometry/shape.h"
#include "collision_node/geometry/wide_bvh.h"

namespace collision_node::geometry {

/// A core's own axes, for what is faster there. A box, a segment and a point are those of a box with half
/// lengths `half`, which a segment has along z only; a cylinder has its axis along z and `half` unused.
struct CoreFrame {
  Vec3 centre;   ///< [m], object frame
  Vec3 half;     ///< [m]
  double reach;  ///< largest distance of a point of the core from the object's origin, to rounding [m]
  bool aligned;  ///< the axes are the object's own
  Mat3 axes;     ///< columns, orthonormal to rounding
};

/// A convex set: the hull of `count` vertices, or a solid cylinder, grown by `radius` in all directions.
/// A triangle, box (8 vertices), convex hull, point/sphere (1 vertex) and capsule (2 vertices) are all of
/// this form.
struct Element {
  const Vec3* vertices = nullptr;  ///< [m], object frame; null for a cylinder
  int count = 0;
  double radius = 0.0;               ///< [m]
  const CoreFrame* frame = nullptr;  ///< null for triangles and hulls; a box's corner i is beyond the centre
                                     ///< along axis k if i has bit k
  // cylinder core, when vertices == nullptr
  Vec3 centre = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();  ///< unit
  double rim_radius = 0.0;    ///< [m]
  double half_length = 0.0;   ///< [m]
  int shape = -1;             ///< index into the body's shapes
  int triangle = -1;          ///< index into the mesh's triangles, -1 for a primitive
};

/// Immutable after construction, but for what says otherwise; safe to share between threads.
class Body {
 public:
  /// `shapes` are placed in the object's frame. Throws std::invalid_argument when empty,
  /// and when one reaches beyond kLargestLength.
  explicit Body(std::vector<PlacedShape> shapes);
  Body(const Body&) = delete;  // elements point into their own body
  Body& operator=(const Body&) = delete;
  /// Of a body that is one cylinder along its z axis and that nobody else looks at: makes it another one.
  /// Asks for no memory.
  void resize(const Cylinder& cylinder, const Vec3& centre);

  const std::vector<PlacedShape>& shapes() const { return shapes_; }
  std::int32_t elementCount() const { return element_count_; }
  /// Elements below this are triangles, the others primitives.
  std::int32_t triangleCount() const { return triangle_count_; }
  /// For paths of points and spheres past a body of triangles only; built by the first call, from any thread.
  const WideBvh& wideBvh() const {
    const WideBvh* built = wide_ready_.load(std::memory_order_acquire);
    return built != nullptr ? *built : buildWide();
  }
  /// Fills `buffer[0..2]` for a triangle; the returned view points into `buffer` or into the body.
  Element element(std::int32_t id, Vec3* buffer) const;
  /// The same for what is no triangle.
  const Element& primitive(std::int32_t id) const {
    return primitives_[static_cast<std::size_t>(id - triangle_count_)].element;
  }
  /// Asks for what a query of the first primitive will look at.
  void prefetch() const {
    if (primitives_.empty()) return;
    const char* const first = reinterpret_cast<const char*>(primitives_.data());
    for (std::size_t line = 0; line < sizeof(Primitive); line += 64) __builtin_prefetch(first + line);
  }
  int shapeOf(std::int32_t id) const;              ///< index into shapes()
  std::int32_t triangleOf(std::int32_t id) const;  ///< index into its mesh's triangles

  const Bvh& bvh() const { return bvh_; }
  const std::vector<int>& solids() const { return solids_; }  ///< shapes that are closed meshes
  /// One point of every connected component of the body: if none is inside a solid, and the surfaces are
  /// apart, nothing of this body is inside it.
  const std::vector<Vec3>& representatives() const { return representatives_; }
  double reach() const { return reach_; }         ///< >= distance of any point from the object's origin [m]
  Vec3 centre() const { return bvh_.centre(0); }  ///< of the bounding sphere
  /// What placing the shapes in the object's frame rounded, for any point of the body [m].
  double placingError() const { return placing_error_; }
  double radius() const { return radius_; }  ///< of the bounding sphere about centre() [m]

 private:
  /// What is no triangle, and what a query of it looks at, in one place.
  struct alignas(64) Primitive {
    static constexpr int kCorners = 8;

    Element element;
    CoreFrame frame;
    std::array<Vec3, kCorners> corners;  ///< where there are no more: hull_vertices_ has the others
  };

  /// `vertices` in the object's frame; none for a cylinder. Where they are kept is known when all are there.
  void checkReach(const Vec3& place, int shape) const;
  void addPrimitive(Element element, const CoreFrame& frame, const std::vector<Vec3>& vertices);
  void storeInOrderOfTheTree(const std::vector<std::int32_t>& order);
  /// Sets radius_ and reach_.
  void measure();
  const WideBvh& buildWide() const;

  // What a query of a primitive asks comes first, and so lies together.
  double radius_ = 0.0, reach_ = 0.0, placing_error_ = 0.0;
  std::int32_t triangle_count_ = 0, element_count_ = 0;
  std::vector<Primitive> primitives_;
  mutable std::atomic<const WideBvh*> wide_ready_{nullptr};
  Bvh bvh_;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<int> solids_;
  std::vector<Vec3> representatives_;
  std::vector<std::vector<Vec3>> hull_vertices_;
  std::vector<std::int32_t> first_triangle_of_shape_;  ///< as loaded; -1: not a mesh
  std::vector<PlacedShape> shapes_;
  mutable std::once_flag wide_built_;
  mutable std::unique_ptr<const WideBvh> wide_;
};

}  // namespace collision_node::geometry
