#include "collision_node/impact/walk/node_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collision_node/impact/four_doubles.h"

namespace collision_node::impact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr int kWidth = geometry::BvhBlock::kWidth;
static_assert(kWidth == kFour);  // all children of a node side by side

COLLISION_NODE_INLINE Four load(const float from[kWidth]) {
  using Floats = float __attribute__((vector_size(kWidth * sizeof(float))));
  Floats f;
  std::memcpy(&f, from, sizeof f);
  return __builtin_convertvector(f, Four);
}

COLLISION_NODE_INLINE Four load(const std::int8_t from[kWidth]) {
  using Bytes = std::int8_t __attribute__((vector_size(kWidth)));
  using Wholes = std::int32_t __attribute__((vector_size(kWidth * sizeof(std::int32_t))));
  Bytes b;
  std::memcpy(&b, from, sizeof b);
  return __builtin_convertvector(__builtin_convertvector(b, Wholes), Four);
}

/// The times at which |d + w s| <= e, narrowed further: from `low` to `high`.
struct Times {
  Four low = -kInfinity - Four{}, high = kInfinity - Four{};

  /// Written so that NaN cuts nothing off, and that w = 0 gives quotients of infinite size: of different
  /// signs while |d| < e, else of one sign, which leaves nothing.
  COLLISION_NODE_INLINE void clip(const Four& d, const Four& w, const Four& e) {
    const Four inverse = -1.0 / w;
    const Four ahead = withSign(e, w);  // e where w moves up, -e where down
    const Four near = (d + ahead) * inverse, far = (d - ahead) * inverse;
    low = larger(near, low);
    high = smaller(far, high);
  }
};

/// rows[0] x[0] + rows[1] x[1] + rows[2] x[2]
template <typename Number>
COLLISION_NODE_INLINE Four combined(const double rows[3][kWidth], const Number x[3]) {
  return (loadFour(rows[0]) * x[0] + loadFour(rows[1]) * x[1]) + loadFour(rows[2]) * x[2];
}

constexpr double kTiny = 1e-30;  ///< keeps the quotient of two zeros at zero

/// `moving` are the children; they are seen from the frame of the node `fixed` by `in_fixed`; `in_moving` is
/// the other way round, and its matrices are the transposed ones. Returns in which lanes time is left.
COLLISION_NODE_ANY_WIDTH
unsigned clipBlock(const Slab& slab, const SlabView& in_fixed, const SlabView& in_moving,
                   const geometry::BvhBlock& fixed, int lane, const geometry::BvhBlock& moving, double grown,
                   double pad, Span span, Span clipped[kWidth]) {
  const double bend = 0.5 * slab.half * slab.half * kUp;
  const double centre[3] = {fixed.centre[0][lane], fixed.centre[1][lane], fixed.centre[2][lane]};
  const double half[3] = {fixed.half[0][lane], fixed.half[1][lane], fixed.half[2][lane]};
  Four c[3], h[3];
  for (int k = 0; k < 3; ++k) {
    c[k] = load(moving.centre[k]);
    h[k] = load(moving.half[k]);
  }
  Times times;

  // Across the faces of the fixed box.
  const Four extra = grown + bend * (in_fixed.bend + slab.bend_q * load(moving.reach));
  Four place[3], rate[3];  // of the children's centres
  for (int k = 0; k < 3; ++k) {
    place[k] = in_fixed.p0[k] + dotOf(in_fixed.q0[k], c);
    rate[k] = in_fixed.p1[k] + dotOf(in_fixed.q1[k], c);
    times.clip(place[k] - centre[k], rate[k], (half[k] + dotOf(in_fixed.extent[k], h)) * kUp + extra);
  }

  // Across those of the children. Lane k is axis k here.
  const double back_extra = grown + bend * (in_moving.bend + slab.bend_q * fixed.reach[lane]);
  const Four back_place = loadFour(in_moving.p0) + combined(in_fixed.q0, centre);
  const Four back_rate = loadFour(in_moving.p1) + combined(in_fixed.q1, centre);
  const Four back_half = combined(in_fixed.extent, half);
  for (int k = 0; k < 3; ++k)
    times.clip(back_place[k] - c[k], back_rate[k] - Four{}, (h[k] + back_half[k]) * kUp + back_extra);

  // Across the plates. A zero plate has levels and extents of zero, and the allowance lets everything pass.
  Four n[3];
  for (int k = 0; k < 3; ++k) n[k] = load(moving.plate[k]);
  const Four middle = load(moving.plate_middle), thick = load(moving.plate_half);
  const double m[3] = {static_cast<double>(fixed.plate[0][lane]), static_cast<double>(fixed.plate[1][lane]),
                       static_cast<double>(fixed.plate[2][lane])};
  const double m2 = dotOf(m, m), fixed_middle = fixed.plate_middle[lane],
               fixed_thick = fixed.plate_half[lane];
  if (m2 > 0.0) {
    const Four v0 = combined(in_fixed.q0, m);
    const Four turned = slab.half * magnitude(combined(in_fixed.q1, m));
    const Four share = dotOf(v0, n) / (dotOf(n, n) + kTiny);
    Four e = fixed_thick + magnitude(share) * thick;
    for (int k = 0; k < 3; ++k) e += (magnitude(v0[k] - share * n[k]) + turned[k]) * h[k];
    times.clip((dotOf(m, place) - fixed_middle) + share * (middle - dotOf(n, c)), dotOf(m, rate),
               e * kUp + geometry::kPlateLength * extra);
  }
  {
    Four v0[3], share = {};
    for (int k = 0; k < 3; ++k) {
      v0[k] = (n[0] * in_moving.q0[0][k] + n[1] * in_moving.q0[1][k]) + n[2] * in_moving.q0[2][k];
      share += v0[k] * m[k];
    }
    share *= 1.0 / (m2 + kTiny);
    Four e = thick + magnitude(share) * fixed_thick;
    for (int k = 0; k < 3; ++k) {
      const Four v1 = (n[0] * in_moving.q1[0][k] + n[1] * in_moving.q1[1][k]) + n[2] * in_moving.q1[2][k];
      e += (magnitude(v0[k] - share * m[k]) + slab.half * magnitude(v1)) * half[k];
    }
    times.clip((dotOf(n, back_place) - middle) + share * (fixed_middle - dotOf(m, centre)),
               dotOf(n, back_rate), e * kUp + geometry::kPlateLength * back_extra);
  }

  const Four low = slab.middle + (times.low - pad), high = slab.middle + (times.high + pad);
  const Four from = larger(low, span.low - Four{}), to = smaller(high, span.high - Four{});
  for (int i = 0; i < kWidth; ++i) clipped[i] = {from[i], to[i]};
  return whereOrdered(from, to);
}

}  // namespace

NodeTest::NodeTest(const PairPiece& piece)
    : piece_(piece),
      grown_(piece.contact_distance + 2.0 * piece.frame_error),
      pad_(32.0 * kUnit * piece.motion.duration()) {}

unsigned NodeTest::clipChildren(const Slab& slab, const geometry::BvhBlock& children, bool of_a,
                                const geometry::BvhBlock& fixed, int lane, Span span,
                                Span clipped[kWidth]) const {
  const double grown = grown_ + 2.0 * slab.half * piece_.rate_error;
  return clipBlock(slab, of_a ? slab.in_b : slab.in_a, of_a ? slab.in_a : slab.in_b, fixed, lane, children,
                   grown, pad_, span, clipped);
}

/// The distance of two material points changes no faster than they move against each other.
bool NodeTest::nodesApart(const Slab& slab, const geometry::BvhBlock& block_a, int lane_a,
                          const geometry::BvhBlock& block_b, int lane_b, Span span) const {
  const motion::RelativeMotion& m = piece_.motion;
  double distance2 = 0.0, half_a2 = 0.0, half_b2 = 0.0;
  for (int i = 0; i < 3; ++i) {
    double x = slab.in_a.p0[i] - block_a.centre[i][lane_a];
    for (int k = 0; k < 3; ++k) x += slab.in_a.q0[i][k] * block_b.centre[k][lane_b];
    distance2 += x * x;
    half_a2 += static_cast<double>(block_a.half[i][lane_a]) * block_a.half[i][lane_a];
    half_b2 += static_cast<double>(block_b.half[i][lane_b]) * block_b.half[i][lane_b];
  }
  const double farthest = std::max(slab.middle - span.low, span.high - slab.middle) + pad_;
  const double speed = m.maxSpeed() + m.spinA() * block_a.reach[lane_a] + m.spinB() * block_b.reach[lane_b];
  const double reach = std::sqrt(half_a2) + std::sqrt(half_b2) + farthest * speed + grown_;
  return distance2 > squareAbove(reach * kUp);
}

namespace {

/// Does a plane across n (in the frame of `still`) stay between the triangles? The moving vertices follow the
/// slab's linear model, so both ends of the span decide; `allowance` is per unit of |n|.
bool planeBetween(const Vec3 still[3], const Vec3 early[3], const Vec3 late[3], double allowance) {
  constexpr double kLeast2 = 1e-280;  // with less, the norm and the margin with it may be lost
  const Vec3 n = (still[1] - still[0]).cross(still[2] - still[0]);
  const double length2 = n.squaredNorm();
  if (!(length2 > kLeast2)) return false;
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
  const double margin = std::sqrt(length2) * allowance * kUp;
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
