#include "collision_node/impact/linear/linear_features.h"

#include "collision_node/impact/linear/exact_polygon.h"

namespace collision_node::impact {
namespace {

// Steps before a stage hands over to the next; a stage that closes in on a contact needs fewer than ten.
constexpr int kDoubleSteps = 24;
constexpr int kFineSteps = 40;
constexpr double kNarrow = 1e-14;  // a bracket that doubles leave and that is as good as any

/// x - y, exactly.
Triple<DoubleDouble> difference(const Vec3& x, const Vec3& y) {
  return {twoSum(x.x(), -y.x()), twoSum(x.y(), -y.y()), twoSum(x.z(), -y.z())};
}

class LinearQuery {
 public:
  explicit LinearQuery(int count) { fine_.count = coarse_.count = count; }

  void setCorner(int k, const LinearVertex& x, const LinearVertex& y) {
    fine_.start[k] = difference(x.start, y.start);
    fine_.end[k] = difference(x.end, y.end);
  }

  LinearContact answer() {
    if (boxesApart()) return clear();
    if (!normalise()) return {};
    LinearContact contact;
    contact.t_lo = apartUntil(coarse_, 0.0, 1.0, kDoubleSteps);
    if (contact.t_lo == 1.0) return clear();
    contact.t_hi = crossingFrom(coarse_, contact.t_lo, 1.0);
    if (contact.t_hi <= 1.0) return impact(contact);

    // Where doubles see no crossing but close in from both sides, the time is often a simple fraction.
    contact.t_hi = apartUntil(coarse_, 1.0, contact.t_lo, kDoubleSteps);
    if (contact.t_hi == contact.t_lo) return clear();
    double weight, later;
    if (exact_ && contact.t_hi - contact.t_lo < 4.0 * kNarrow &&
        touchesAtSimplest(contact.t_lo, contact.t_hi, &weight, &later)) {
      const LinearContact touch = touched(contact, weight, later);
      if (touch.t_hi - touch.t_lo < kNarrow) return touch;
    }
    const double none_after = contact.t_hi;

    contact.t_lo = apartUntil(fine_, contact.t_lo, 1.0, kFineSteps);
    if (contact.t_lo == 1.0) return clear();
    contact.t_hi = crossingFrom(fine_, contact.t_lo, 1.0);
    if (contact.t_hi <= 1.0) return impact(contact);

    contact.t_hi = apartUntil(fine_, std::max(none_after, contact.t_lo), contact.t_lo, kFineSteps);
    if (contact.t_hi == contact.t_lo) return clear();
    return touching(contact);
  }

 private:
  static LinearContact clear() {
    const double none = std::numeric_limits<double>::quiet_NaN();
    return {LinearVerdict::kClear, none, none};
  }
  static LinearContact impact(LinearContact contact) {
    contact.verdict = LinearVerdict::kImpact;
    return contact;
  }

  /// Along some coordinate axis all corners stay on one side. A rounded difference has the exact one's sign.
  bool boxesApart() const {
    for (const auto axis : {&Triple<DoubleDouble>::x, &Triple<DoubleDouble>::y, &Triple<DoubleDouble>::z}) {
      bool above = true, below = true;
      for (int k = 0; k < fine_.count; ++k) {
        const double from = (fine_.start[k].*axis).high, to = (fine_.end[k].*axis).high;
        above = above && from > 0.0 && to > 0.0;
        below = below && from < 0.0 && to < 0.0;
      }
      if (above || below) return true;
    }
    return false;
  }

  /// Scales by a power of two, which is exact, to the size that MovingPolygon asks for.
  bool normalise() {
    double size = 0.0;
    const auto eachNumber = [&](auto&& apply) {
      for (int k = 0; k < fine_.count; ++k) {
        for (Triple<DoubleDouble>* corner : {&fine_.start[k], &fine_.end[k]}) {
          apply(corner->x);
          apply(corner->y);
          apply(corner->z);
        }
      }
    };
    bool finite = true;
    eachNumber([&](const DoubleDouble& number) {
      finite = finite && std::isfinite(number.high) && std::isfinite(number.low);
      size = std::max(size, std::abs(number.high));
    });
    if (!finite) return false;
    if (size == 0.0) {
      coarse_ = {fine_.count, {}, {}};
      return true;
    }
    const int exponent = std::ilogb(size) + 1;
    if (exponent < -900 || exponent > 1000) return false;
    const double scale = std::ldexp(1.0, -exponent), back = std::ldexp(1.0, exponent);
    eachNumber([&](DoubleDouble& number) {
      const DoubleDouble scaled(number.high * scale, number.low * scale);
      exact_ = exact_ && scaled.high * back == number.high && scaled.low * back == number.low;
      number = scaled;
    });
    for (int k = 0; k < fine_.count; ++k) {
      coarse_.start[k] = {fine_.start[k].x.high, fine_.start[k].y.high, fine_.start[k].z.high};
      coarse_.end[k] = {fine_.end[k].x.high, fine_.end[k].y.high, fine_.end[k].z.high};
    }
    return true;
  }

  /// The simplest fraction weight / later between the two, and whether the features touch there, exactly.
  bool touchesAtSimplest(double low, double high, double* weight, double* later) const {
    simplestFraction(low, high, weight, later);
    if (!(*weight >= 0.0 && *weight <= *later && *later > 0.0)) return false;
    return holdsOriginAt(fine_, *weight, *later);
  }

  /// They touch at weight / later: no later than one step above the quotient, and never beyond t_hi.
  static LinearContact touched(LinearContact contact, double weight, double later) {
    const double above = weight == 0.0 ? 0.0 : std::nextafter(weight / later, 2.0);
    contact.t_hi = std::max(contact.t_lo, std::min(contact.t_hi, above));
    return impact(contact);
  }

  /// All contact lies in the bracket, and no crossing was found where it begins: a touch that does not cross,
  /// or one at an end of [0, 1], may be exact at a simple fraction.
  LinearContact touching(LinearContact contact) const {
    if (!exact_) return contact;
    for (const double width : {0x1p-50, 0x1p-32, 0x1p-16, 1.0}) {
      double weight, later;
      if (touchesAtSimplest(contact.t_lo, std::min(contact.t_hi, contact.t_lo + width), &weight, &later))
        return touched(contact, weight, later);
      if (contact.t_lo + width >= contact.t_hi) break;  // that was all of it
    }
    return contact;
  }

  MovingPolygon<DoubleDouble> fine_;
  MovingPolygon<double> coarse_;
  bool exact_ = true;  ///< scaling lost no bit
};

}  // namespace

LinearContact vertexFaceContact(const LinearVertex& vertex, const std::array<LinearVertex, 3>& face) {
  LinearQuery query(3);
  for (int k = 0; k < 3; ++k) query.setCorner(k, vertex, face[k]);
  return query.answer();
}

LinearContact edgeEdgeContact(const std::array<LinearVertex, 2>& a, const std::array<LinearVertex, 2>& b) {
  LinearQuery query(4);
  query.setCorner(0, a[0], b[0]);
  query.setCorner(1, a[0], b[1]);
  query.setCorner(2, a[1], b[1]);
  query.setCorner(3, a[1], b[0]);
  return query.answer();
}

}  // namespace collision_node::impact
