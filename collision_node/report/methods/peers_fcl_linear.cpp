#include "collision_node/report/linear_queries.h"

#ifdef COLLISION_NODE_HAS_FCL

#include <fcl/narrowphase/detail/traversal/collision/intersect.h>

namespace collision_node::report {

std::optional<bool> fclLinearContact(const LinearQuery& query) {
  using Intersect = fcl::detail::Intersect<double>;
  const auto& v = query.vertices;
  double time = 0.0;
  geometry::Vec3 point;
  if (query.edges) {
    return Intersect::intersect_EE(v[0].start, v[1].start, v[2].start, v[3].start, v[0].end, v[1].end,
                                   v[2].end, v[3].end, &time, &point, true);
  }
  return Intersect::intersect_VF(v[1].start, v[2].start, v[3].start, v[0].start, v[1].end, v[2].end, v[3].end,
                                 v[0].end, &time, &point, true);
}

}  // namespace collision_node::report

#else

namespace collision_node::report {
std::optional<bool> fclLinearContact(const LinearQuery&) { return std::nullopt; }
}  // namespace collision_node::report

#endif
