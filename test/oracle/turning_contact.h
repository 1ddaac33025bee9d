/// When do the surfaces of two moving, turning polyhedra first meet? A certified enclosure of the instant.
///
/// Interval bisection in time over all pairs of a vertex and a face and of two edges. Time is left out only
/// where each pair is proved not to meet on it: its function has one sign throughout, or the place where it
/// vanishes is outside the feature. Enclosures are taken directly and in mean value form,
/// f(T) in f(m) + (T - m) f'(T), whose derivative also gives an interval Newton step. Quick intervals first,
/// 240 bits where they end. Contact is proved by a change of sign of one pair's function over an interval on
/// which it vanishes inside both features, or by an edge that pierces a triangle at one instant.
#pragma once

#include <algorithm>
#include <optional>

#include "test/oracle/turning_pair.h"

namespace oracle {

struct SurfaceTouch {
  bool found = false;    ///< false: proved apart over the whole time asked for
  bool proven = false;   ///< contact is proved within [lo, hi]; else nothing is known from lo on
  bool gave_up = false;  ///< the work allowed ran out; nothing is known from lo on
  Mp lo, hi;             ///< [s] apart before lo; contact at or before hi when proven
  bool facts = false;    ///< the two below are known
  I3 point;              ///< one contact point within [lo, hi], from a's origin, world axes
  I3 normal;             ///< from a to b, not unit
};

class TurningContact {
 public:
  TurningContact(const Polyhedron& shape_a, const StampedMotion& a, const Polyhedron& shape_b,
                 const StampedMotion& b, std::int64_t start_ns, std::int64_t end_ns)
      : shape_{shape_a, shape_b},
        a_(a.positionFrom(start_ns)),
        quick_(shape_a, a, shape_b, b, start_ns),
        exact_(shape_a, a, shape_b, b, start_ns),
        duration_(1e-9 * static_cast<double>(end_ns - start_ns)) {}

  double duration() const { return duration_; }  ///< rounded

  /// The first contact of the surfaces within [from, to].
  SurfaceTouch firstTouch(double from, double to, long max_work = 3000000) const {
    Search search{max_work, {}};
    sweep(quick_, Quick(from, to), quick_.allFeatures(), duration_ * 0x1p-36, search,
          [&](const Quick& t, const std::vector<FeaturePair>& left) {
            return sweep(exact_, Interval(Mp(t.lo), Mp(t.hi)), left, duration_ * 0x1p-110, search,
                         [&](const Interval& u, const std::vector<FeaturePair>& near) {
                           settle(u, near, from, to, search.touch);
                           return true;
                         });
          });
    return search.touch;
  }

  /// Whether an edge of one body clearly pierces a triangle of the other at one instant: five orientation
  /// signs.
  bool pierces(const Mp& t) const {
    const auto x = exact_.at(Interval(t, t));
    for (int e = 0; e < 2; ++e) {
      const std::vector<I3> ends = placed(e, x), corners = placed(1 - e, x);
      for (const auto& [i, j] : shape_[e].edges()) {
        for (const auto& f : shape_[1 - e].triangles) {
          if (piercesOne(ends[static_cast<std::size_t>(i)], ends[static_cast<std::size_t>(j)], corners, f))
            return true;
        }
      }
    }
    return false;
  }

  /// Whether a plane through a face, or one along an edge of each, clearly has the two on its two sides at
  /// one instant. Complete for convex bodies.
  bool separated(const Mp& t) const {
    const auto x = exact_.at(Interval(t, t));
    const std::vector<I3> a = placed(0, x), b = placed(1, x);
    const auto parts = [&](const I3& n) { return onOneSide(n, a, b) || onOneSide(n, b, a); };
    for (int k = 0; k < 2; ++k) {
      for (const auto& f : exact_.body(k).faces)
        if (parts(exact_.vector(k, f.plane.normal, x))) return true;
    }
    for (const auto& e : exact_.body(0).edges) {
      for (const auto& g : exact_.body(1).edges) {
        if (parts(crossOf(exact_.vector(0, e.along, x), exact_.vector(1, g.along, x)))) return true;
      }
    }
    return false;
  }

  /// World place of a point given from a's origin.
  I3 world(const Interval& t, const I3& point) const {
    return plus(point, plus(a_[0], times(t, plus(a_[1], times(t, plus(a_[2], times(t, a_[3])))))));
  }
  const TurningPair<Interval>& exact() const { return exact_; }

 private:
  struct Search {
    long work;
    SurfaceTouch touch;
  };

  /// Depth first, earliest first, down to `finest`; what is left there goes to `leaf`. True ends the search.
  template <class I, class Leaf>
  bool sweep(const TurningPair<I>& pair, I t, const std::vector<FeaturePair>& features, double finest,
             Search& search, const Leaf& leaf) const {
    const double width = widthOf(t);
    const auto m = middleOf(t);
    const auto over = pair.at(t);
    if (pair.apartByReach(over)) return false;
    const auto mid = pair.at(I(m, m));
    std::vector<FeaturePair> left;
    std::optional<I> where;  // the hull of where those left may meet
    for (const FeaturePair& f : features) {
      I at = t;
      if (!mayMeet(pair, f, t, I(m, m), over, mid, at)) continue;
      left.push_back(f);
      if (!where) where = at;
      if (at.lo < where->lo) where->lo = at.lo;
      if (where->hi < at.hi) where->hi = at.hi;
    }
    search.work -= static_cast<long>(features.size());
    if (left.empty()) return false;
    if (search.work < 0) {
      search.touch.found = search.touch.gave_up = true;
      convertEnd(t.lo, search.touch.lo);
      return true;
    }
    t = *where;
    if (widthOf(t) <= finest) return leaf(t, left);
    if (widthOf(t) < 0.5 * width) return sweep(pair, t, left, finest, search, leaf);
    const auto half = middleOf(t);
    return sweep(pair, I(t.lo, half), left, finest, search, leaf) ||
           sweep(pair, I(half, t.hi), left, finest, search, leaf);
  }
  static void convertEnd(double from, Mp& to) { to = Mp(from); }
  static void convertEnd(const Mp& from, Mp& to) { to = from; }

  /// False when the two are proved not to meet during t. Else `at` is narrowed to where they may.
  template <class I, class Instant>
  static bool mayMeet(const TurningPair<I>& pair, const FeaturePair& f, const I& t, const I& m,
                      const Instant& over, const Instant& mid, I& at) {
    I middle, rate;
    if (f.edges) {
      const auto c = pair.crossing(f, over);
      if (hasSign(c.volume) || !reachEachOther(c) || c.u.negative() || c.v.negative() ||
          (c.whole - c.u).negative() || (c.whole - c.v).negative())
        return false;
      middle = pair.crossing(f, mid).volume;
      rate = pair.volumeRate(f, c, over);
    } else {
      const auto& face = pair.body(f.face_body).faces[f.i];
      const auto& vertex = pair.body(1 - f.face_body).vertices[f.j];
      const auto p = pair.vertexFrom(f.face_body, vertex, over);
      if (hasSign(pair.height(f.face_body, face.plane, p, over))) return false;
      const auto p_rate = pair.vertexRateFrom(f.face_body, vertex, over);
      const auto p_mid = pair.vertexFrom(f.face_body, vertex, mid);
      for (const auto& border : face.border) {
        if (pair.height(f.face_body, border, p, over).negative()) return false;
        const I slope = pair.heightRate(f.face_body, border, p, p_rate, over);
        if ((pair.height(f.face_body, border, p_mid, mid) + (t - m) * slope).negative()) return false;
      }
      middle = pair.height(f.face_body, face.plane, p_mid, mid);
      rate = pair.heightRate(f.face_body, face.plane, p, p_rate, over);
    }
    if (hasSign(middle + (t - m) * rate)) return false;
    if (!hasSign(rate)) return true;
    const I root = m - middle / rate;  // Newton
    if (at.lo < root.lo) at.lo = root.lo;
    if (root.hi < at.hi) at.hi = root.hi;
    return !(at.hi < at.lo);
  }

  template <class I>
  static bool hasSign(const I& x) {
    return x.positive() || x.negative();
  }

  /// The boxes around two edges; tells also where they are parallel.
  template <class Crossing>
  static bool reachEachOther(const Crossing& c) {
    for (std::size_t k = 0; k < 3; ++k) {
      // the second edge's ends less the first's, all four
      const auto r = c.r[k], s = r + c.d2[k];
      const auto q = r - c.d1[k], w = s - c.d1[k];
      if ((r.positive() && s.positive() && q.positive() && w.positive()) ||
          (r.negative() && s.negative() && q.negative() && w.negative()))
        return false;
    }
    return true;
  }

  /// Proves contact about the instant u, which could not be left out.
  void settle(const Interval& u, const std::vector<FeaturePair>& near, double from, double to,
              SurfaceTouch& touch) const {
    touch.found = true;
    touch.lo = touch.hi = u.lo;
    Mp grown(duration_ * 0x1p-110), upper, lower;
    for (int i = 0; i < 40 && !touch.proven; ++i) {
      mpfr_mul_2ui(grown.raw(), grown.raw(), 2, MPFR_RNDN);
      mpfr_sub(lower.raw(), u.lo.raw(), grown.raw(), MPFR_RNDN);
      mpfr_add(upper.raw(), u.hi.raw(), grown.raw(), MPFR_RNDN);
      if (lower < Mp(from)) lower = Mp(from);
      if (Mp(to) < upper) upper = Mp(to);
      for (const FeaturePair& f : near) {
        if (i < 8 && meets(f, Interval(lower, upper), touch)) touch.proven = touch.facts = true;
      }
      if (!touch.proven && pierces(upper)) touch.proven = true;
      touch.hi = upper;
    }
  }

  /// True when f's function changes sign over t, and vanishes inside both features wherever it does.
  bool meets(const FeaturePair& f, const Interval& t, SurfaceTouch& touch) const {
    const auto begin = exact_.at(Interval(t.lo, t.lo)), end = exact_.at(Interval(t.hi, t.hi));
    const auto over = exact_.at(t);
    const auto opposite = [](const Interval& x, const Interval& y) {
      return (x.positive() && y.negative()) || (x.negative() && y.positive());
    };
    if (f.edges) {
      const auto c = exact_.crossing(f, over);
      const Interval first = exact_.crossing(f, begin).volume;
      if (!opposite(first, exact_.crossing(f, end).volume)) return false;
      if (!c.u.positive() || !c.v.positive() || !(c.whole - c.u).positive() || !(c.whole - c.v).positive())
        return false;
      touch.point = plus(c.x1, times(c.u / c.whole, c.d1));
      touch.normal = times(first.positive() ? 1 : -1, c.n);
      return true;
    }
    const auto& face = exact_.body(f.face_body).faces[f.i];
    const auto& vertex = exact_.body(1 - f.face_body).vertices[f.j];
    const auto heightAt = [&](const auto& x) {
      return exact_.height(f.face_body, face.plane, exact_.vertexFrom(f.face_body, vertex, x), x);
    };
    const Interval first = heightAt(begin);
    if (!opposite(first, heightAt(end))) return false;
    const auto p = exact_.vertexFrom(f.face_body, vertex, over);
    for (const auto& border : face.border) {
      if (!exact_.height(f.face_body, border, p, over).positive()) return false;
    }
    touch.point = f.face_body == 0 ? p : exact_.vector(0, vertex, over);
    touch.normal = times(first.positive() == (f.face_body == 0) ? 1 : -1,
                         exact_.vector(f.face_body, face.plane.normal, over));
    return true;
  }

  std::vector<I3> placed(int body, const TurningPair<Interval>::Instant& x) const {
    std::vector<I3> all;
    for (const auto& vertex : exact_.body(body).vertices) {
      const I3 own = exact_.vector(body, vertex, x);
      all.push_back(body == 0 ? own : plus(own, x.d));
    }
    return all;
  }

  static Interval orientation(const I3& p, const I3& q, const I3& r, const I3& s) {
    return dotOf(minus(q, p), crossOf(minus(r, p), minus(s, p)));
  }
  static bool piercesOne(const I3& from, const I3& to, const std::vector<I3>& v,
                         const std::array<int, 3>& f) {
    const I3 &p = v[static_cast<std::size_t>(f[0])], &q = v[static_cast<std::size_t>(f[1])],
             &r = v[static_cast<std::size_t>(f[2])];
    const Interval above = orientation(p, q, r, from), below = orientation(p, q, r, to);
    if (!((above.positive() && below.negative()) || (above.negative() && below.positive()))) return false;
    const Interval s0 = orientation(from, to, p, q), s1 = orientation(from, to, q, r),
                   s2 = orientation(from, to, r, p);
    return (s0.positive() && s1.positive() && s2.positive()) ||
           (s0.negative() && s1.negative() && s2.negative());
  }
  static bool onOneSide(const I3& n, const std::vector<I3>& low, const std::vector<I3>& high) {
    for (const I3& x : low) {
      for (const I3& y : high) {
        if (!dotOf(n, minus(y, x)).positive()) return false;
      }
    }
    return true;
  }

  Polyhedron shape_[2];
  std::array<I3, 4> a_;
  TurningPair<Quick> quick_;
  TurningPair<Interval> exact_;
  double duration_;
};

}  // namespace oracle
