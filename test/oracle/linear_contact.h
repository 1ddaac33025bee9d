/// When do a vertex and a triangle, or two edges, touch while every vertex moves on its own straight line
/// over [0, 1]? Decided exactly, slowly: coplanarity is a cubic with rational coefficients, its roots are
/// isolated by Sturm sequences, and every sign the inside tests ask for is that of a polynomial at such a
/// root.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace oracle {

using Rational = mpq_class;
using Polynomial = std::vector<Rational>;  ///< lowest power first, no leading zero; empty is 0

inline Polynomial trimmed(Polynomial p) {
  while (!p.empty() && p.back() == 0) p.pop_back();
  return p;
}
inline Polynomial sum(const Polynomial& a, const Polynomial& b, int sign = 1) {
  Polynomial c(std::max(a.size(), b.size()));
  for (std::size_t i = 0; i < a.size(); ++i) c[i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i) c[i] += sign * b[i];
  return trimmed(c);
}
inline Polynomial product(const Polynomial& a, const Polynomial& b) {
  if (a.empty() || b.empty()) return {};
  Polynomial c(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) c[i + j] += a[i] * b[j];
  }
  return trimmed(c);
}
inline int signAt(const Polynomial& p, const Rational& t) {
  Rational value = 0;
  for (auto c = p.rbegin(); c != p.rend(); ++c) value = value * t + *c;
  return sgn(value);
}
inline Polynomial derivative(const Polynomial& p) {
  Polynomial d;
  for (std::size_t i = 1; i < p.size(); ++i) d.push_back(p[i] * static_cast<unsigned long>(i));
  return trimmed(d);
}
/// a = quotient b + remainder.
inline Polynomial remainderOf(Polynomial a, const Polynomial& b, Polynomial* quotient = nullptr) {
  if (quotient != nullptr) quotient->assign(a.size() >= b.size() ? a.size() - b.size() + 1 : 0, 0);
  while (a.size() >= b.size()) {
    const std::size_t shift = a.size() - b.size();
    const Rational factor = a.back() / b.back();
    if (quotient != nullptr) (*quotient)[shift] = factor;
    for (std::size_t i = 0; i < b.size(); ++i) a[i + shift] -= factor * b[i];
    a = trimmed(a);
  }
  return a;
}
inline Polynomial commonFactor(Polynomial a, Polynomial b) {
  while (!b.empty()) {
    Polynomial r = remainderOf(a, b);
    a = std::move(b);
    b = std::move(r);
  }
  return a;
}

/// Number of different roots of a non-zero polynomial in (low, high].
class RootCounter {
 public:
  explicit RootCounter(const Polynomial& p) {
    const Polynomial common = commonFactor(p, derivative(p));
    Polynomial free;
    remainderOf(p, common, &free);
    chain_ = {free, derivative(free)};
    while (!chain_.back().empty()) {
      chain_.push_back(sum({}, remainderOf(chain_[chain_.size() - 2], chain_.back()), -1));
    }
    chain_.pop_back();
  }
  int count(const Rational& low, const Rational& high) const { return changes(low) - changes(high); }

 private:
  int changes(const Rational& t) const {
    int found = 0, last = 0;
    for (const Polynomial& p : chain_) {
      const int sign = signAt(p, t);
      if (sign != 0 && last != 0 && sign != last) ++found;
      if (sign != 0) last = sign;
    }
    return found;
  }
  std::vector<Polynomial> chain_;
};

/// The one root of `of` in (low, high], or exactly `high` when low == high.
struct Moment {
  Polynomial of;
  Rational low, high;

  void halve(const RootCounter& counter) {
    const Rational middle = (low + high) / 2;
    (counter.count(low, middle) > 0 ? high : low) = middle;
  }
  int sign(const Polynomial& g) const {
    if (g.empty()) return 0;
    if (low == high) return signAt(g, high);
    const Polynomial common = commonFactor(of, g);
    if (common.size() > 1 && RootCounter(common).count(low, high) > 0) return 0;
    const RootCounter mine(of), other(g);
    Moment close = *this;
    while (other.count(close.low, close.high) > 0) close.halve(mine);
    return signAt(g, close.high);
  }
};

/// Every root in [0, 1], in order; brackets no wider than 2^-70.
inline std::vector<Moment> momentsOf(const Polynomial& p) {
  std::vector<Moment> moments;
  if (p.size() < 2) return moments;
  if (signAt(p, 0) == 0) moments.push_back({p, 0, 0});
  const RootCounter counter(p);
  const Rational width(1, mpz_class(1) << 70);
  const std::function<void(Rational, Rational)> split = [&](const Rational& low, const Rational& high) {
    const int roots = counter.count(low, high);
    if (roots == 0) return;
    if (roots == 1) {
      Moment moment{p, low, high};
      while (moment.high - moment.low > width) moment.halve(counter);
      moments.push_back(moment);
      return;
    }
    const Rational middle = (low + high) / 2;
    split(low, middle);
    split(middle, high);
  };
  split(0, 1);
  return moments;
}

using Position = std::array<Polynomial, 3>;

inline Position between(const Position& a, const Position& b) {
  return {sum(b[0], a[0], -1), sum(b[1], a[1], -1), sum(b[2], a[2], -1)};
}
inline Polynomial dot(const Position& a, const Position& b) {
  return sum(sum(product(a[0], b[0]), product(a[1], b[1])), product(a[2], b[2]));
}
inline Position cross(const Position& a, const Position& b) {
  Position c;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    c[i] = sum(product(a[j], b[k]), product(a[k], b[j]), -1);
  }
  return c;
}

/// Four moving vertices: vertex and triangle (one against three), or two edges (two against two).
class LinearPair {
 public:
  LinearPair(const std::array<Position, 4>& vertices, bool edges) : x_(vertices), edges_(edges) {
    const Position u = between(x_[0], x_[1]), v = between(x_[0], x_[2]), w = between(x_[0], x_[3]);
    coplanar_ = dot(u, cross(v, w));
    if (edges_) {
      const Position a = between(x_[0], x_[1]), b = between(x_[2], x_[3]);
      normal_ = cross(a, b);
      // Each pair lies on both sides of the other's line.
      sides_ = {cross(a, between(x_[0], x_[2])), cross(a, between(x_[0], x_[3])),
                cross(b, between(x_[2], x_[0])), cross(b, between(x_[2], x_[1]))};
      for (const auto& [p, a0, a1] :
           {std::array{0, 2, 3}, std::array{1, 2, 3}, std::array{2, 0, 1}, std::array{3, 0, 1}}) {
        addOnSegment(p, a0, a1);
      }
    } else {
      normal_ = cross(between(x_[1], x_[2]), between(x_[1], x_[3]));
      for (int k = 1; k <= 3; ++k) {
        const int next = k == 3 ? 1 : k + 1;
        sides_.push_back(cross(between(x_[k], x_[next]), between(x_[k], x_[0])));
        addOnSegment(0, k, next);
      }
    }
  }

  /// A bracket, no wider than 2^-70, of the first touch in [0, 1].
  std::optional<Moment> firstTouch() const {
    std::vector<Moment> candidates;
    if (coplanar_.empty()) {
      // Contact is a closed set of times: if there is any, some lies at an end or where a sign changes.
      candidates = {{{}, 0, 0}, {{}, 1, 1}};
      for (const Position* p : signs()) {
        for (const Polynomial& component : *p) append(candidates, component);
      }
      for (const Segment& s : segments_) append(candidates, s.between);
      std::sort(candidates.begin(), candidates.end(),
                [](const Moment& a, const Moment& b) { return a.low < b.low; });
    } else {
      candidates = momentsOf(coplanar_);
    }
    for (const Moment& moment : candidates) {
      if (touchesAt(moment)) return moment;
    }
    return std::nullopt;
  }

 private:
  struct Segment {
    Position off;        ///< zero: on the line
    Polynomial between;  ///< <= 0: and between the ends
  };

  static void append(std::vector<Moment>& to, const Polynomial& p) {
    for (const Moment& moment : momentsOf(p)) to.push_back(moment);
  }
  void addOnSegment(int point, int a, int b) {
    const Position from = between(x_[point], x_[a]), to = between(x_[point], x_[b]);
    segments_.push_back({cross(from, to), dot(from, to)});
  }
  std::vector<const Position*> signs() const {
    std::vector<const Position*> all = {&normal_};
    for (const Position& p : sides_) all.push_back(&p);
    for (const Segment& s : segments_) all.push_back(&s.off);
    return all;
  }

  bool touchesAt(const Moment& t) const {
    for (int i = 0; i < 3; ++i) {
      const int up = t.sign(normal_[i]);
      if (up == 0) continue;
      std::vector<int> side;
      for (const Position& p : sides_) side.push_back(t.sign(p[i]));
      if (edges_) return side[0] * side[1] <= 0 && side[2] * side[3] <= 0;
      return up * side[0] >= 0 && up * side[1] >= 0 && up * side[2] >= 0;
    }
    for (const Segment& s : segments_) {
      if (t.sign(s.off[0]) == 0 && t.sign(s.off[1]) == 0 && t.sign(s.off[2]) == 0 && t.sign(s.between) <= 0) {
        return true;
      }
    }
    return false;
  }

  std::array<Position, 4> x_;
  bool edges_;
  Polynomial coplanar_;
  Position normal_;
  std::vector<Position> sides_;
  std::vector<Segment> segments_;
};

}  // namespace oracle
