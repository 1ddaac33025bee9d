#include "collision_node/impact/linear/exact_polygon.h"

namespace collision_node::impact {
namespace {

/// An exact number: a sum of doubles that do not overlap, from the smallest on. Source: Shewchuk, "Adaptive
/// precision floating-point arithmetic and fast robust geometric predicates", 1997.
/// `broken` when the room did not suffice or a product underflowed; it spreads.
class Exact {
 public:
  Exact() = default;
  explicit Exact(const DoubleDouble& value) {
    add(value.low);
    add(value.high);
  }

  void add(double value) {
    double carry = value;
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      const DoubleDouble sum = twoSum(carry, terms_[i]);
      carry = sum.high;
      if (sum.low != 0.0) terms_[kept++] = sum.low;
    }
    if (kept == kRoom) {
      broken_ = true;
      return;
    }
    if (carry != 0.0) terms_[kept++] = carry;
    count_ = kept;
  }

  /// Adds sign * a * b.
  void addProduct(const Exact& a, const Exact& b, double sign) {
    broken_ = broken_ || a.broken_ || b.broken_;
    for (int i = 0; i < a.count_; ++i) {
      for (int j = 0; j < b.count_; ++j) {
        const DoubleDouble product = twoProduct(sign * a.terms_[i], b.terms_[j]);
        if (!(std::abs(product.high) > 0x1p-900)) broken_ = true;
        add(product.low);
        add(product.high);
      }
    }
    compress();
  }

  int sign() const { return count_ == 0 ? 0 : (terms_[count_ - 1] > 0.0 ? 1 : -1); }
  bool broken() const { return broken_; }

 private:
  /// The same value in as few terms as its bits need.
  void compress() {
    if (count_ == 0) return;
    std::array<double, kRoom> from_top;
    int tops = 0;
    double carry = terms_[count_ - 1];
    for (int i = count_ - 2; i >= 0; --i) {
      const DoubleDouble sum = quickTwoSum(carry, terms_[i]);
      carry = sum.high;
      if (sum.low != 0.0) {
        from_top[tops++] = carry;
        carry = sum.low;
      }
    }
    int kept = 0;
    for (int i = tops - 1; i >= 0; --i) {
      const DoubleDouble sum = quickTwoSum(from_top[i], carry);
      carry = sum.high;
      if (sum.low != 0.0) terms_[kept++] = sum.low;
    }
    if (carry != 0.0) terms_[kept++] = carry;
    count_ = kept;
  }

  static constexpr int kRoom = 64;
  std::array<double, kRoom> terms_;
  int count_ = 0;
  bool broken_ = false;
};

using ExactTriple = std::array<Exact, 3>;

ExactTriple crossOf(const ExactTriple& a, const ExactTriple& b) {
  ExactTriple c;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    c[i].addProduct(a[j], b[k], 1.0);
    c[i].addProduct(a[k], b[j], -1.0);
  }
  return c;
}

Exact dotOf(const ExactTriple& a, const ExactTriple& b) {
  Exact sum;
  for (int i = 0; i < 3; ++i) sum.addProduct(a[i], b[i], 1.0);
  return sum;
}

bool anyBroken(const ExactTriple& a) { return a[0].broken() || a[1].broken() || a[2].broken(); }

}  // namespace

bool holdsOriginAt(const MovingPolygon<DoubleDouble>& polygon, double weight, double later) {
  const int count = polygon.count;
  std::array<ExactTriple, 4> w;
  const Exact early(DoubleDouble(later - weight)), late{DoubleDouble(weight)};
  for (int k = 0; k < count; ++k) {
    const Triple<DoubleDouble>&s = polygon.start[k], &e = polygon.end[k];
    const std::array<const DoubleDouble*, 3> from = {&s.x, &s.y, &s.z}, to = {&e.x, &e.y, &e.z};
    for (int i = 0; i < 3; ++i) {
      w[k][i].addProduct(Exact(*from[i]), early, 1.0);
      w[k][i].addProduct(Exact(*to[i]), late, 1.0);
    }
  }
  // In the polygon's plane: w_0 . (w_1 x w_last).
  const Exact height = dotOf(w[0], crossOf(w[1], w[count - 1]));
  if (height.broken() || height.sign() != 0) return false;
  // Sides seen from the origin. Over a plane they all wind one way, and add up to the normal; of a polygon
  // that is a segment through the origin, none winds and two corners lie on opposite sides.
  std::array<int, 3> left = {0, 0, 0}, right = {0, 0, 0};
  for (int k = 0; k < count; ++k) {
    const ExactTriple side = crossOf(w[k], w[(k + 1) % count]);
    if (anyBroken(side)) return false;
    for (int i = 0; i < 3; ++i) {
      left[i] += side[i].sign() > 0;
      right[i] += side[i].sign() < 0;
    }
  }
  bool winds = false;
  for (int i = 0; i < 3; ++i) {
    if (left[i] > 0 && right[i] > 0) return false;
    winds = winds || left[i] > 0 || right[i] > 0;
  }
  if (winds) return true;
  for (int k = 0; k < count; ++k) {
    for (int l = 0; l <= k; ++l) {
      const Exact product = dotOf(w[k], w[l]);
      if (!product.broken() && product.sign() <= 0) return true;
    }
  }
  return false;
}

void simplestFraction(double low, double high, double* weight, double* later) {
  // Continued fractions of both ends agree until a whole number fits between the remainders.
  double p0 = 0.0, q0 = 1.0, p1 = 1.0, q1 = 0.0;
  for (int i = 0; i < 24; ++i) {
    const double whole = std::ceil(low);
    const bool fits = whole <= high;
    const double a = fits ? whole : std::floor(low);
    const double p = a * p1 + p0, q = a * q1 + q0;
    if (q > 0x1p45) break;
    p0 = p1;
    q0 = q1;
    p1 = p;
    q1 = q;
    if (fits) break;
    const double next_low = 1.0 / (high - a), next_high = 1.0 / (low - a);
    low = next_low;
    high = next_high;
  }
  *weight = p1;
  *later = q1;
}

}  // namespace collision_node::impact
