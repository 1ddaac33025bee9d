#include "collision_node/impact/out_of_reach.h"

#include <algorithm>

#include "collision_node/impact/pair_piece.h"

namespace collision_node::impact {

bool outOfReach(const Body& a, const Body& b, const Piece& piece, double contact_distance) {
  const motion::RigidMotion &ma = piece.a, &mb = piece.b;
  if (!ma.isStraight() || !mb.isStraight()) return false;
  const motion::LinearPart line(ma, mb, piece.start_ns, piece.end_ns);
  const double size = line.magnitude(ma, mb) + (ma.c[1].norm() + mb.c[1].norm()) * line.reach;
  const double reach = (a.reach() + b.reach() + contact_distance + a.placingError() + b.placingError() +
                        piece.tube + 64.0 * kUnit * size) *
                       (1.0 + 64.0 * kUnit);
  const Vec3 way = line.rate * line.duration;
  const double length2 = way.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp(-line.d.dot(way) / length2, 0.0, 1.0) : 0.0;
  return (line.d + share * way).squaredNorm() > squareAbove(reach);
}

}  // namespace collision_node::impact
