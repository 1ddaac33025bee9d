/// Methods A and B of M. Ma, G. Xu, X. Zhan, X. Yang, "Collision Detection Methods for High-speed Virtual
/// Simulation Objects", as pair methods. What they promise, what they miss and how the text was read:
/// docs/paper_methods.md.
///
/// Common to both. One object is the reference A, the other, B, is a particle: the object with the smaller
/// bounding radius (equal radii: the second), standing at the centre of its only primitive, else of its
/// bounding sphere. A does not rotate during a piece: its orientation at the piece's start is used. Per piece
/// the nearest hit, if any, is one event: IMPACT, UNCERTIFIED, reason METHOD, toi_lower = toi_upper,
/// position_error NaN, normal_error pi. Neither knows separations, initial overlap, contact distance or
/// budgets: a particle that enters a body in one piece and leaves it in the next gives an IMPACT each time.
/// Cost: every triangle of A, once the bounding sphere is met.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "collision_node/impact/pair_method.h"

namespace collision_node::impact {

enum class PaperVariant { kA, kB };

/// How a point of a triangle's plane is judged to lie in the triangle ABC.
enum class InsideTest {
  kThreeSigns,  ///< against AB, BC and CA: what the text must mean, and our default
  kTwoSigns     ///< against AB and BC only, as printed: also accepts points beyond the edge CA
};

/// `p` lies in the plane of `corners`; true on the boundary. A triangle without area holds nothing.
bool insideTriangle(const Vec3& p, const std::array<Vec3, 3>& corners, InsideTest test);

/// A triangle that stands for part of a primitive of A.
struct PaperTriangle {
  std::array<Vec3, 3> corners;  ///< object frame [m]
  int shape = -1;               ///< index into the body's shapes
  Feature feature = Feature::kFace;
};

/// The paper wants triangles. A box gives its 12; round shapes are inscribed with `kPaperSides` steps per
/// turn, always the same way; a convex hull gives its mesh's triangles as loaded; points and meshes give none
/// here (the methods read a mesh's triangles from the body).
constexpr int kPaperSides = 48;
std::vector<PaperTriangle> tessellatePrimitives(const geometry::Body& body);

/// makePaperA and makePaperB are this with InsideTest::kThreeSigns. The bodies must outlive the method.
std::unique_ptr<PairMethod> makePaper(PaperVariant variant, InsideTest inside, const geometry::Body& a,
                                      const geometry::Body& b);

}  // namespace collision_node::impact
