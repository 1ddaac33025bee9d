#include "collision_node/impact/straight/path_walk.h"

#include "collision_node/geometry/rounding.h"
#include "collision_node/impact/straight/eight_floats.h"

namespace collision_node::impact {
namespace {

using geometry::kUnit;
using geometry::WideNode;

constexpr float kWider = 0x1p-20f;       ///< more than a parameter's own roundings, in parts of it
constexpr double kStill = 0x1p-60;       ///< slower than this along an axis is standing still
constexpr double kUsualSlack = 0x1p-20;  ///< units
constexpr double kWidest = 0x1p30;       ///< units; with a wider tube floats say nothing any more
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
  const Four error = size * (4.0 * f.error + 8.0 * kUnit * size) + (2.0 * f.error * f.error);
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
      inverse[k] = allEight(walk.inverse[k]);
      near[k] = allEight(walk.near[k]);
      far[k] = allEight(walk.far[k]);
    }
  }

  COLLISION_NODE_INLINE Eight nearAt(const WideNode& node, int k) const {
    return loadEight(node.plane[0] + near_plane[k]) * inverse[k] + near[k];
  }
  COLLISION_NODE_INLINE Eight farAt(const WideNode& node, int k) const {
    return loadEight(node.plane[0] + far_plane[k]) * inverse[k] + far[k];
  }

  std::int64_t near_plane[3], far_plane[3];
  Eight inverse[3], near[3], far[3], begin;
};

/// Children of a node that still wait, by where the path enters them: the bits of that parameter, which sort
/// as it does, but for the last three, which are the lane. It rounds down, and choosing the nearest needs no
/// branch.
struct Entered {
  static constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::max();

  COLLISION_NODE_INLINE void take() {
    keys |= (keys == allEight(nearest)) & kNone;
    nearest = leastOf(keys);
  }
  COLLISION_NODE_INLINE std::int32_t child() const { return children[nearest & 7]; }
  COLLISION_NODE_INLINE float entry() const {
    const std::int32_t parameter = nearest & ~7;
    float entered;
    std::memcpy(&entered, &parameter, sizeof entered);
    return entered;
  }

  EightBits keys;
  const std::int32_t* children;
  std::int32_t nearest;  ///< kNone: nothing waits
};

COLLISION_NODE_INLINE std::uint64_t walkAll(const WideBvh& bvh, const PathWalk& walk, float limit,
                                            PathVisitor& visitor) {
  const WidePath path(walk);
  const WideNode* const nodes = bvh.nodes().data();
  const WideLeaf* const leaves = bvh.leaves().data();
  const double* const vertices = bvh.vertices()->data();
  const EightBits lanes = {0, 1, 2, 3, 4, 5, 6, 7};
  Entered waiting[WideBvh::kStack / 7];
  int height = 0;
  std::int32_t now = 0;
  float entered = 0.0f;
  Eight limits = allEight(limit);
  std::uint64_t tests = 1;
  while (true) {
    for (; now >= 0; ++tests) {
      const WideNode& node = nodes[now];
      const Eight near = larger(
          larger(larger(path.nearAt(node, 0), path.nearAt(node, 1)), path.nearAt(node, 2)), path.begin);
      const Eight far =
          smaller(smaller(smaller(path.farAt(node, 0), path.farAt(node, 1)), path.farAt(node, 2)), limits);
      const EightBits enters = near <= far;
      if (lanesOf(enters) == 0) break;
      Entered children;
      children.keys = enters ? ((EightBits)near & ~7) | lanes : allEight(Entered::kNone);
      children.children = node.child;
      children.nearest = leastOf(children.keys);
      now = children.child();
      entered = children.entry();
      children.take();
      waiting[height] = children;
      height += children.nearest != Entered::kNone;
    }
    if (now < 0) {
      const WideLeaf& leaf = leaves[~now];
      SeenLeaf seen;
      for (unsigned met = nearLanes(walk, vertices, leaf, seen); met != 0; met &= met - 1) {
        const int lane = __builtin_ctz(met);
        if (leaf.element[lane] < 0) continue;
        limit = visitor.visit(leaf, seen, lane, entered, limit);
        limits = allEight(limit);
      }
    }
    do {
      if (height == 0) return tests;
      entered = waiting[--height].entry();
    } while (entered > limit);  // so are the others
    Entered& next = waiting[height];
    now = next.child();
    next.take();
    height += next.nearest != Entered::kNone;
    ++tests;
  }
}

COLLISION_NODE_INLINE Four fourOf(const Vec3& x, double last) { return Four{x[0], x[1], x[2], last}; }

/// Sets everything that boxes need, for a tube of `g` units. Places are seen where the path is level with the
/// root box's centre, so floats see numbers of the box's size only; farther aside than `aside` nothing is
/// met. An axis along which the path stands still is one along which it creeps by less than that.
COLLISION_NODE_INLINE void follow(PathWalk& walk, const WideBvh& bvh, const Vec3& p, const Vec3& v,
                                  double from, double to, double g) {
  const ShearedFrame& f = walk.frame;
  const double scale = bvh.scale(), rate = std::abs(f.rate), level = f.origin[2] - bvh.centre()[f.kz];
  const double shift = 2.0 + 2.0 * g, pad = kWider * (1.0 + g), aside = 2.5 + 2.5 * g;
  const Four offset = fourOf(p, 0.0) - fourOf(bvh.centre(), 0.0), velocity = fourOf(v, 1.0);
  const FourBits back = velocity < 0.0;
  const Four speed = larger(magnitude(velocity), Four{} + rate * kStill);
  const Four place =
      larger(smaller((offset - (level * f.per_rate) * velocity) * scale, Four{} + aside), Four{} - aside);
  // Holds the roundings that act like places; the pad holds the others.
  const double grow = g * (1.0 + 0x1p-18) + 0x1p-19;
  const FourFloats size = __builtin_convertvector(rate / speed, FourFloats);
  const Four inverse_size = __builtin_convertvector(size, Four), along = back ? -place : place;
  const Four middle = shift - along * inverse_size, wider = grow * inverse_size + pad;
  const FourBits lower = {0, kEight, 2 * kEight, 0}, upper = lower + 3 * kEight;
  store(__builtin_convertvector(back, FourFloatBits) ? -size : size, walk.inverse);
  store(__builtin_convertvector(middle - wider, FourFloats), walk.near);
  store(__builtin_convertvector(middle + wider, FourFloats), walk.far);
  store(back ? upper : lower, walk.near_plane);
  store(back ? lower : upper, walk.far_plane);

  walk.first = shift + (f.rate < 0.0 ? -level : level) * scale;
  walk.per_second = rate * scale;
  walk.most = 2.0 * shift;
  const double begin = walk.first + from * walk.per_second, end = walk.first + to * walk.per_second;
  walk.begin = static_cast<float>(std::clamp(begin, 0.25, walk.most)) * (1.0f - kWider);
  const Four half = fourOf(bvh.half(), kInfinity) * scale * inverse_size;
  const Four in = (middle - wider) - half, out = (middle + wider) + half;
  const double low = std::max(std::max(in[0], in[1]), std::max(in[2], begin)),
               high = std::min(std::min(out[0], out[1]), std::min(out[2], end));
  walk.misses = low > high + pad;
}

void followBaseline(PathWalk& walk, const WideBvh& bvh, const Vec3& p, const Vec3& v, double from, double to,
                    double g) {
  follow(walk, bvh, p, v, from, to, g);
}
std::uint64_t walkBaseline(const WideBvh& bvh, const PathWalk& walk, float limit, PathVisitor& visitor) {
  return walkAll(bvh, walk, limit, visitor);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void followAvx2(PathWalk& walk, const WideBvh& bvh, const Vec3& p,
                                                const Vec3& v, double from, double to, double g) {
  follow(walk, bvh, p, v, from, to, g);
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
                   double to, double radius, double error, double sheared_tube, double size, Lanes fastest)
    : lanes(fastest), frame(sheared), reach(sheared_tube) {
  const auto followWithin = [&](double slack) {
    const double g = radius * bvh.scale() + slack;
#if defined(__x86_64__)
    if (lanes == Lanes::kAvx2) return followAvx2(*this, bvh, p, v, from, to, g);
#endif
    followBaseline(*this, bvh, p, v, from, to, g);
  };
  // What rounding needs is hardly ever more than this, and the walk does not wait for it.
  followWithin(kUsualSlack);
  const double slack = (error + 32.0 * kUnit * size) * bvh.scale();
  if (slack < kUsualSlack && radius * bvh.scale() < kWidest) return;
  if (radius * bvh.scale() + slack < kWidest) {
    followWithin(slack);
  } else {
    meetEverything();
  }
}

void PathWalk::meetEverything() {
  constexpr float kFar = 0x1p100f;
  misses = false;
  first = most = 1.0;
  per_second = 0.0;
  begin = 0.5f;
  for (int k = 0; k < 3; ++k) {
    inverse[k] = 1.0f;
    near_plane[k] = kEight * k;
    far_plane[k] = kEight * (k + 3);
    near[k] = -kFar;
    far[k] = kFar;
  }
}

float PathWalk::parameterUp(double t) const {
  const double parameter = first + t * per_second;
  return static_cast<float>(std::max(0.0, std::min(parameter, most))) * (1.0f + kWider);
}

double PathWalk::timeDown(float parameter) const {
  return (static_cast<double>(parameter) * (1.0 - 0x1p-20) - first) / per_second;
}

std::uint64_t walkPath(const WideBvh& bvh, const PathWalk& walk, float limit, PathVisitor& visitor) {
  if (walk.misses) return 0;
#if defined(__x86_64__)
  if (walk.lanes == Lanes::kAvx2) return walkAvx2(bvh, walk, limit, visitor);
#endif
  return walkBaseline(bvh, walk, limit, visitor);
}

}  // namespace collision_node::impact
