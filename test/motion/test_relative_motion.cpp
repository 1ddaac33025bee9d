/// The promises of relative_motion.h, against the same model in extended precision.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "collision_node/motion/relative_motion.h"
#include "test/oracle/path.h"

namespace collision_node::motion {
namespace {

using oracle::Real;
using oracle::V3;

constexpr unsigned kSeed = 20240808;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double in(double lo, double hi) { return lo + (hi - lo) * unit(); }
  double decade(double lo, double hi) { return std::pow(10.0, in(lo, hi)); }
  bool chance(double p) { return unit() < p; }
  Vec3 vec(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  Quat quat() { return Quat(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)).normalized(); }

 private:
  std::mt19937_64 engine_;
};

struct Sample {
  RigidMotion a, b;
  Nanoseconds start_ns, end_ns;
};

/// World offsets up to 1e8 m, 0 to 3333 rad in the piece, straight and cubic paths, segments that begin and
/// end with the piece or far outside of it, now and then a fixed object.
Sample randomSample(Random& random) {
  Sample sample;
  const auto span = static_cast<Nanoseconds>(random.decade(3, 9.5));
  sample.start_ns = 1'700'000'000'000'000'000 + static_cast<Nanoseconds>(random.in(0, 1e15));
  sample.end_ns = sample.start_ns + span;
  const double duration = 1e-9 * static_cast<double>(span);
  const Vec3 world = random.vec(random.chance(0.3) ? 0.0 : random.decade(0, 8));
  const Vec3 common = random.vec(random.chance(0.5) ? 0.0 : random.decade(0, 4.5));
  for (RigidMotion* m : {&sample.a, &sample.b}) {
    m->c[0] = world + random.vec(random.decade(-3, 5));
    m->q0 = random.quat();
    if (random.chance(0.1)) {
      m->fixed = true;
      continue;
    }
    const double before = random.chance(0.4) ? 0.0 : random.decade(-3, 1.5);
    const double after = random.chance(0.4) ? 0.0 : random.decade(-3, 1.5);
    m->start_ns = sample.start_ns - static_cast<Nanoseconds>(before * static_cast<double>(span));
    m->end_ns = sample.end_ns + static_cast<Nanoseconds>(after * static_cast<double>(span));
    m->c[1] = common + random.vec(random.decade(-3, 4));
    if (random.chance(0.5)) {
      m->c[2] = random.vec(random.decade(-3, 3) / duration);
      m->c[3] = random.vec(random.decade(-3, 3) / (duration * duration));
    }
    const double turns = random.chance(0.2)   ? 0.0
                         : random.chance(0.5) ? random.decade(-9, 0)
                                              : random.in(0, 3333);
    m->omega = turns / duration * random.vec(1.0).normalized();
  }
  return sample;
}

/// B's origin relative to A's at t, from the same doubles and integers.
V3 exactDisplacement(const Sample& s, double t) {
  const V3 origin = oracle::exact(s.a.c[0]);
  const oracle::Path a(s.a, s.start_ns, origin), b(s.b, s.start_ns, origin);
  return b.at(t).position - a.at(t).position;
}

TEST(RelativeMotion, DisplacementAndRotationStayWithinTheirErrors) {
  // "|computed d - exact d| <= translationError(), |computed R y - exact R y| <= rotationError*() |y|, for
  // every t in [0, duration]."
  Random random(kSeed);
  Real worst_d = 0, worst_r = 0;
  for (int i = 0; i < 20000; ++i) {
    const Sample s = randomSample(random);
    const RelativeMotion m(s.a, s.b, s.start_ns, s.end_ns);
    const V3 origin = oracle::exact(s.a.c[0]);
    const oracle::Path a(s.a, s.start_ns, origin), b(s.b, s.start_ns, origin);
    for (const double t : {0.0, random.unit() * m.duration(), random.unit() * m.duration(), m.duration()}) {
      const oracle::Frame fa = a.at(t), fb = b.at(t);
      const Real off = oracle::norm(oracle::exact(m.displacement(t)) - (fb.position - fa.position));
      if (off > 0) worst_d = std::max(worst_d, off / m.translationError());
      const Vec3 y = random.vec(1.0);
      const Real length = oracle::norm(oracle::exact(y));
      // The product is taken exactly, so that only the matrix is judged.
      const auto turned = [&](const Mat3& r) {
        return y.x() * oracle::exact(r.col(0)) + y.y() * oracle::exact(r.col(1)) +
               y.z() * oracle::exact(r.col(2));
      };
      const Real off_a = oracle::norm(turned(m.rotationA(t)) - fa.rotation * oracle::exact(y));
      const Real off_b = oracle::norm(turned(m.rotationB(t)) - fb.rotation * oracle::exact(y));
      worst_r =
          std::max({worst_r, off_a / (length * m.rotationErrorA()), off_b / (length * m.rotationErrorB())});
      ASSERT_LE(static_cast<double>(worst_d), 1.0) << "seed " << kSeed << " sample " << i << " t " << t;
      ASSERT_LE(static_cast<double>(worst_r), 1.0) << "seed " << kSeed << " sample " << i << " t " << t;
    }
  }
  std::printf("worst share of the bound used: translation %.3f, rotation %.3f\n",
              static_cast<double>(worst_d), static_cast<double>(worst_r));
  // A bound that is never nearly used would hide a solver that is needlessly unsure.
  EXPECT_GT(static_cast<double>(worst_d), 1e-3);
  EXPECT_GT(static_cast<double>(worst_r), 1e-3);
}

TEST(RelativeMotion, TheBeginningOfALongCubicStaysWithinItsError) {
  // Its coefficients are rounded by what the whole segment does, however short the piece.
  Random random(kSeed + 7);
  double worst = 0.0;
  for (int i = 0; i < 3000; ++i) {
    StampedPose from, to;
    to.stamp_ns = 1'000'000'000 + static_cast<Nanoseconds>(random.in(0, 1e8));
    from.has_twist = to.has_twist = true;
    const double h = secondsBetween(0, to.stamp_ns);
    to.pose.position = random.vec(1e3);
    to.linear = 3.0 / h * to.pose.position;
    const RigidMotion path = hermite(from, to);
    const RelativeMotion m(fixedAt(Pose()), path, 0, to.stamp_ns / (i % 2 == 0 ? 100 : 10000));
    const double t = m.duration();
    const Real exact_h = 1e-9L * static_cast<Real>(to.stamp_ns);
    Real square = 0;
    for (int k = 0; k < 3; ++k) {
      const Real mean = static_cast<Real>(to.pose.position[k]) / exact_h, last = to.linear[k];
      const Real c2 = (3 * mean - last) / exact_h, c3 = (last - 2 * mean) / (exact_h * exact_h);
      const Real off = (c2 + c3 * t) * t * t - static_cast<Real>(m.displacement(t)[k]);
      square += off * off;
    }
    worst = std::max(worst, static_cast<double>(std::sqrt(square)) / m.translationError());
  }
  EXPECT_LE(worst, 1.0);
  EXPECT_GE(worst, 0.01) << "the bound tells nothing";
}

TEST(RelativeMotion, AShortCubicBesideALongSegmentKeepsItsDigits) {
  // Two poses 100 ns apart whose twists do not quite fit bend by 1e14 m/s^3, but for 100 ns.
  Random random(kSeed + 8);
  for (int i = 0; i < 1000; ++i) {
    StampedPose from, to;
    from.stamp_ns = static_cast<Nanoseconds>(random.decade(6, 8));
    to.stamp_ns = from.stamp_ns + static_cast<Nanoseconds>(random.in(100, 3000));
    from.has_twist = to.has_twist = true;
    from.pose.position = random.vec(1.0);
    from.linear = random.vec(10.0);
    to.linear = from.linear + random.vec(0.3);
    to.pose.position = from.pose.position + secondsBetween(from.stamp_ns, to.stamp_ns) * from.linear;
    RigidMotion line;  // the other's segment began long before
    line.end_ns = 200'000'000;
    line.c[0] = random.vec(1.0);
    line.c[1] = random.vec(10.0);
    const RigidMotion cubic = hermite(from, to);
    const bool first = random.chance(0.5);
    const RigidMotion &a = first ? cubic : line, &b = first ? line : cubic;
    const RelativeMotion m(a, b, from.stamp_ns, to.stamp_ns);
    // From the poses and twists themselves: what rounding made of the coefficients counts, too.
    const Real h = 1e-9L * static_cast<Real>(to.stamp_ns - from.stamp_ns);
    const V3 p = oracle::exact(from.pose.position), f = oracle::exact(from.linear),
             l = oracle::exact(to.linear);
    const V3 mean = (1 / h) * (oracle::exact(to.pose.position) - p);
    const V3 c2 = (1 / h) * (3 * mean - 2 * f - l), c3 = (1 / (h * h)) * (f + l - 2 * mean);
    for (int k = 0; k <= 8; ++k) {
      const Real t = m.duration() * k / 8, since = 1e-9L * static_cast<Real>(from.stamp_ns) + t;
      const V3 on_cubic = p + t * (f + t * (c2 + t * c3));
      const V3 on_line = oracle::exact(line.c[0]) + since * oracle::exact(line.c[1]);
      const V3 exact = first ? on_line - on_cubic : on_cubic - on_line;
      const double at = static_cast<double>(t);
      ASSERT_LE(oracle::norm(exact - oracle::exact(m.displacement(at))), m.translationError())
          << "case " << i;
    }
    ASSERT_LE(m.translationError(), 1e-12) << "case " << i;
  }
}

TEST(RelativeMotion, SpeedAccelerationAndDistanceAreBounds) {
  // "sup |d'| and sup |d''| over the piece", "sup |d|".
  Random random(kSeed + 1);
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed + 1) + " sample " + std::to_string(i));
    const Sample s = randomSample(random);
    const RelativeMotion m(s.a, s.b, s.start_ns, s.end_ns);
    const V3 origin = oracle::exact(s.a.c[0]);
    const oracle::Path a(s.a, s.start_ns, origin), b(s.b, s.start_ns, origin);
    for (int k = 0; k <= 16; ++k) {
      const double t = m.duration() * k / 16;
      const oracle::Frame fa = a.at(t), fb = b.at(t);
      const auto bend = [&](const oracle::Path& p) {
        return 2 * p.coefficient(2) + 6 * Real(t) * p.coefficient(3);
      };
      // The bound is a computed one: what cancels between the two may leave its own rounding behind.
      const Real speeds = oracle::norm(fa.velocity) + oracle::norm(fb.velocity);
      const Real bends = oracle::norm(bend(a)) + oracle::norm(bend(b));
      EXPECT_LE(oracle::norm(fb.velocity - fa.velocity), m.maxSpeed() + 1e-13L * speeds);
      EXPECT_LE(oracle::norm(bend(b) - bend(a)), m.maxAcceleration() + 1e-13L * bends);
      EXPECT_LE(oracle::norm(fb.position - fa.position), m.maxDistance() + m.translationError());
    }
    EXPECT_GE(m.spinA(), static_cast<double>(oracle::norm(oracle::exact(m.omegaA()))));
    EXPECT_GE(m.spinB(), static_cast<double>(oracle::norm(oracle::exact(m.omegaB()))));
  }
}

TEST(RelativeMotion, ACommonVelocityCancelsBitForBit) {
  // "A common offset or a common velocity cancels before it can round": 30 km/s and 1.6e7 m, equal stamps.
  Random random(kSeed + 2);
  for (int i = 0; i < 500; ++i) {
    Sample s = randomSample(random);
    const auto snapped = [](Vec3 v, double grid) { return Vec3((v / grid).array().round() * grid); };
    for (RigidMotion* m : {&s.a, &s.b}) {
      m->fixed = false;
      m->start_ns = s.start_ns;
      m->end_ns = s.end_ns;
      m->c[0] = snapped(random.vec(1000.0), 0x1p-20);
      m->c[1] = snapped(random.vec(1000.0), 0x1p-20);
    }
    Sample moved = s;
    for (RigidMotion* m : {&moved.a, &moved.b}) {
      m->c[0] += Vec3(0x1p24, -0x1p23, 0x1p24);
      m->c[1] += Vec3(30000.0, -20000.0, 10000.0);
    }
    const RelativeMotion plain(s.a, s.b, s.start_ns, s.end_ns), fast(moved.a, moved.b, s.start_ns, s.end_ns);
    for (const double share : {0.0, 0.3, 1.0}) {
      const double t = share * plain.duration();
      EXPECT_EQ(plain.displacement(t), fast.displacement(t)) << "seed " << kSeed + 2 << " sample " << i;
      EXPECT_EQ(plain.velocity(t), fast.velocity(t)) << "seed " << kSeed + 2 << " sample " << i;
    }
  }
}

TEST(RelativeMotion, ACommonVelocityCostsLittleWhenStampsDiffer) {
  // 30 km/s together, 1 m/s apart, phases 10 ms apart: micrometres would already spoil the 1 m/s problem.
  Sample s;
  s.start_ns = 1'700'000'000'020'000'000;
  s.end_ns = s.start_ns + 10'000'000;
  s.a.start_ns = s.start_ns - 13'333'333;
  s.a.end_ns = s.start_ns + 20'000'000;
  s.b.start_ns = s.start_ns - 3'333'333;
  s.b.end_ns = s.start_ns + 30'000'000;
  const Vec3 common(30000, 1, 2);
  s.a.c[0] = {7e6, 0, 0};
  s.b.c[0] = {7e6 + 300.0, 0.5, 0};
  s.a.c[1] = common;
  s.b.c[1] = common + Vec3(-1, 0, 0);
  const RelativeMotion m(s.a, s.b, s.start_ns, s.end_ns);
  EXPECT_LT(m.translationError(), 1e-10);
  for (const double t : {0.0, 0.004, 0.01}) {
    EXPECT_LE(static_cast<double>(oracle::norm(oracle::exact(m.displacement(t)) - exactDisplacement(s, t))),
              m.translationError());
  }
}

TEST(RelativeMotion, TwoFixedObjectsRest) {
  Sample s;
  s.start_ns = 5;
  s.end_ns = 1'000'000'005;
  s.a.fixed = s.b.fixed = true;
  s.a.c[0] = {1, 2, 3};
  s.b.c[0] = {4, 6, 3};
  const RelativeMotion m(s.a, s.b, s.start_ns, s.end_ns);
  EXPECT_EQ(m.displacement(0.7), Vec3(3, 4, 0));
  EXPECT_EQ(m.maxSpeed(), 0.0);
  EXPECT_EQ(m.rotationA(0.5), Mat3::Identity());
}

}  // namespace
}  // namespace collision_node::motion
