#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "collision_node/report/methods/own_methods.h"
#include "collision_node/report/methods/peer_models.h"
#include "collision_node/report/methods/static_test.h"

namespace collision_node::report {
namespace {

using geometry::Vec3;

constexpr int kSwept = 8;     ///< chords of the centres' paths whose swept balls are tested
constexpr int kWatched = 64;  ///< parts of the piece in which the balls are watched

double segmentDistance(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e) {
  // The four ends against the other segment, and the common perpendicular where it falls inside both.
  const auto along = [](const Vec3& from, const Vec3& way, const Vec3& to) {
    const double length2 = way.squaredNorm();
    return length2 > 0.0 ? std::clamp((to - from).dot(way) / length2, 0.0, 1.0) : 0.0;
  };
  double best =
      std::min({(p - (q + along(q, e, p) * e)).norm(), (p + d - (q + along(q, e, p + d) * e)).norm(),
                (q - (p + along(p, d, q) * d)).norm(), (q + e - (p + along(p, d, q + e) * d)).norm()});
  const double a = d.squaredNorm(), b = d.dot(e), c = e.squaredNorm(), det = a * c - b * b;
  if (det > 0.0) {
    const Vec3 r = q - p;
    const double s = (r.dot(d) * c - r.dot(e) * b) / det;
    const double u = (r.dot(d) * b - r.dot(e) * a) / det;
    if (s >= 0.0 && s <= 1.0 && u >= 0.0 && u <= 1.0) best = std::min(best, (p + s * d - q - u * e).norm());
  }
  return best;
}

class SweptVolumes : public Contestant {
 public:
  SweptVolumes(const QuerySet& set, int samples) : set_(set), test_(set), samples_(samples) {}

  std::string name() const override { return "4D intersection"; }

  Answer answer(const Query& query) override {
    const geometry::Body &a = *set_.bodies[query.a], &b = *set_.bodies[query.b];
    const double duration = durationOf(query.piece), reach = a.radius() + b.radius();
    const auto centreA = [&](double share) { return placeA(query.piece, share * duration) * a.centre(); };
    const auto centreB = [&](double share) { return placeB(query.piece, share * duration) * b.centre(); };
    if (!meet(sweep(centreA), sweep(centreB), reach)) return clear();
    const auto [from, to] = whenBallsMeet(centreA, centreB, reach);
    if (from > to) return clear();
    for (int i = 0; i <= samples_; ++i) {
      const double t = duration * (from + (to - from) * i / samples_);
      if (test_.touching(query, t)) return hitAt(t);
    }
    return clear();
  }

 private:
  /// A chord of a centre's path, and how far the path strays from it.
  struct Chord {
    Vec3 from, way;
    double bulge;
  };
  using Sweep = std::array<Chord, kSwept>;

  template <typename Centre>
  static Sweep sweep(const Centre& centre) {
    Sweep chords;
    Vec3 from = centre(0.0);
    for (int i = 0; i < kSwept; ++i) {
      const Vec3 to = centre((i + 1.0) / kSwept), middle = centre((i + 0.5) / kSwept);
      chords[i] = {from, to - from, 1.2 * (middle - 0.5 * (from + to)).norm()};
      from = to;
    }
    return chords;
  }
  static bool meet(const Sweep& a, const Sweep& b, double reach) {
    for (const Chord& p : a) {
      for (const Chord& q : b) {
        if (segmentDistance(p.from, p.way, q.from, q.way) <= reach + p.bulge + q.bulge) return true;
      }
    }
    return false;
  }
  /// The share of the piece in which the bounding balls meet, to one of its parts; empty: from > to.
  template <typename CentreA, typename CentreB>
  static std::pair<double, double> whenBallsMeet(const CentreA& a, const CentreB& b, double reach) {
    std::pair<double, double> when = {2.0, -1.0};
    Vec3 start = b(0.0) - a(0.0);
    for (int i = 0; i < kWatched; ++i) {
      const double to = (i + 1.0) / kWatched;
      const Vec3 end = b(to) - a(to);
      if (segmentDistance(start, end - start, Vec3::Zero(), Vec3::Zero()) <= 1.05 * reach) {
        when.first = std::min(when.first, static_cast<double>(i) / kWatched);
        when.second = to;
      }
      start = end;
    }
    return when;
  }

  const QuerySet& set_;
  StaticTest test_;
  int samples_;
};

}  // namespace

ContestantPtr makeSweptVolumes(const QuerySet& set, int samples) {
  return std::make_unique<SweptVolumes>(set, samples);
}

}  // namespace collision_node::report
