/// Bounds of chained motions, held against dense sampling with rotation matrices of the test's own.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "collision_node/motion/composed_motion.h"

namespace collision_node::motion {
namespace {

constexpr double kSeconds = 0.1;

/// Rodrigues' formula.
Mat3 turnBy(const Vec3& v) {
  const double angle = v.norm();
  if (angle == 0.0) return Mat3::Identity();
  const Vec3 a = v / angle;
  Mat3 k;
  k << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return Mat3::Identity() + std::sin(angle) * k + (1.0 - std::cos(angle)) * k * k;
}

double angleOf(const Mat3& turn) {
  const Vec3 twice(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  return std::atan2(0.5 * twice.norm(), 0.5 * (turn.trace() - 1.0));
}

Vec3 rotationVector(const Mat3& turn) {
  const Vec3 twice(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  return twice.norm() == 0.0 ? Vec3::Zero() : Vec3(twice.normalized() * angleOf(turn));
}

struct Frame {
  Mat3 turn = Mat3::Identity();
  Vec3 place = Vec3::Zero();
};

/// The same transform as a ChainPart: place + s * velocity, turnBy(s * rate) * start.
struct Mover {
  Frame start;
  Vec3 velocity = Vec3::Zero(), rate = Vec3::Zero();
  bool inverse = false;

  Frame at(double s) const {
    Frame f;
    f.turn = turnBy(s * rate) * start.turn;
    f.place = start.place + s * velocity;
    if (!inverse) return f;
    return {f.turn.transpose(), -(f.turn.transpose() * f.place)};
  }

  ChainPart part() const {
    ChainPart out;
    out.inverse = inverse;
    StampedPose from, to;
    to.stamp_ns = static_cast<Nanoseconds>(kSeconds * 1e9);
    from.pose = {start.place, Quat(start.turn).normalized()};
    to.pose = {start.place + kSeconds * velocity,
               Quat(Mat3(turnBy(kSeconds * rate) * start.turn)).normalized()};
    out.motion = straightSlerp(from, to);
    out.from = from.pose;
    out.to = to.pose;
    return out;
  }
};

Frame compose(const std::vector<Mover>& movers, double s) {
  Frame all;
  for (const Mover& mover : movers) {
    const Frame f = mover.at(s);
    all.place += all.turn * f.place;
    all.turn = all.turn * f.turn;
  }
  return all;
}

Deviation bound(const std::vector<Mover>& movers) {
  std::vector<ChainPart> parts;
  for (const Mover& mover : movers) parts.push_back(mover.part());
  return slerpDeviation(parts, kSeconds);
}

/// The largest difference seen at `steps` instants.
Deviation sampled(const std::vector<Mover>& movers, int steps = 200) {
  const Frame from = compose(movers, 0.0), to = compose(movers, kSeconds);
  const Vec3 step = rotationVector(to.turn * from.turn.transpose());
  Deviation worst;
  for (int i = 0; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps;
    const Frame f = compose(movers, kSeconds * part);
    const Vec3 line = from.place + part * (to.place - from.place);
    worst.position = std::max(worst.position, (f.place - line).norm());
    worst.angle = std::max(worst.angle, angleOf(f.turn * (turnBy(part * step) * from.turn).transpose()));
  }
  return worst;
}

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3 vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  Mover mover(double reach, double speed, double turn) {
    Mover m;
    m.start = {turnBy(vector(3.0)), vector(reach)};
    m.velocity = vector(speed);
    const Vec3 axis = vector(1.0).normalized();
    m.rate = axis * (in(0.0, turn) / kSeconds);
    m.inverse = in(0.0, 1.0) < 0.3;
    if (in(0.0, 1.0) < 0.3) m.rate = m.velocity = Vec3::Zero();
    return m;
  }

 private:
  std::mt19937 engine_;
};

constexpr double kRounding = 1e-9;  // of the matrices above; far below every deviation that matters here

TEST(ComposedMotion, theBoundHoldsAtEverySampledInstant) {
  for (unsigned seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice dice(seed);
    std::vector<Mover> movers;
    const int count = 1 + static_cast<int>(dice.in(0.0, 5.0));
    const double turn = seed % 2 == 0 ? 0.3 : 3.0;
    for (int i = 0; i < count; ++i) movers.push_back(dice.mover(5.0, 20.0, turn));
    const Deviation got = bound(movers), seen = sampled(movers);
    EXPECT_LE(seen.position, got.position + kRounding);
    EXPECT_LE(seen.angle, got.angle + 1e-7);  // atan2 of matrices near the identity
  }
}

TEST(ComposedMotion, theBoundIsOfTheSizeOfTheDeviation) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice dice(seed);
    std::vector<Mover> movers;
    for (int i = 0; i < 3; ++i) {
      Mover m = dice.mover(2.0, 5.0, 0.0);
      m.rate = dice.vector(1.0).normalized() * (dice.in(0.05, 0.1) / kSeconds);
      movers.push_back(m);
    }
    const Deviation got = bound(movers), seen = sampled(movers);
    EXPECT_LT(got.position, 30.0 * seen.position + 1e-4);
    EXPECT_LT(got.angle, 20.0 * seen.angle + 3e-3);
  }
}

TEST(ComposedMotion, oneMovingPartIsItsOwnPath) {
  Mover m;
  m.velocity = Vec3(100, 0, 0);
  m.rate = Vec3(0, 0, 20);
  EXPECT_EQ(bound({m}).position, 0.0);
  EXPECT_EQ(bound({m}).angle, 0.0);
}

TEST(ComposedMotion, translationsStayStraight) {
  Mover a, b;
  a.velocity = Vec3(2000, 0, 0);
  b.velocity = Vec3(0, 3, 0);
  EXPECT_LT(bound({a, b}).position, 1e-10);
  EXPECT_LT(bound({a, b}).angle, 1e-12);
}

TEST(ComposedMotion, aLeverOnAJointBowsByAnEighthOfTheSquaredAngle) {
  Mover joint, lever;
  joint.rate = Vec3(0, 0, 0.2 / kSeconds);
  lever.start.place = Vec3(3, 0, 0);
  const Deviation got = bound({joint, lever});
  EXPECT_GT(got.position, 3.0 * (1.0 - std::cos(0.1)));
  EXPECT_LT(got.position, 3.0 * 0.2 * 0.2 / 8.0 * 1.02);
  EXPECT_LT(got.angle, 1e-12);
}

TEST(ComposedMotion, turnsAboutOneAxisStayOneTurn) {
  Mover map, odom;
  map.rate = Vec3(0, 0, 0.5);
  odom.rate = Vec3(0, 0, -3.0);
  odom.velocity = Vec3(1, 0, 0);
  EXPECT_LT(bound({map, odom}).angle, 1e-12);
}

TEST(ComposedMotion, moreThanHalfATurnInAllIsNotBounded) {
  Mover a, b;
  a.rate = b.rate = Vec3(0, 0, 2.0 / kSeconds);
  EXPECT_GT(bound({a, b}).angle, 3.14159);
  EXPECT_GT(sampled({a, b}).angle, 1.0) << "slerp takes the short way round";
}

}  // namespace
}  // namespace collision_node::motion
