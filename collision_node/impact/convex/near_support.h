/// Cores with axes of their own near their support planes across a direction, in closed form: how deep, how
/// far across, and along which features. Tells of most contacts of boxes, cylinders and segments what
/// ContactView finds out point by point. Derivation: docs/solver.md, "The ball".
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "collision_node/impact/convex/gjk.h"
#include "collision_node/impact/convex/polygon.h"

namespace collision_node::impact {

/// Upper bounds of asin(sine) and of sin(angle) up to a right angle; small ones need no series, and are
/// larger by a part in five million at most.
inline double angleOf(double sine) {
  constexpr double kSmall = 1e-3;
  return sine < kSmall ? sine * (1.0 + 0.2 * sine * sine) : std::asin(std::min(1.0, sine));
}
inline double sineOf(double angle) {
  constexpr double kSmall = 1e-3;
  return angle < kSmall ? angle : std::sin(std::min(angle, M_PI_2));
}

/// One core, and `up` from it.
class NearSupport {
 public:
  /// `up` is unit. The core has a frame.
  NearSupport(const PosedCore& core, const Vec3& up);

  double top() const { return top_; }  ///< how far the core reaches along up, from A's origin [m]
  /// Between both its support planes across up [m].
  double thickness() const { return 2.0 * slope_.dot(half_); }
  double size() const { return 2.0 * half_.norm(); }  ///< no two of its points are farther apart [m]

  /// A box that holds every point within `depth` of the support plane, whose normal as the core sees it leans
  /// by at most `tilt`: the lean in the world and the core's own turn.
  struct Cap {
    Vec3 centre;
    Vec3 reach;  ///< half lengths along the axes
    double radius() const { return reach.norm(); }
  };
  Cap cap(double depth, double tilt) const;
  /// The line of a cap that is much longer than wide, seen across n.
  Strip strip(const Cap& cap, const Vec3& n, const Vec3& e1, const Vec3& e2) const;

  /// The vertex, edge or face that is within `depth` of the support plane.
  Feature feature(double depth) const;
  /// Along how many of its axes that goes on as far as the core does.
  int flatness(double depth) const;

  /// A way both to and fro in which a core's points go on from one of them.
  struct Way {
    Vec3 direction;       ///< unit
    double reach;         ///< to either side [m]
    double height = 0.0;  ///< by how much the depth grows on it, at most [m]
    double bend = 0.0;    ///< how far it strays across the direction [m]
    bool all = false;     ///< it goes as far in all directions across the cylinder's axis, the direction
  };
  struct Ways {
    int count = 0;
    Way way[6];  ///< of both cores
    double depth = 0.0;
    void add(const Way& w) { way[count++] = w; }
  };
  /// A point of the core at the support plane, beside `near` where the core is flat to `level`, and the ways
  /// from it. Where a cylinder is round it goes as deep as `level`.
  Vec3 stand(const Vec3& near, double level, Ways& ways) const;

 private:
  Mat3 axes_;    ///< columns, world; each leans up. Of a cylinder: towards up, along a tangent, its axis
  Vec3 slope_;   ///< up . axes, >= 0
  Vec3 half_;    ///< half lengths [m]; of a cylinder its radius, 0 and half its length
  Vec3 centre_;  ///< from A's origin [m]
  double top_;
  bool round_, leans_;  ///< a cylinder; its side leans towards up, as far as rounding tells
};

/// Two cores across n, unit and from A to B.
class NearPair {
 public:
  NearPair(const Cores& cores, const Vec3& n) : n_(n), a_(cores.a, n), b_(cores.b, -n) {}

  const NearSupport& a() const { return a_; }
  const NearSupport& b() const { return b_; }
  double gap() const { return -b_.top() - a_.top(); }  ///< of the support planes [m]

  /// ContactView::normalCone() where two ways tell it; `near_a` and `near_b` are about where they touch.
  /// `forward`: normals that lean by more than a right angle are none.
  std::optional<double> normalCone(double moved, const Vec3& near_a, const Vec3& near_b, bool forward) const;

  /// ContactView::commonDisc() about a place on A's support plane; false where that tells more.
  bool commonDisc(double depth, double tilt_a, double tilt_b, double moved_a, double moved_b, Vec3* place,
                  double* radius) const;

 private:
  const Vec3 n_;
  const NearSupport a_, b_;
};

}  // namespace collision_node::impact
