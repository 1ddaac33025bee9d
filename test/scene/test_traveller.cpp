// Radius and odometer of one object against what the solver itself may find in contact, and how far its
// origin really goes.
#include <gtest/gtest.h>

#include "collision_node/impact/pair_piece.h"
#include "collision_node/scene/traveller.h"
#include "test/scene/random_scene.h"

namespace collision_node::scene {
namespace {

bool holds(const Bounds& outer, const Bounds& inner) {
  return (outer.lower.array() <= inner.lower.array()).all() &&
         (inner.upper.array() <= outer.upper.array()).all();
}

constexpr double kHalf = 0.125;  // half the contact distance [m]
constexpr double kMaxGap = 1.0;  // [s]

Sample sampleAt(const motion::StampedPose& pose) {
  Sample sample;
  sample.pose = pose;
  return sample;
}

Sample sampleTo(const Segment& segment, const motion::StampedPose& pose) {
  Sample sample = sampleAt(pose);
  sample.join = Join::kJoined;
  sample.segment = segment;
  return sample;
}

/// Any motion, up to what breaks budgets: far from the origin, fast, with twists that make cubics swing wide,
/// and spins of many whole turns about an axis that the poses hardly tell.
struct AnySegment {
  motion::StampedPose from, to;
  Segment segment;
};

AnySegment anySegment(Dice& dice) {
  motion::StampedPose from, to;
  const Vec3 origin = dice.vector(dice.anySize(1e-3, 1e9));
  const double h = dice.anySize(1e-4, kMaxGap), size = dice.anySize(1e-3, 1e3);
  from.stamp_ns = dice.ms(0.0, 1e6);
  to.stamp_ns = from.stamp_ns + static_cast<Nanoseconds>(1e9 * h);
  from.pose = {origin, dice.turn()};
  to.pose.position = origin + dice.vector(size);
  const Vec3 axis = dice.turn().vec().normalized();
  to.pose.orientation =
      geometry::Quat(Eigen::AngleAxisd(dice.anySize(1e-15, 3.0), axis)) * from.pose.orientation;
  from.has_twist = to.has_twist = true;
  from.linear = dice.vector(dice.anySize(1e-3, 1e5));
  to.linear = dice.vector(dice.anySize(1e-3, 1e5));
  from.angular = to.angular = axis * dice.anySize(1e-3, 1e5);
  const MotionModel models[] = {MotionModel::kSlerp, MotionModel::kHermite, MotionModel::kSpin};
  motion::MotionBounds bounds;
  if (dice.chance(0.3)) bounds.acceleration = dice.anySize(0.01, 100.0);
  return {from, to, makeSegment(models[dice.below(3)], from, to, bounds)};
}

TEST(Traveller, TheRadiiHoldWhateverTheSolverMayFindInContact) {
  Dice dice(11);
  double most = 0.0;
  for (int round = 0; round < 50000; ++round) {
    const Object object[2] = {movingSphere("a"), movingSphere("b")};
    const AnySegment a = anySegment(dice), b = anySegment(dice);
    impact::Piece piece{std::max(a.from.stamp_ns, b.from.stamp_ns), 0, a.segment.motion, b.segment.motion};
    if (round % 4 != 0) {  // one beside the other
      const Nanoseconds shift = a.from.stamp_ns - b.from.stamp_ns;
      piece.b.start_ns += shift;
      piece.b.end_ns += shift;
      piece.b.c[0] = piece.a.c[0] + dice.vector(dice.anySize(1e-3, 1e3));
      piece.start_ns = a.from.stamp_ns;
    }
    piece.end_ns = std::min(piece.a.end_ns, piece.b.end_ns);
    if (piece.end_ns <= piece.start_ns) continue;
    double radii = 0.0, reaches = 0.0;
    for (int side = 0; side < 2; ++side) {
      Segment segment = side == 0 ? a.segment : b.segment;
      segment.motion = side == 0 ? piece.a : piece.b;
      motion::StampedPose begin, end;
      Vec3 hull[4];
      motion::pathHull(segment.motion, hull);
      begin.pose.position = hull[0];
      end.pose.position = hull[3];
      Traveller traveller(object[side], kHalf, kMaxGap);
      traveller.take(sampleAt(begin));
      traveller.take(sampleTo(segment, end));
      radii += traveller.radius();
      reaches += object[side].links[0].body->reach();
      const bool has_tube = segment.error.asked && segment.doubt == impact::Reason::kNone;
      if (has_tube && std::isfinite(segment.error.position)) piece.tube += segment.error.position;
    }
    const impact::PairPiece pair(*object[0].links[0].body, *object[1].links[0].body, piece, 2.0 * kHalf);
    const double spare = radii - reaches - 2.0 * kHalf;
    ASSERT_GE(spare, pair.point_error) << "round " << round;
    most = std::max(most, (pair.point_error - piece.tube) / (spare - piece.tube));
  }
  EXPECT_LT(most, 0.5) << "room for the roundings of distance and way";
  std::printf("the solver's budget is at most %.3f of ours\n", most);
}

TEST(Traveller, TheRadiusNeverShrinksAndItsGrowthIsWay) {
  const Object object = movingSphere("ball");
  Traveller ball(object, kHalf, kMaxGap);
  EXPECT_GE(ball.radius(), 0.5 + kHalf);
  Segment segment;
  segment.motion = motion::straightSlerp(poseAt(0, 0.0), poseAt(100, 0.0));
  ball.take(sampleTo(segment, poseAt(100, 0.0)));
  const double radius = ball.radius(), spent = ball.spent();
  segment.error.asked = true;
  segment.error.position = 3.0;
  ball.take(sampleTo(segment, poseAt(200, 0.0)));
  EXPECT_GE(ball.radius(), radius + 3.0);
  EXPECT_GE(ball.spent() - spent, 3.0);
  segment.error = {};
  const double widest = ball.radius();
  ball.take(sampleTo(segment, poseAt(300, 0.0)));
  EXPECT_EQ(ball.radius(), widest);
}

TEST(Traveller, AnObjectThatStandsIsTheBoxOfAllItsPoints) {
  Dice dice(5);
  for (int round = 0; round < 200; ++round) {
    RandomScene random(static_cast<unsigned>(round), 2);
    Object& object = random.scene->objects[0];
    object.source = {};
    object.source.fixed = {dice.vector(10.0), dice.turn()};
    const Traveller stands(object, kHalf, kMaxGap);
    const Bounds box = stands.standingBox();
    for (const Link& link : object.links) {
      for (std::int32_t id = 0; id < link.body->elementCount(); ++id) {
        Vec3 buffer[3];
        const geometry::Element element = link.body->element(id, buffer);
        for (int i = 0; i < element.count; ++i) {
          const Vec3 at = object.source.fixed * element.vertices[i];
          const Vec3 half = Vec3::Constant(element.radius + kHalf);
          ASSERT_TRUE(holds(box, {at - half, at + half})) << round;
        }
      }
    }
  }
}

}  // namespace
}  // namespace collision_node::scene
