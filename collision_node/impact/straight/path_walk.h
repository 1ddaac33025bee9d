/// Which triangles can a straight path come near? A walk over a wide hierarchy, nearest boxes first.
///
/// Guarantee: every triangle that the path, anywhere in its tube of `reach`, meets before the limit in force
/// is visited. The numbers that decide are the same on any machine and for any number of lanes; more lanes
/// are only faster. Derivation: docs/solver.md, "Straight paths". Sources: T. Ize 2013 (robust box test), S.
/// Woop, C. Benthin, I. Wald 2013 (sheared frame).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "collision_node/geometry/wide_bvh.h"

namespace collision_node::impact {

using geometry::Vec3;
using geometry::WideBvh;
using geometry::WideLeaf;

/// How many numbers one instruction holds; the results are the same.
enum class Lanes { kBaseline, kAvx2 };
Lanes fastestLanes();  ///< of this processor

/// The frame of a path: axis z is the one along which it moves most, x and y are sheared so that it stands
/// still in them. A vertex is at (x, y) = what is left of its offset from `origin` there, z its depth along
/// the path.
struct ShearedFrame {
  void follow(const Vec3& o, const Vec3& velocity) {
    constexpr int kAxis[5] = {0, 1, 2, 0, 1};
    const double x = std::abs(velocity[0]), y = std::abs(velocity[1]), z = std::abs(velocity[2]);
    kz = z > std::max(x, y) ? 2 : y > x ? 1 : 0;
    kx = kAxis[kz + 1];
    ky = kAxis[kz + 2];
    rate = velocity[kz];
    per_rate = 1.0 / rate;
    origin[0] = o[kx];
    origin[1] = o[ky];
    origin[2] = o[kz];
    shear_x = velocity[kx] * per_rate;
    shear_y = velocity[ky] * per_rate;
  }

  int kx, ky, kz;
  double origin[3];  ///< along kx, ky, kz
  double shear_x, shear_y;
  double rate;         ///< velocity along kz, never 0
  double per_rate;     ///< its reciprocal
  double error = 0.0;  ///< [m] of any sheared coordinate, against those of the exact path
};

/// A path's parameter is where it is along the axis z of its frame, in the hierarchy's units, and more than
/// zero wherever it may meet a box.
struct PathWalk {
  /// The path p + t v, t in [from, to], p and v in the frame of the hierarchy's vertices [m], [m/s]; v is not
  /// zero. A triangle is met within `radius` + `error` of it [m]; `sheared_tube` is the same in sheared
  /// coordinates beyond their error, 0 where only what the line itself may meet counts. `size` [m] is
  /// twice a bound of |p| + |vertex| at both ends.
  PathWalk(const WideBvh& bvh, const ShearedFrame& frame, const Vec3& p, const Vec3& v, double from,
           double to, double radius, double error, double sheared_tube, double size, Lanes fastest);

  /// The parameter at a time, rounded up.
  float parameterUp(double t) const;
  /// A time not after the parameter; -infinity where nothing is known.
  double timeDown(float parameter) const;

  Lanes lanes;
  bool misses;               ///< the root box: nothing to walk
  double first, per_second;  ///< the parameter at time 0, and how it grows
  double most;               ///< no box is met behind it
  // Boxes: the parameter at a plane is plane * inverse + near (far) for the near (far) planes. Of x y z; the
  // fourth numbers are not used.
  float inverse[4], near[4], far[4];
  std::int64_t near_plane[4], far_plane[4];  ///< from WideNode::plane, in floats
  float begin;                               ///< the parameter that boxes are entered at or after
  // Triangles.
  const ShearedFrame& frame;
  double reach;  ///< sheared_tube

 private:
  void meetEverything();
};

/// A leaf's triangles in the sheared frame. Edge k is the one across from corner k; the path passes inside a
/// triangle where its three sides have one sign.
struct SeenLeaf {
  alignas(32) double depth[3][4];  ///< [corner][lane] along the path [m]
  alignas(32) double side[3][4];   ///< [edge][lane] distance of the path, with a sign, times the length [m^2]
  alignas(32) double error[4];     ///< of the sides
};

/// Sees what the walk could not rule out. Returns the new limit: what is entered after it need not be seen.
class PathVisitor {
 public:
  virtual float visit(const WideLeaf& leaf, const SeenLeaf& seen, int lane, float entered, float limit) = 0;

 protected:
  ~PathVisitor() = default;
};

/// Counts nodes and leaves. Everything from the path's begin to `limit` is walked.
std::uint64_t walkPath(const WideBvh& bvh, const PathWalk& walk, float limit, PathVisitor& visitor);

}  // namespace collision_node::impact
