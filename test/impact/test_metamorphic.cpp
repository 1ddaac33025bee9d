/// What must not change the answer, for every pair of shapes under every kind of motion: which body is a, the
/// direction of time, where time is cut, the unit of length, a motion that both share, and the budget.
#include <gtest/gtest.h>

#include <cstring>

#include "test/impact/any_scene.h"
#include "test/impact/claims.h"

namespace moving {
namespace {

/// The transformed scene's answer, its times brought back, against the first one.
void expectNoContradiction(const Scene& s, const std::vector<PairEvent>& events,
                           const std::vector<PairEvent>& other, double slack) {
  const std::string wrong =
      contradiction(events, other, s.duration(), slack * s.duration(), 4 * s.options.time_precision);
  ASSERT_TRUE(wrong.empty()) << wrong << "first:\n" << listOf(events) << "second:\n" << listOf(other);
}

TEST(Metamorphic, SwappedBodies) {
  forAll(1, [](const Scene& s, const std::vector<PairEvent>& events) {
    Scene swapped = s;
    std::swap(swapped.a, swapped.b);
    std::swap(swapped.piece.a, swapped.piece.b);
    expectNoContradiction(s, events, answer(swapped), 0.0);
  });
}

TEST(Metamorphic, TimeReversed) {
  forAll(1, [](const Scene& s, const std::vector<PairEvent>& events) {
    Scene back = s;
    for (RigidMotion* m : {&back.piece.a, &back.piece.b}) {
      if (m->fixed) continue;
      const RigidMotion f = *m;
      const double h = collision_node::motion::secondsBetween(f.start_ns, f.end_ns);
      const Nanoseconds both = s.piece.start_ns + s.piece.end_ns;
      m->start_ns = both - f.end_ns, m->end_ns = both - f.start_ns;
      m->c[0] = f.at(h).position;
      m->c[1] = -f.velocity(h);
      m->c[2] = f.c[2] + 3.0 * h * f.c[3];
      m->c[3] = -f.c[3];
      m->q0 = f.at(h).orientation;
      m->omega = -f.omega;
    }
    // Read backwards: entries are exits. What is open at an end has no counterpart there.
    std::vector<Claim> mirrored;
    const std::vector<PairEvent> forward = answer(back);
    for (const Claim& c : claimsOf(forward, s.duration()))
      mirrored.push_back({c.said, s.duration() - c.to, s.duration() - c.from});
    const double slack = 1e-9 * s.duration();
    for (const Claim& x : claimsOf(events, s.duration())) {
      for (const Claim& y : mirrored) {
        const bool opposite = (x.said == Said::kApart && y.said == Said::kTouching) ||
                              (x.said == Said::kTouching && y.said == Said::kApart);
        if (!opposite) continue;
        ASSERT_LE(std::min(x.to, y.to) - std::max(x.from, y.from), 2 * slack + 4 * s.options.time_precision)
            << "on [" << x.from << ", " << x.to << "] and [" << y.from << ", " << y.to << "]\n"
            << listOf(events) << "reversed:\n"
            << listOf(forward);
      }
    }
  });
}

TEST(Metamorphic, TimeCut) {
  forAll(1, [](const Scene& s, const std::vector<PairEvent>& events) {
    Watched pair(s.a, s.b, s.options);
    pair.advanceInParts(s.piece.start_ns, s.piece.end_ns, s.piece.a, s.piece.b, 5);
    pair.finish();
    for (PairEvent& e : pair.events) {
      const double off = collision_node::motion::secondsBetween(s.piece.start_ns, e.interval_start_ns);
      e.toi_lower += off, e.toi_upper += off;
    }
    expectNoContradiction(s, events, pair.events, 1e-15);
  });
}

/// A velocity, an acceleration and a place in the world that both share, and other world axes.
TEST(Metamorphic, CommonMotion) {
  forAll(1, [](const Scene& s, const std::vector<PairEvent>& events) {
    Scene moved = s;
    const double h = s.duration();
    const Vec3 v = Vec3(3, -2, 1) / h, acceleration = Vec3(-1, 2, 0.5) / (h * h);
    const Quat turn(Eigen::AngleAxisd(1.1, Vec3(1, 2, -2).normalized()));
    for (RigidMotion* m : {&moved.piece.a, &moved.piece.b}) {
      if (m->fixed) {
        *m = flight(s.piece.start_ns, s.piece.end_ns, m->c[0], Vec3::Zero(), Vec3::Zero(), m->q0);
      }
      // About the piece's start for both, whatever their own stamps.
      const double s0 = collision_node::motion::secondsBetween(m->start_ns, s.piece.start_ns);
      m->c[0] += Vec3(11, 7, -5) - s0 * v + s0 * s0 * acceleration;
      m->c[1] += v - 2 * s0 * acceleration;
      m->c[2] += acceleration;
      for (Vec3& c : m->c) c = turn * c;
      m->omega = turn * m->omega;
      m->q0 = (turn * m->q0).normalized();
    }
    expectNoContradiction(s, events, answer(moved), 1e-9);
  });
}

PlacedShape scaled(const PlacedShape& placed, double k) {
  namespace g = collision_node::geometry;
  PlacedShape out = placed;
  out.origin.position *= k;
  const auto vertices = [&](const g::TriangleMesh& mesh) {
    auto copy = std::make_shared<g::TriangleMesh>(mesh);
    for (Vec3& v : copy->vertices) v *= k;
    return copy;
  };
  if (auto* sphere = std::get_if<g::Sphere>(&out.shape)) sphere->radius *= k;
  if (auto* box = std::get_if<g::Box>(&out.shape)) box->size *= k;
  if (auto* cylinder = std::get_if<g::Cylinder>(&out.shape)) cylinder->radius *= k, cylinder->length *= k;
  if (auto* capsule = std::get_if<g::Capsule>(&out.shape)) capsule->radius *= k, capsule->length *= k;
  if (auto* mesh = std::get_if<g::Mesh>(&out.shape)) mesh->mesh = vertices(*mesh->mesh);
  if (auto* convex = std::get_if<g::Convex>(&out.shape)) convex->mesh = vertices(*convex->mesh);
  return out;
}

bool sameBits(double x, double y) { return std::memcmp(&x, &y, sizeof x) == 0; }

void expectSameBytes(const std::vector<PairEvent>& x, const std::vector<PairEvent>& y) {
  ASSERT_EQ(x.size(), y.size()) << listOf(x) << "second:\n" << listOf(y);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_EQ(x[i].kind, y[i].kind);
    ASSERT_EQ(x[i].certificate, y[i].certificate);
    ASSERT_TRUE(sameBits(x[i].toi_lower, y[i].toi_lower) && sameBits(x[i].toi_upper, y[i].toi_upper) &&
                sameBits(x[i].normal_error, y[i].normal_error))
        << listOf(x) << "second:\n"
        << listOf(y);
  }
}

/// A power of two changes no digit: no length is hidden in the code.
TEST(Metamorphic, AnotherUnitOfLengthKeepsEveryBit) {
  forAll(1, [](const Scene& s, const std::vector<PairEvent>& events) {
    for (const double k : {0x1p-20, 0x1p20, 0x1p40}) {
      Scene other = s;
      for (Shapes* shapes : {&other.a, &other.b})
        for (PlacedShape& shape : *shapes) shape = scaled(shape, k);
      for (RigidMotion* m : {&other.piece.a, &other.piece.b})
        for (Vec3& x : m->c) x *= k;
      other.options.contact_distance *= k;
      other.options.distance_precision *= k;
      SCOPED_TRACE("scale " + std::to_string(k));
      expectSameBytes(events, answer(other));
      if (testing::Test::HasFatalFailure()) return;
    }
  });
}

/// Raising the budget only shrinks what is open; what was decided stays decided.
TEST(Metamorphic, ASmallerBudgetSaysLessAndNothingElse) {
  int spent = 0;
  forAll(1, [&](const Scene& s, const std::vector<PairEvent>& events) {
    double open_before = -1.0;
    for (std::uint64_t budget = 1; budget <= 30000; budget *= 5) {
      Scene hasty = s;
      hasty.options.node_budget = budget;
      std::vector<PairEvent> said = answer(hasty);
      const bool met = !said.empty() && said.back().reason == Reason::kBudget;
      const double open = met ? said.back().toi_lower : s.duration();
      spent += met;
      ASSERT_GE(open, open_before * (1 - 1e-12)) << "budget " << budget << '\n' << listOf(said);
      open_before = open;
      if (met) {
        ASSERT_GE(said.back().toi_upper, s.duration() * (1 - 1e-15)) << listOf(said);
      }
      expectNoContradiction(s, events, said, 0.0);
      if (!events.empty()) {
        ASSERT_FALSE(said.empty()) << "MISS with budget " << budget << '\n' << listOf(events);
      }
      if (testing::Test::HasFatalFailure()) return;
    }
  });
  EXPECT_GE(spent, 300);
}

}  // namespace
}  // namespace moving
