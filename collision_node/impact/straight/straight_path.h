/// A point or a sphere on a straight path past triangles that do not turn: when does it meet them first?
///
/// Guarantee, in exact arithmetic of the loaded geometry and the motion model:
///   kClear       the body's core stays farther than the contact's radius from every triangle, throughout.
///   kContact     the same holds on [from, lower); contact is proved at or before `upper`; and with radius 0
///                the point has passed through all that it met since `lower` by then.
///   kCannotTell  nothing is claimed: a graze, an end of the time inside a bracket, or too many triangles at
///                once.
/// Watertight: a passage through a shared edge or vertex is one contact, proved with all the triangles around
/// it. The path and its budget are straight_path.cpp's; what a point passes, straight_point.cpp's; what a
/// sphere touches, straight_sphere.cpp's. Derivation: docs/solver.md, "Straight paths".
#pragma once

#include <optional>

#include "collision_node/impact/pair_piece.h"
#include "collision_node/impact/straight/path_contact.h"
#include "collision_node/impact/straight/path_walk.h"

namespace collision_node::impact {

class StraightPath {
 public:
  /// The pair as a path, if it is one: one body a single vertex, the other triangles only and without spin,
  /// and both positions linear in time. The vertex's own spin matters only where it is off its object's
  /// origin. The bodies must outlive the path.
  static std::optional<StraightPath> of(const Body& a, const Body& b, const Piece& piece,
                                        double contact_distance) {
    if (a.triangleCount() + b.triangleCount() == 0) return std::nullopt;  // most pairs of primitives
    return pastMesh(a, b, piece, contact_distance);
  }

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
  /// A vector of the triangles' frame in the world's axes.
  Vec3 inWorld(const Vec3& v) const { return turned_ ? Vec3(to_world_ * v) : v; }
  const WideBvh& triangles() const { return *bvh_; }

  /// Of the triangles' axes, however computed [rad].
  static constexpr double kTurnError = 64.0 * kUnit;

 private:
  static std::optional<StraightPath> pastMesh(const Body& a, const Body& b, const Piece& piece,
                                              double contact_distance);
  class PointVisitor;
  class SphereVisitor;
  void firstOfPoint(double from, double to, double width, PathContact& contact, Lanes lanes) const;
  void firstOfSphere(double from, double to, double width, PathContact& contact, Lanes lanes) const;
  bool provesPassage(const PathContact& contact) const;
  void setBudget(const Piece& piece);

  const Body *mesh_, *single_;
  const WideBvh* bvh_;
  bool point_is_a_, turned_;
  motion::LinearPart line_;
  Mat3 to_world_;  ///< where the triangles are turned
  Vec3 p_, v_;
  double contact_distance_, radius_, point_error_, error_, speed_, max_distance_;
  double size_;  ///< bounds every offset between the path and a vertex [m]
  ShearedFrame frame_;
};

}  // namespace collision_node::impact
