#include "collision_node/impact/path_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

namespace collision_node::impact {
namespace {

using geometry::WideNode;

// Wider than the baseline's registers: the compiler splits them there.
typedef float Floats __attribute__((vector_size(32), may_alias));
typedef double Doubles __attribute__((vector_size(32), may_alias));
using FloatMask = decltype(Floats{} < Floats{});
using DoubleMask = decltype(Doubles{} < Doubles{});

#define COLLISION_NODE_INLINE inline __attribute__((always_inline))

constexpr float kWider = 0x1p-20f;  ///< four roundings of a quotient, sixteen times over
constexpr double kStill = 0x1p-60;  ///< slower than this along an axis is standing still
constexpr double kU = 0x1p-53;

COLLISION_NODE_INLINE int bits(const FloatMask& mask) {
#if defined(__x86_64__)
  __m128 half[2];
  __builtin_memcpy(half, &mask, sizeof mask);
  return _mm_movemask_ps(half[0]) | _mm_movemask_ps(half[1]) << 4;
#else
  int all = 0;
  for (int i = 0; i < 8; ++i) all |= (mask[i] & 1) << i;
  return all;
#endif
}

COLLISION_NODE_INLINE int bits(const DoubleMask& mask) {
#if defined(__x86_64__)
  __m128d half[2];
  __builtin_memcpy(half, &mask, sizeof mask);
  return _mm_movemask_pd(half[0]) | _mm_movemask_pd(half[1]) << 2;
#else
  int all = 0;
  for (int i = 0; i < 4; ++i) all |= static_cast<int>(mask[i] & 1) << i;
  return all;
#endif
}

template <typename V>
COLLISION_NODE_INLINE V larger(const V& a, const V& b) {
  return a > b ? a : b;
}
template <typename V>
COLLISION_NODE_INLINE V smaller(const V& a, const V& b) {
  return a < b ? a : b;
}
COLLISION_NODE_INLINE Doubles magnitude(const Doubles& a) { return larger(a, -a); }

struct Waiting {
  std::int32_t child;
  float entered;
};

/// Lanes of the node that the path may enter before `limit`, and where it enters them.
COLLISION_NODE_INLINE int enteredLanes(const PathWalk& walk, const WideNode& node, float limit,
                                       Floats& entered) {
  const auto plane = [&](int i) -> const Floats& { return *reinterpret_cast<const Floats*>(node.plane[i]); };
  Floats near = (plane(walk.near_plane[0]) - walk.near_origin[0]) * walk.inverse[0];
  Floats far = (plane(walk.far_plane[0]) - walk.far_origin[0]) * walk.inverse[0];
#pragma GCC unroll 2
  for (int k = 1; k < 3; ++k) {
    near = larger(near, (plane(walk.near_plane[k]) - walk.near_origin[k]) * walk.inverse[k]);
    far = smaller(far, (plane(walk.far_plane[k]) - walk.far_origin[k]) * walk.inverse[k]);
  }
  near = larger(near * (1.0f - kWider), Floats{});
  far = smaller(far * (1.0f + kWider), Floats{} + limit);
  entered = near;
  return bits(near <= far);
}

/// Lanes whose triangle, seen along the path, is not clearly to one side of it.
COLLISION_NODE_INLINE int nearLanes(const PathWalk& walk, const Vec3* vertices, const WideLeaf& leaf) {
  const ShearedFrame& f = walk.frame;
  Doubles x[3], y[3];
  Doubles size = {};
  for (int k = 0; k < 3; ++k) {
    const double* v[4];
    for (int lane = 0; lane < 4; ++lane) v[lane] = vertices[leaf.vertex[k][lane]].data();
    const auto along = [&](int axis) { return Doubles{v[0][axis], v[1][axis], v[2][axis], v[3][axis]}; };
    const Doubles z = along(f.kz) - f.origin[2];
    x[k] = (along(f.kx) - f.origin[0]) - f.shear_x * z;
    y[k] = (along(f.ky) - f.origin[1]) - f.shear_y * z;
    size = larger(size, larger(magnitude(x[k]), magnitude(y[k])));
  }
  const Doubles error = size * (4.0 * f.error + 8.0 * kU * size) + (2.0 * f.error * f.error);
  Doubles side[3];
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    side[k] = x[j] * y[i] - y[j] * x[i];
  }
  if (walk.reach == 0.0) {
    const Doubles least = smaller(side[0], smaller(side[1], side[2]));
    const Doubles most = larger(side[0], larger(side[1], side[2]));
    return ~bits((least < -error) & (most > error)) & 15;
  }
  // Beyond the tube on the outer side of some edge. Which side is outer is known only to the error, hence
  // twice.
  const Doubles turn = side[0] + side[1] + side[2];
  const double reach2 = walk.reach * walk.reach;
  DoubleMask misses = {};
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Doubles ex = x[j] - x[i], ey = y[j] - y[i];
    const Doubles outside = (turn < 0.0 ? side[k] : -side[k]) - 8.0 * error;
    misses |= (outside > 0.0) & (outside * outside > reach2 * (ex * ex + ey * ey));
  }
  return ~bits(misses) & 15;
}

COLLISION_NODE_INLINE std::uint64_t walkAll(const WideBvh& bvh, const PathWalk& walk, float limit,
                                            PathVisitor& visitor) {
  const WideNode* const nodes = bvh.nodes().data();
  const WideLeaf* const leaves = bvh.leaves().data();
  const Vec3* const vertices = bvh.vertices();
  Waiting stack[WideBvh::kStack];
  int height = 0;
  Waiting now = {0, 0.0f};
  std::uint64_t tests = 0;
  while (true) {
    ++tests;
    if (now.child >= 0) {
      const WideNode& node = nodes[now.child];
      Floats entered;
      int lanes = enteredLanes(walk, node, limit, entered);
      if (lanes != 0) {
        const auto next = [&] {
          const int lane = __builtin_ctz(static_cast<unsigned>(lanes));
          lanes &= lanes - 1;
          return Waiting{node.child[lane], reinterpret_cast<const float*>(&entered)[lane]};
        };
        // The nearest goes on at once, the others wait, sorted while they are written, farthest first.
        now = next();
        const int base = height;
        while (lanes != 0) {
          Waiting child = next();
          if (child.entered < now.entered) std::swap(child, now);
          int place = height++;
          for (; place > base && stack[place - 1].entered < child.entered; --place)
            stack[place] = stack[place - 1];
          stack[place] = child;
        }
        continue;
      }
    } else {
      const WideLeaf& leaf = leaves[~now.child];
      int lanes = nearLanes(walk, vertices, leaf);
      while (lanes != 0) {
        const int lane = __builtin_ctz(static_cast<unsigned>(lanes));
        lanes &= lanes - 1;
        if (leaf.element[lane] >= 0) limit = visitor.visit(leaf, lane, now.entered, limit);
      }
    }
    do {
      if (height == 0) return tests;
      now = stack[--height];
    } while (now.entered > limit);
  }
}

std::uint64_t walkBaseline(const WideBvh& bvh, const PathWalk& walk, float limit, PathVisitor& visitor) {
  return walkAll(bvh, walk, limit, visitor);
}

#if defined(__x86_64__)
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

void ShearedFrame::follow(const Vec3& o, const Vec3& velocity) {
  velocity.cwiseAbs().maxCoeff(&kz);
  kx = (kz + 1) % 3;
  ky = (kz + 2) % 3;
  rate = velocity[kz];
  per_rate = 1.0 / rate;
  origin[0] = o[kx];
  origin[1] = o[ky];
  origin[2] = o[kz];
  shear_x = velocity[kx] * per_rate;
  shear_y = velocity[ky] * per_rate;
}

PathWalk::PathWalk(const WideBvh& bvh, const ShearedFrame& sheared, const Vec3& p, const Vec3& v, double from,
                   double to, double tube, double sheared_tube)
    : start(from), span(to - from), frame(sheared), reach(sheared_tube) {
  // In doubles to the part inside the root box, so that floats see numbers of its size only. A time outside
  // is off by at most a few roundings of the distance over the speed, a place by a few of the distance.
  const Vec3 offset = p - bvh.centre();
  const double rounding = 16.0 * kU *
                          (p.cwiseAbs().maxCoeff() + bvh.centre().cwiseAbs().maxCoeff() +
                           v.cwiseAbs().maxCoeff() * std::max(std::abs(from), std::abs(to)));
  double low = from, high = to, per_v[3] = {};
  for (int k = 0; k < 3; ++k) {
    const double half = (bvh.half()[k] + tube + rounding) * (1.0 + 0x1p-20);
    if (v[k] == 0.0) {
      if (std::abs(offset[k]) > half) return;
      continue;
    }
    per_v[k] = 1.0 / v[k];
    const double middle = -offset[k] * per_v[k], reach = half * std::abs(per_v[k]);
    low = std::max(low, middle - reach);
    high = std::min(high, middle + reach);
  }
  if (low > high) return;
  misses = false;
  start = low;
  span = high - low;
  const Vec3 o = (offset + low * v) * bvh.scale(), w = v * (span * bvh.scale());
  const double grow = (tube + rounding) * bvh.scale() * (1.0 + 0x1p-20) +
                      0x1p-21 * (o.cwiseAbs().maxCoeff() + w.cwiseAbs().maxCoeff()) + 0x1p-40;
  const double per_unit = 1.0 / (span * bvh.scale());
  for (int k = 0; k < 3; ++k) {
    const bool still = std::abs(w[k]) < kStill, forward = still || w[k] > 0.0;
    near_plane[k] = forward ? k : 3 + k;
    far_plane[k] = forward ? 3 + k : k;
    near_origin[k] = static_cast<float>(forward ? o[k] + grow : o[k] - grow);
    far_origin[k] = static_cast<float>(forward ? o[k] - grow : o[k] + grow);
    inverse[k] = static_cast<float>(still ? 1.0 / kStill : per_v[k] * per_unit);
  }
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

std::uint64_t walkPath(const WideBvh& bvh, const PathWalk& walk, float limit, PathVisitor& visitor,
                       Lanes lanes) {
  if (walk.misses) return 0;
#if defined(__x86_64__)
  if (lanes == Lanes::kAvx2) return walkAvx2(bvh, walk, limit, visitor);
#endif
  return walkBaseline(bvh, walk, limit, visitor);
}

}  // namespace collision_node::impact
