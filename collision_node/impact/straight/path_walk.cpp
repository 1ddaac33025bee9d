#include "collision_node/impact/straight/path_walk.h"

#include "collision_node/impact/straight/eight_floats.h"

namespace collision_node::impact {
namespace {

using geometry::WideNode;

constexpr float kWider = 0x1p-20f;  ///< four roundings of a quotient, sixteen times over
constexpr double kStill = 0x1p-60;  ///< slower than this along an axis is standing still
constexpr double kU = 0x1p-53;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using FourFloats = float __attribute__((vector_size(kFour * sizeof(float))));
using FourFloatBits = std::int32_t __attribute__((vector_size(kFour * sizeof(std::int32_t))));

template <typename Four, typename Number>
COLLISION_NODE_INLINE void store(const Four& x, Number (&to)[kFour]) {
  std::memcpy(to, &x, sizeof to);
}

/// A function, no lambda: without optimisation one that returns a register and is not inlined hands it over
/// otherwise than a caller with wider registers expects.
COLLISION_NODE_INLINE Four gather(const double* from, const std::ptrdiff_t at[kFour]) {
  return Four{from[at[0]], from[at[1]], from[at[2]], from[at[3]]};
}

/// Lanes whose triangle, seen along the path, is not clearly to one side of it.
COLLISION_NODE_INLINE unsigned nearLanes(const PathWalk& walk, const double* vertices, const WideLeaf& leaf,
                                         SeenLeaf& seen) {
  const ShearedFrame& f = walk.frame;
  const double *const in_x = vertices + f.kx, *const in_y = vertices + f.ky, *const in_z = vertices + f.kz;
  Four x[3], y[3], size = {};
  for (int k = 0; k < 3; ++k) {
    std::ptrdiff_t v[kFour];
    for (int lane = 0; lane < 4; ++lane) v[lane] = 3 * static_cast<std::ptrdiff_t>(leaf.vertex[k][lane]);
    const Four z = gather(in_z, v) - f.origin[2];
    x[k] = (gather(in_x, v) - f.origin[0]) - f.shear_x * z;
    y[k] = (gather(in_y, v) - f.origin[1]) - f.shear_y * z;
    size = larger(size, larger(magnitude(x[k]), magnitude(y[k])));
    store(z, seen.depth[k]);
  }
  const Four error = size * (4.0 * f.error + 8.0 * kU * size) + (2.0 * f.error * f.error);
  store(error, seen.error);
  Four side[3];
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    side[k] = x[j] * y[i] - y[j] * x[i];
    store(side[k], seen.side[k]);
  }
  // Written so that what is no number is near.
  FourBits misses = {};
  if (walk.reach == 0.0) {
    const Four least = smaller(side[0], smaller(side[1], side[2]));
    const Four most = larger(side[0], larger(side[1], side[2]));
    misses = (least < -error) & (most > error);
  } else {
    // Beyond the tube on the outer side of some edge. Which side is outer is known only to the error, hence
    // twice.
    const Four turn = side[0] + side[1] + side[2];
    const double reach2 = walk.reach * walk.reach;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const Four ex = x[j] - x[i], ey = y[j] - y[i];
      const Four outside = (turn < 0.0 ? side[k] : -side[k]) - 8.0 * error;
      misses |= (outside > 0.0) & (outside * outside > reach2 * (ex * ex + ey * ey));
    }
  }
  return ~lanesOf(misses) & 15u;
}

/// A path's numbers, each for all eight boxes of a node.
struct WidePath {
  explicit COLLISION_NODE_INLINE WidePath(const PathWalk& walk) : begin(allEight(walk.begin)) {
    for (int k = 0; k < 3; ++k) {
      near_plane[k] = walk.near_plane[k];
      far_plane[k] = walk.far_plane[k];
      near_origin[k] = allEight(-walk.near_origin[k]);
      far_origin[k] = allEight(-walk.far_origin[k]);
      near_inverse[k] = allEight(walk.near_inverse[k]);
      far_inverse[k] = allEight(walk.far_inverse[k]);
    }
  }

  COLLISION_NODE_INLINE Eight nearAt(const WideNode& node, int k) const {
    return (loadEight(node.plane[0] + near_plane[k]) + near_origin[k]) * near_inverse[k];
  }
  COLLISION_NODE_INLINE Eight farAt(const WideNode& node, int k) const {
    return (loadEight(node.plane[0] + far_plane[k]) + far_origin[k]) * far_inverse[k];
  }

  std::int64_t near_plane[3], far_plane[3];
  Eight near_origin[3], far_origin[3], near_inverse[3], far_inverse[3], begin;
};

/// Children of a node by where the path enters them: the bits of that parameter, which sort as it does, but
/// for the last three, which are the lane. It rounds down, and choosing the nearest needs no branch.
struct Entered {
  static constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::max();

  EightBits keys;
  const std::int32_t* child;
  std::int32_t count;

  Entered() = default;
  COLLISION_NODE_INLINE Entered(const WideNode& node, const WidePath& path, float limit) : child(node.child) {
    const Eight near =
        larger(larger(larger(path.nearAt(node, 0), path.nearAt(node, 1)), path.nearAt(node, 2)), path.begin);
    const Eight far = smaller(smaller(smaller(path.farAt(node, 0), path.farAt(node, 1)), path.farAt(node, 2)),
                              allEight(limit));
    const EightBits enters = near <= far;
    keys = ((EightBits)near & ~7) | EightBits{0, 1, 2, 3, 4, 5, 6, 7};
    keys = enters ? keys : allEight(kNone);
    count = __builtin_popcount(lanesOf(enters));
  }

  /// Of at least one: which, and where it is entered.
  COLLISION_NODE_INLINE std::int32_t nearest(float& entered) const {
    const std::int32_t key = leastOf(keys), parameter = key & ~7;
    std::memcpy(&entered, &parameter, sizeof entered);
    return key;
  }
  COLLISION_NODE_INLINE std::int32_t take(std::int32_t key) {
    keys |= (keys == allEight(key)) & kNone;
    --count;
    return child[key & 7];
  }
};

COLLISION_NODE_INLINE std::uint64_t walkAll(const WideBvh& bvh, const PathWalk& walk, float limit,
                                            PathVisitor& visitor) {
  const WidePath path(walk);
  const WideNode* const nodes = bvh.nodes().data();
  const WideLeaf* const leaves = bvh.leaves().data();
  const double* const vertices = bvh.vertices()->data();
  Entered waiting[WideBvh::kStack / 7];
  int height = 0;
  std::int32_t now = 0;
  float entered = 0.0f;
  for (std::uint64_t tests = 1;; ++tests) {
    if (now >= 0) {
      Entered children(nodes[now], path, limit);
      if (children.count > 0) {
        now = children.take(children.nearest(entered));
        waiting[height] = children;
        height += children.count > 0;
        continue;
      }
    } else {
      const WideLeaf& leaf = leaves[~now];
      SeenLeaf seen;
      for (unsigned lanes = nearLanes(walk, vertices, leaf, seen); lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        if (leaf.element[lane] >= 0) limit = visitor.visit(leaf, seen, lane, entered, limit);
      }
    }
    std::int32_t key = 0;
    while (true) {
      if (height == 0) return tests;
      key = waiting[height - 1].nearest(entered);
      if (!(entered > limit)) break;
      --height;  // so are the others
    }
    now = waiting[height - 1].take(key);
    height -= waiting[height - 1].count == 0;
  }
}

COLLISION_NODE_INLINE Four fourOf(const Vec3& x, double last) { return Four{x[0], x[1], x[2], last}; }

/// In doubles to the part inside the root box, so that floats see numbers of its size only. A time outside is
/// off by at most a few roundings of the distance over the speed, a place by a few of the distance. An axis
/// along which the path stands still is one along which it creeps by less than that.
COLLISION_NODE_INLINE void clip(PathWalk& walk, const WideBvh& bvh, const Vec3& p, const Vec3& v, double to,
                                double grown) {
  const Four offset = fourOf(p, 0.0) - fourOf(bvh.centre(), 0.0), velocity = fourOf(v, 1.0);
  const FourBits back = velocity < 0.0;
  const Four speed = larger(magnitude(velocity), Four{} + std::abs(walk.frame.rate) * kStill);
  const Four half = (fourOf(bvh.half(), kInfinity) + grown) * (1.0 + 0x1p-20);
  const Four along = back ? -offset : offset, per_speed = 1.0 / speed;
  const Four in = (-half - along) * per_speed, out = (half - along) * per_speed;
  const double low = std::max(std::max(in[0], in[1]), std::max(in[2], walk.start)),
               high = std::min(std::min(out[0], out[1]), std::min(out[2], to));
  if (low > high) return;
  walk.misses = false;
  walk.start = low;
  walk.span = high - low;
  const double scale = bvh.scale(), units = walk.span * scale;
  // 2^-21 of the largest place and the largest way, which are within the box and the tube around it.
  const double grow = grown * scale * (1.0 + 0x1p-18) + 0x1p-19;
  const Four place = (offset + low * velocity) * scale, ahead = back ? Four{} - grow : Four{} + grow;
  const FourFloats still = FourFloats{} + static_cast<float>(kStill);
  FourFloats way = __builtin_convertvector(speed * units, FourFloats);
  way = way > still ? way : still;
  const FourFloats inverse = 1.0f / (__builtin_convertvector(back, FourFloatBits) ? -way : way);
  const FourBits lower = {0, kEight, 2 * kEight, 0}, upper = lower + 3 * kEight;
  store(__builtin_convertvector(place + ahead, FourFloats), walk.near_origin);
  store(__builtin_convertvector(place - ahead, FourFloats), walk.far_origin);
  store(inverse * (1.0f - kWider), walk.near_inverse);
  store(inverse * (1.0f + kWider), walk.far_inverse);
  store(back ? upper : lower, walk.near_plane);
  store(back ? lower : upper, walk.far_plane);
}

void clipBaseline(PathWalk& walk, const WideBvh& bvh, const Vec3& p, const Vec3& v, double to, double grown) {
  clip(walk, bvh, p, v, to, grown);
}
std::uint64_t walkBaseline(const WideBvh& bvh, const PathWalk& walk, float limit, PathVisitor& visitor) {
  return walkAll(bvh, walk, limit, visitor);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void clipAvx2(PathWalk& walk, const WideBvh& bvh, const Vec3& p,
                                              const Vec3& v, double to, double grown) {
  clip(walk, bvh, p, v, to, grown);
}
__attribute__((target("avx2"))) std::uint64_t walkAvx2(const WideBvh& bvh, const PathWalk& walk, float limit,
                                                       PathVisitor& visitor) {
  return walkAll(bvh, walk, limit, visitor);
}
#endif

}  // namespace

Lanes fastestLanes() {
#if defined(__x86_64__)
  static const Lanes lanes = __builtin_cpu_supports("avx2") ? Lanes::kAvx2 : Lanes::kBaseline;
  return lanes;
#else
  return Lanes::kBaseline;
#endif
}

PathWalk::PathWalk(const WideBvh& bvh, const ShearedFrame& sheared, const Vec3& p, const Vec3& v, double from,
                   double to, double tube, double sheared_tube, double size, Lanes fastest)
    : lanes(fastest), start(from), span(to - from), frame(sheared), reach(sheared_tube) {
#if defined(__x86_64__)
  if (lanes == Lanes::kAvx2) {
    clipAvx2(*this, bvh, p, v, to, tube + 32.0 * kU * size);
    return;
  }
#endif
  clipBaseline(*this, bvh, p, v, to, tube + 32.0 * kU * size);
}

float PathWalk::parameterUp(double t) const {
  if (!(span > 0.0)) return 1.0f;
  const double parameter = (t - start) / span;
  if (!(parameter < 1.0)) return 1.0f;
  return static_cast<float>(std::max(0.0, parameter)) * (1.0f + kWider) + kWider;
}

double PathWalk::timeDown(float parameter) const {
  const double lower = static_cast<double>(parameter) * (1.0 - 0x1p-20) - 0x1p-20;
  return start + std::max(0.0, lower) * span;
}

std::uint64_t walkPath(const WideBvh& bvh, const PathWalk& walk, float limit, PathVisitor& visitor) {
  if (walk.misses) return 0;
#if defined(__x86_64__)
  if (walk.lanes == Lanes::kAvx2) return walkAvx2(bvh, walk, limit, visitor);
#endif
  return walkBaseline(bvh, walk, limit, visitor);
}

}  // namespace collision_node::impact
