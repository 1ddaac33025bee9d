/// A point or a sphere on a straight path past triangles that do not turn: when does it meet them first?
///
/// Guarantee, in exact arithmetic of the loaded geometry and the motion model:
///   kClear       the body's core stays farther than the contact's radius from every triangle, throughout.
///   kContact     the same holds on [from, lower); contact is proved at or before `upper`; and with radius 0
///   the point
///                has passed through all that it met since `lower` by then.
///   kCannotTell  nothing is claimed: a graze, an end of the time inside a bracket, or too many triangles at
///   once.
/// Watertight: a passage through a shared edge or vertex is one contact, proved with all the triangles around
/// it. Derivation: docs/solver.md, "Straight paths".
#pragma once

#include <optional>

#include "collision_node/impact/pair_piece.h"
#include "collision_node/impact/path_walk.h"

namespace collision_node::impact {

struct PathContact {
  enum class Kind { kClear, kContact, kCannotTell };
  static constexpr int kMost = 24;

  /// A triangle that is met, or may be, in the bracket.
  struct Met {
    std::int32_t element;
    std::int32_t vertex[3];
    double lower, upper;  ///< the part of the time on which it can be (radius > 0: begin to be) met [s]
    bool sure;            ///< it is met
    bool forward;  ///< radius 0 and sure: from the side that its corners go round clockwise to the other
  };

  Kind kind = Kind::kClear;
  double lower = 0.0, upper = 0.0;  ///< [s] from the piece's start
  int count = 0;
  Met met[kMost];           ///< those of the bracket, first the one that is reported
  std::uint64_t tests = 0;  ///< nodes and leaves that were looked at
};

/// Closest point of a triangle by the region of its plane that x lies over (C. Ericson 2005). A proposal:
/// what is proved from it holds for any point of the triangle.
Vec3 closestOnTriangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

class StraightPath {
 public:
  /// The pair as a path, if it is one: one body a single vertex, the other triangles only and without spin,
  /// and both positions linear in time. The vertex's own spin matters only where it is off its object's
  /// origin. The bodies must outlive the path.
  static std::optional<StraightPath> of(const Body& a, const Body& b, const Piece& piece,
                                        double contact_distance);

  struct Pair {
    const Body &a, &b;
    const Piece& piece;
    double contact_distance;
    bool point_is_a;
  };
  explicit StraightPath(const Pair& pair);  ///< of() knows which pairs are a path

  /// The first contact in [from, to]. Brackets wider than `width` are not reported, unless rounding alone
  /// makes them so: 16 budgets over the normal speed, 8 over the speed.
  void first(double from, double to, double width, PathContact& contact, Lanes lanes = fastestLanes()) const;

  /// At time 0 the body is clear of the box of all triangles, and so outside whatever they enclose.
  bool startsOutside() const;

  const Body& mesh() const { return *mesh_; }
  const Body& single() const { return *single_; }
  bool pointIsA() const { return point_is_a_; }
  double duration() const { return line_.duration; }  ///< of the piece [s]
  double radius() const { return radius_; }  ///< of the contact: the sphere's and the contact distance [m]
  double contactDistance() const { return contact_distance_; }  ///< [m]
  /// [m] Between this path and the exact one, at any time of the piece.
  double error() const { return error_; }
  double pointError() const { return point_error_; }    ///< [m] as PairPiece::point_error
  double speed() const { return speed_; }               ///< [m/s], rounded up
  double maxDistance() const { return max_distance_; }  ///< [m] of the two origins
  Vec3 at(double t) const { return p_ + t * v_; }       ///< in the triangles' frame
  const Vec3& velocity() const { return v_; }           ///< [m/s]
  const motion::LinearPart& line() const { return line_; }
  const Mat3& toWorld() const { return to_world_; }  ///< the triangles' axes in the world's
  const WideBvh& triangles() const { return *bvh_; }

  /// Of the triangles' axes, however computed [rad].
  static constexpr double kTurnError = 64.0 * kUnit;

 private:
  class PointVisitor;
  class SphereVisitor;
  void firstOfPoint(double from, double to, double width, PathContact& contact, Lanes lanes) const;
  void firstOfSphere(double from, double to, double width, PathContact& contact, Lanes lanes) const;
  bool provesPassage(const PathContact& contact) const;

  const Body *mesh_, *single_;
  const WideBvh* bvh_;
  bool point_is_a_;
  motion::LinearPart line_;
  Mat3 to_world_;
  Vec3 p_, v_;
  double contact_distance_, radius_, point_error_, error_, speed_, max_distance_;
  double size_;  ///< bounds every offset between the path and a vertex [m]
  ShearedFrame frame_;
};

}  // namespace collision_node::impact
