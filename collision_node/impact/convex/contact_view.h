/// Two cores seen along a direction n: how deep their points lie below the two support planes across n, and
/// where across it. From it come the cone that holds the true normal and the ball that holds the contact.
/// Derivations: docs/solver.md, "The ball".
#pragma once

#include "collision_node/impact/convex/gjk.h"
#include "collision_node/impact/convex/polygon.h"

namespace collision_node::impact {

/// A point of a core, seen along n.
struct SeenPoint {
  double depth;  ///< below the core's own support plane, >= 0 [m]
  Vec2 across;   ///< world axes, relative to A's origin, along e1 and e2 [m]
};

/// Memory of the views; only capacity survives a call.
struct ViewBuffers {
  std::vector<SeenPoint> a, b;
  Polygon points, points_b, hull_a, hull_b, both, scratch;
};

class ContactView {
 public:
  /// `n` is unit and points from A to B. The cores must outlive the view.
  ContactView(const Cores& cores, const Vec3& n, ViewBuffers& buffers);

  /// How far B's support plane lies beyond A's along n; negative when they overlap [m].
  double gap() const { return low_b_ - top_a_; }
  double topOfA() const { return top_a_; }

  /// Half angle of a cone about n that holds every unit n' with n' . (w - gap n) >= -moved for all
  /// differences w = b - a of the cores' points: where those within h of the lowest surround n up to radius
  /// l, sin(angle) <= (h + moved)/l. At most `known`, a half angle for which the same is known; pi for none.
  double normalCone(double moved, double known) const;

  /// A disc in the plane across n that holds everything within `moved_a` of A's points at most `depth` below
  /// its support plane and within `moved_b` of B's. The tilts bound how far the true normal leans from n as
  /// each body sees it: the lean in the world and the body's own turn [rad].
  void commonDisc(double depth, double tilt_a, double tilt_b, double moved_a, double moved_b, Vec2* centre,
                  double* radius) const;

  /// A point of the plane across n, at a height along n.
  Vec3 place(const Vec2& across, double height) const {
    return height * n_ + across.x() * e1_ + across.y() * e2_;
  }

 private:
  /// A core as it is seen: heights along n or -n, and places across it.
  struct SeenCore {
    SeenCore(const PosedCore& core, const Vec3& up, const Vec3& e1, const Vec3& e2);
    Vec3 see(const Vec3& local) const { return turn * local + origin; }

    const Element& element;
    Vec3 up;      ///< in the object's frame
    Mat3 turn;    ///< rows: up, e1, e2 in the object's frame
    Vec3 origin;  ///< of the object's frame, seen
  };
  static double see(const SeenCore& core, std::vector<SeenPoint>& points);
  static void cap(const SeenCore& core, const std::vector<SeenPoint>& points, double depth, double tilt,
                  Polygon& cap);

  ViewBuffers& buffers_;
  Vec3 n_, e1_, e2_;
  SeenCore a_, b_;
  double top_a_ = 0.0, low_b_ = 0.0;
};

}  // namespace collision_node::impact
