#include <algorithm>
#include <cmath>

#include "collision_node/report/methods/own_methods.h"
#include "collision_node/report/methods/peer_models.h"
#include "collision_node/report/methods/static_test.h"

namespace collision_node::report {
namespace {

using geometry::Vec3;

constexpr int kChords = 64;  // of the centres' paths: cheap beside a single static test

double segmentDistance(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e) {
  // Along each segment in turn; three rounds settle what two segments need (convex in both parameters).
  double s = 0.0, u = 0.0;
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
    s = (r.dot(d) * c - r.dot(e) * b) / det;
    u = (r.dot(d) * b - r.dot(e) * a) / det;
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
    Vec3 centre_a[kChords + 1], centre_b[kChords + 1];
    for (int i = 0; i <= kChords; ++i) {
      const double t = duration * i / kChords;
      centre_a[i] = placeA(query.piece, t) * a.centre();
      centre_b[i] = placeB(query.piece, t) * b.centre();
    }
    if (!sweptVolumesMeet(centre_a, centre_b, reach)) return clear();
    const auto [from, to] = spheresMeet(centre_a, centre_b, reach);
    if (from > to) return clear();
    test_.begin(query);
    for (int i = 0; i <= samples_; ++i) {
      const double t = duration * (from + (to - from) * i / samples_);
      if (test_.touching(t)) return hitAt(t);
    }
    return clear();
  }

 private:
  /// Chains of capsules, each as long as a chord of the path.
  static bool sweptVolumesMeet(const Vec3* a, const Vec3* b, double reach) {
    for (int i = 0; i < kChords; i += 8) {
      for (int j = 0; j < kChords; j += 8) {
        const double bulge = bulgeOf(a + i) + bulgeOf(b + j);
        if (segmentDistance(a[i], a[i + 8] - a[i], b[j], b[j + 8] - b[j]) <= reach + bulge) return true;
      }
    }
    return false;
  }
  /// How far the path strays from its chord of eight parts, by the points between.
  static double bulgeOf(const Vec3* path) {
    double most = 0.0;
    for (int k = 1; k < 8; ++k)
      most = std::max(most, (path[k] - path[0] - k / 8.0 * (path[8] - path[0])).norm());
    return 1.1 * most;
  }
  /// The share of the piece in which the bounding spheres meet, to a chord; empty: from > to.
  static std::pair<double, double> spheresMeet(const Vec3* a, const Vec3* b, double reach) {
    int first = kChords + 1, last = -1;
    for (int i = 0; i < kChords; ++i) {
      const Vec3 start = b[i] - a[i], way = b[i + 1] - a[i + 1] - start;
      if (segmentDistance(start, way, Vec3::Zero(), Vec3::Zero()) > 1.05 * reach) continue;
      first = std::min(first, i), last = i + 1;
    }
    return {static_cast<double>(first) / kChords, static_cast<double>(last) / kChords};
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
