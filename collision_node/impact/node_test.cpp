#include "collision_node/impact/node_test.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace collision_node::impact {
namespace {

constexpr double kUp = 1.0 + 64.0 * kUnit;

constexpr int kWidth = geometry::BvhBlock::kWidth;

/// All children of a node side by side.
using Lanes = double __attribute__((vector_size(kWidth * sizeof(double))));
using Floats = float __attribute__((vector_size(kWidth * sizeof(float))));

// The compiler makes one version for any 64-bit machine and one for wide registers, and the loader picks. No
// product is ever fused with a sum, so both give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define COLLISION_NODE_ANY_WIDTH __attribute__((target_clones("avx2", "default")))
#else
#define COLLISION_NODE_ANY_WIDTH
#endif
#define COLLISION_NODE_INLINE inline __attribute__((always_inline))

COLLISION_NODE_INLINE void load(const float from[kWidth], Lanes& to) {
  Floats f;
  std::memcpy(&f, from, sizeof f);
  to = __builtin_convertvector(f, Lanes);
}

COLLISION_NODE_INLINE void load(const std::int8_t from[kWidth], Lanes& to) {
  for (int i = 0; i < kWidth; ++i) to[i] = from[i];
}

/// sum += |x| scale
template <typename Scale>
COLLISION_NODE_INLINE void addMagnitude(const Lanes& x, const Scale& scale, Lanes& sum) {
  sum += (x < 0.0 ? -x : x) * scale;
}

/// Narrows [low, high] to where |d + w s| <= e. Written so that NaN cuts nothing off, and that w = 0 gives
/// quotients of infinite size: of different signs while |d| < e, else of one sign, which leaves nothing.
COLLISION_NODE_INLINE void clipAxis(const Lanes& d, Lanes& w, const Lanes& e, double pad, Lanes& low,
                                    Lanes& high) {
  w += 0.0;  // makes -0 a +0
  const Lanes inverse = 1.0 / w;
  const Lanes first = (-e - d) * inverse, second = (e - d) * inverse;
  const Lanes near = (w < 0.0 ? second : first) - pad, far = (w < 0.0 ? first : second) + pad;
  low = near > low ? near : low;
  high = far < high ? far : high;
}

COLLISION_NODE_INLINE double times(const double row[3], const float c[3]) {
  return (row[0] * c[0] + row[1] * c[1]) + row[2] * c[2];
}

COLLISION_NODE_INLINE double times(const float n[3], const double x[3]) {
  return (n[0] * x[0] + n[1] * x[1]) + n[2] * x[2];
}

/// Column k of n^T Q.
COLLISION_NODE_INLINE double along(const float n[3], const double q[3][3], int k) {
  return (n[0] * q[0][k] + n[1] * q[1][k]) + n[2] * q[2][k];
}

constexpr double kTiny = 1e-30;  ///< keeps the quotient of two zeros at zero

/// The children are seen from the frame of `fixed` by `in_fixed`; `in_moving` is the other way round.
COLLISION_NODE_ANY_WIDTH
void clipBlock(const Slab& slab, const SlabView& in_fixed, const SlabView& in_moving,
               const geometry::BvhNode& fixed, const geometry::BvhBlock& moving, double grown, double pad,
               double low_in, double high_in, double low_out[kWidth], double high_out[kWidth]) {
  const double bend = 0.5 * slab.half * slab.half * kUp;
  Lanes low = low_in - Lanes{}, high = high_in - Lanes{};
  Lanes c[3], h[3], reach;
  for (int k = 0; k < 3; ++k) {
    load(moving.centre[k], c[k]);
    load(moving.half[k], h[k]);
  }
  load(moving.reach, reach);
  const Lanes extra = grown + bend * (in_fixed.bend + slab.bend_q * reach);
  for (int k = 0; k < 3; ++k) {
    const double *q0 = in_fixed.q0[k], *q1 = in_fixed.q1[k], *x = in_fixed.extent[k];
    const Lanes d = (in_fixed.p0[k] + ((q0[0] * c[0] + q0[1] * c[1]) + q0[2] * c[2])) - fixed.centre[k];
    Lanes w = in_fixed.p1[k] + ((q1[0] * c[0] + q1[1] * c[1]) + q1[2] * c[2]);
    const Lanes e = (fixed.half[k] + ((x[0] * h[0] + x[1] * h[1]) + x[2] * h[2])) * kUp + extra;
    clipAxis(d, w, e, pad, low, high);
  }
  const double back_extra = grown + bend * (in_moving.bend + slab.bend_q * fixed.reach);
  for (int k = 0; k < 3; ++k) {
    const Lanes d = (in_moving.p0[k] + times(in_moving.q0[k], fixed.centre)) - c[k];
    Lanes w = (in_moving.p1[k] + times(in_moving.q1[k], fixed.centre)) - Lanes{};
    const Lanes e = (h[k] + times(in_moving.extent[k], fixed.half)) * kUp + back_extra;
    clipAxis(d, w, e, pad, low, high);
  }

  // Across the plates. A zero plate has levels and extents of zero, and the allowance lets everything pass.
  Lanes n[3], middle, thick;
  for (int k = 0; k < 3; ++k) load(moving.plate[k], n[k]);
  load(moving.plate_middle, middle);
  load(moving.plate_half, thick);
  {
    const float* m = fixed.plate;
    const double m2 = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
    double v0[3], v1[3];
    for (int k = 0; k < 3; ++k) {
      v0[k] = along(m, in_fixed.q0, k);
      v1[k] = along(m, in_fixed.q1, k);
    }
    const Lanes n2 = (n[0] * n[0] + n[1] * n[1]) + n[2] * n[2] + kTiny;
    const Lanes share = ((v0[0] * n[0] + v0[1] * n[1]) + v0[2] * n[2]) / n2;
    const Lanes offset = middle - ((n[0] * c[0] + n[1] * c[1]) + n[2] * c[2]);
    Lanes e = fixed.plate_half - Lanes{};
    addMagnitude(share, thick, e);
    for (int k = 0; k < 3; ++k) {
      addMagnitude(v0[k] - share * n[k], h[k], e);
      e += (slab.half * std::abs(v1[k])) * h[k];
    }
    e = e * kUp + geometry::kPlateLength * extra;
    const Lanes d = (times(m, in_fixed.p0) - fixed.plate_middle) +
                    ((v0[0] * c[0] + v0[1] * c[1]) + v0[2] * c[2]) + share * offset;
    Lanes w = times(m, in_fixed.p1) + ((v1[0] * c[0] + v1[1] * c[1]) + v1[2] * c[2]);
    if (m2 > 0.0) clipAxis(d, w, e, pad, low, high);
  }
  {
    const float* m = fixed.plate;
    const double m2 = m[0] * m[0] + m[1] * m[1] + m[2] * m[2] + kTiny;
    const double offset = fixed.plate_middle - (m[0] * static_cast<double>(fixed.centre[0]) +
                                                m[1] * static_cast<double>(fixed.centre[1]) +
                                                m[2] * static_cast<double>(fixed.centre[2]));
    Lanes v0[3], v1[3], d = -middle, w = {}, share = {};
    for (int k = 0; k < 3; ++k) {
      v0[k] = (n[0] * in_moving.q0[0][k] + n[1] * in_moving.q0[1][k]) + n[2] * in_moving.q0[2][k];
      v1[k] = (n[0] * in_moving.q1[0][k] + n[1] * in_moving.q1[1][k]) + n[2] * in_moving.q1[2][k];
      d += n[k] * in_moving.p0[k] + v0[k] * static_cast<double>(fixed.centre[k]);
      w += n[k] * in_moving.p1[k] + v1[k] * static_cast<double>(fixed.centre[k]);
      share += v0[k] * static_cast<double>(m[k]);
    }
    share /= m2;
    d += share * offset;
    Lanes e = thick;
    addMagnitude(share, static_cast<double>(fixed.plate_half), e);
    for (int k = 0; k < 3; ++k) {
      const double extent = fixed.half[k];
      addMagnitude(v0[k] - share * static_cast<double>(m[k]), extent, e);
      addMagnitude(v1[k], slab.half * extent, e);
    }
    // Where there is no plate, n is zero: d and w are, and so is all of e but the allowance.
    e = e * kUp + geometry::kPlateLength * back_extra;
    clipAxis(d, w, e, pad, low, high);
  }
  std::memcpy(low_out, &low, sizeof low);
  std::memcpy(high_out, &high, sizeof high);
}

}  // namespace

NodeTest::NodeTest(const PairPiece& piece)
    : piece_(piece),
      grown_(piece.contact_distance + 2.0 * piece.frame_error),
      pad_(32.0 * kUnit * piece.motion.duration()) {}

Span NodeTest::clip(const Slab& slab, const geometry::BvhNode& a, const geometry::BvhNode& b,
                    Span span) const {
  geometry::BvhBlock block;
  for (int i = 0; i < kWidth; ++i) {
    for (int k = 0; k < 3; ++k) {
      block.centre[k][i] = b.centre[k];
      block.half[k][i] = b.half[k];
      block.plate[k][i] = static_cast<std::int8_t>(b.plate[k]);
    }
    block.plate_middle[i] = b.plate_middle;
    block.plate_half[i] = b.plate_half;
    block.reach[i] = b.reach;
  }
  Span clipped[kWidth];
  clipChildren(slab, block, false, a, span, clipped);
  return clipped[0];
}

void NodeTest::clipChildren(const Slab& slab, const geometry::BvhBlock& children, bool of_a,
                            const geometry::BvhNode& fixed, Span span, Span clipped[kWidth]) const {
  const double grown = grown_ + 2.0 * slab.half * piece_.rate_error;
  double low[kWidth], high[kWidth];
  clipBlock(slab, of_a ? slab.in_b : slab.in_a, of_a ? slab.in_a : slab.in_b, fixed, children, grown, pad_,
            span.low - slab.middle, span.high - slab.middle, low, high);
  for (int i = 0; i < kWidth; ++i) {
    clipped[i] = {std::max(span.low, slab.middle + low[i]), std::min(span.high, slab.middle + high[i])};
  }
}

namespace {

/// Does a plane across n (in the frame of `still`) stay between the triangles? The moving vertices follow the
/// slab's linear model, so both ends of the span decide; `allowance` is per unit of |n|.
bool planeBetween(const Vec3 still[3], const Vec3 early[3], const Vec3 late[3], double allowance) {
  const Vec3 n = (still[1] - still[0]).cross(still[2] - still[0]);
  double top = n.dot(still[0]), bottom = top;
  for (int i = 1; i < 3; ++i) {
    const double x = n.dot(still[i]);
    top = std::max(top, x);
    bottom = std::min(bottom, x);
  }
  double least = n.dot(early[0]), most = least;
  for (const Vec3* end : {early, late}) {
    for (int i = 0; i < 3; ++i) {
      const double x = n.dot(end[i]);
      least = std::min(least, x);
      most = std::max(most, x);
    }
  }
  const double margin = n.norm() * allowance * kUp;
  return least - top > margin || bottom - most > margin;
}

bool apartAcross(const Slab& slab, const SlabView& view, const Vec3 still[3], const Vec3 moving[3],
                 double reach, double from, double to, double grown) {
  Vec3 early[3], late[3];
  for (int i = 0; i < 3; ++i) {
    Vec3 x, rate;
    for (int k = 0; k < 3; ++k) {
      x[k] = view.p0[k] +
             (view.q0[k][0] * moving[i][0] + view.q0[k][1] * moving[i][1] + view.q0[k][2] * moving[i][2]);
      rate[k] = view.p1[k] +
                (view.q1[k][0] * moving[i][0] + view.q1[k][1] * moving[i][1] + view.q1[k][2] * moving[i][2]);
    }
    early[i] = x + from * rate;
    late[i] = x + to * rate;
  }
  const double farthest = std::max(std::abs(from), std::abs(to));
  const double remainder = 0.5 * farthest * farthest * (view.bend + slab.bend_q * reach) * kUp;
  return planeBetween(still, early, late, grown + remainder);
}

}  // namespace

bool NodeTest::trianglesApart(const Slab& slab, const Element& a, const Element& b, Span span) const {
  const Vec3 &middle_a = piece_.a.bvh().origin(), &middle_b = piece_.b.bvh().origin();
  Vec3 va[3], vb[3];
  double reach_a = 0.0, reach_b = 0.0;
  for (int i = 0; i < 3; ++i) {
    va[i] = a.vertices[i] - middle_a;
    vb[i] = b.vertices[i] - middle_b;
    reach_a = std::max(reach_a, a.vertices[i].squaredNorm());
    reach_b = std::max(reach_b, b.vertices[i].squaredNorm());
  }
  const double from = span.low - slab.middle, to = span.high - slab.middle;
  const double grown = grown_ + 2.0 * slab.half * piece_.rate_error;
  return apartAcross(slab, slab.in_a, va, vb, std::sqrt(reach_b) * kUp, from, to, grown) ||
         apartAcross(slab, slab.in_b, vb, va, std::sqrt(reach_a) * kUp, from, to, grown);
}

}  // namespace collision_node::impact
