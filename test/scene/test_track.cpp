#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "collision_node/scene/tracks/track.h"

namespace collision_node::scene {
namespace {

constexpr Nanoseconds kMs = 1'000'000;

motion::StampedPose at(Nanoseconds stamp_ms, double x = 0.0) {
  motion::StampedPose pose;
  pose.stamp_ns = stamp_ms * kMs;
  pose.pose.position.x() = x;
  return pose;
}

TrackOptions options() {
  TrackOptions options;
  options.reorder_ns = 100 * kMs;
  options.max_gap_ns = 1000 * kMs;
  options.jump_ns = 1000 * kMs;
  return options;
}

/// The released stamps of the scene's epoch in ms; a break before one shows as -1.
std::vector<Nanoseconds> released(const Track& track) {
  std::vector<Nanoseconds> out;
  for (std::size_t i = track.firstIndex(); track.has(i); ++i) {
    if (i > track.firstIndex() && track.sample(i).join != Join::kJoined) out.push_back(-1);
    out.push_back(track.stamp(i) / kMs);
  }
  return out;
}

using Stamps = std::vector<Nanoseconds>;

Track fed(const Stamps& stamps_ms, const TrackOptions& with = options()) {
  Track track(with);
  for (const Nanoseconds stamp : stamps_ms) track.add(at(stamp), false, {});
  return track;
}

TEST(Track, ReleasesAStampOnceOneAtLeastReorderLaterHasCome) {
  EXPECT_EQ(released(fed({0, 99})), Stamps{});
  EXPECT_EQ(released(fed({0, 100})), Stamps({0}));
  EXPECT_EQ(released(fed({0, 50, 150})), Stamps({0, 50}));
}

TEST(Track, ReleasesAllAtTheEnd) {
  Track track = fed({0, 50, 150});
  track.releaseAll();
  EXPECT_EQ(released(track), Stamps({0, 50, 150}));
  EXPECT_EQ(track.status(), Track::Status::kLive);  // a flush is no goodbye
}

TEST(Track, PutsPosesInOrderWithinTheWindow) {
  Track track = fed({0, 60, 30, 90, 200, 120, 400});
  EXPECT_EQ(released(track), Stamps({0, 30, 60, 90, 120, 200}));
  EXPECT_EQ(track.counts().reordered, 2u);
  EXPECT_EQ(track.counts().accepted, 7u);
}

// README: "one stamp, one pose"
TEST(Track, OfTwoPosesWithOneStampTheFirstWins) {
  Track track(options());
  track.add(at(0, 1.0), false, {});
  track.add(at(0, 2.0), false, {});    // still waiting for release
  track.add(at(100, 3.0), false, {});  // releases 0
  track.add(at(0, 4.0), false, {});    // the last released one
  EXPECT_EQ(track.counts().duplicate, 2u);
  EXPECT_EQ(track.sample(track.firstIndex()).pose.pose.position.x(), 1.0);
}

// README: "no pose comes more than `reorder` after a newer one of its stream"
TEST(Track, OneStragglerIsLateAndBreaksNothing) {
  Track track = fed({0, 100, 200, 300, 50, 400, 500});
  EXPECT_EQ(released(track), Stamps({0, 100, 200, 300, 400}));
  EXPECT_EQ(track.counts().late, 1u);
  EXPECT_EQ(track.epoch(), 0u);
}

TEST(Track, ASmallStepBackThatGoesOnIsANewEpoch) {
  Track track = fed({0, 100, 200, 300, 400, 50});
  EXPECT_EQ(track.epoch(), 0u);  // held: nobody knows yet
  EXPECT_EQ(track.counts().accepted, 5u);
  track.add(at(150), false, {});
  EXPECT_EQ(track.epoch(), 1u);
  EXPECT_EQ(track.status(), Track::Status::kLeft);
  EXPECT_EQ(released(track), Stamps({0, 100, 200, 300, 400}));  // the old epoch ended: all of it is released
  EXPECT_EQ(track.reach(track.firstIndex() + 4).reason, impact::Reason::kReset);
  track.beginEpoch(1);
  EXPECT_EQ(released(track), Stamps({50}));
  EXPECT_EQ(track.counts().late, 0u);
}

TEST(Track, PosesSentAgainAreDuplicatesAndOpenNothing) {
  // Three released stamps in a row come again, and one that is still waiting for its release.
  Track track = fed({0, 500, 600, 700, 800, 900, 1000, 1100, 1200, 800, 900, 1000, 1200, 1300, 1400});
  EXPECT_EQ(track.epoch(), 0u);
  EXPECT_EQ(track.counts().duplicate, 4u);
  EXPECT_EQ(track.counts().late, 0u);
  EXPECT_EQ(released(track), Stamps({0, 500, 600, 700, 800, 900, 1000, 1100, 1200, 1300}));
  // A straggler among them is not taken for the beginning of a round.
  track = fed({0, 100, 200, 300, 400, 500, 150, 200, 300, 600, 700});
  EXPECT_EQ(track.epoch(), 0u);
  EXPECT_EQ(track.counts().duplicate, 2u);
  EXPECT_EQ(track.counts().late, 1u);
}

TEST(Track, StampsOfARoundBeforeAreNoDuplicates) {
  // Back by more than jump: the second and third stamps of the new round are those of poses just released.
  Track track = fed({0, 400, 800, 1200, 1300, 0, 400, 800});
  EXPECT_EQ(track.epoch(), 1u);
  EXPECT_EQ(track.counts().duplicate, 0u);
  track.beginEpoch(1);
  EXPECT_EQ(released(track), Stamps({0, 400}));
  // A stream so slow that the second stamp of the round is the last one released.
  track = fed({0, 5000, 10000, 0, 5000, 10000});
  EXPECT_EQ(track.epoch(), 1u);
}

TEST(Track, ADuplicateIsKnownAsFarBackAsJump) {
  TrackOptions with = options();
  with.jump_ns = 300 * kMs;
  EXPECT_EQ(fed({0, 100, 200, 300, 400, 500, 600, 200}, with).counts().duplicate, 1u);  // released up to 500
  EXPECT_EQ(fed({0, 100, 200, 300, 400, 500, 600, 100}, with).counts().duplicate, 0u);
}

TEST(Track, BackByMoreThanJumpIsANewEpochOnceItGoesOn) {
  EXPECT_EQ(fed({5000, 5100, 5200, 3000}).epoch(), 0u);  // held: nobody knows yet
  Track track = fed({5000, 5100, 5200, 3000, 3100});
  EXPECT_EQ(track.epoch(), 1u);
  track.beginEpoch(1);
  EXPECT_EQ(released(track), Stamps({3000}));
  EXPECT_EQ(track.counts().late, 0u);
}

TEST(Track, OneBadStampOpensNothing) {
  Track track = fed({5000, 5100, 5200, 0, 5300, 5400});
  EXPECT_EQ(track.epoch(), 0u);
  EXPECT_EQ(track.counts().late, 1u);
  EXPECT_EQ(released(track), Stamps({5000, 5100, 5200, 5300}));
  track = fed({5000, 0, 5100, 5200});  // before the first release, too
  EXPECT_EQ(track.epoch(), 0u);
  EXPECT_EQ(released(track), Stamps({5000, 5100}));
}

TEST(Track, ALonePoseOfTheFarFutureDoesNotSwallowTheLoop) {
  Track track = fed({100000, 0, 100});  // nothing was released yet
  EXPECT_EQ(track.epoch(), 1u);
}

TEST(Track, NothingIsSweptThroughAHole) {
  EXPECT_EQ(released(fed({0, 500, 1500, 1700})), Stamps({0, 500, 1500}));
  Track track = fed({0, 500, 1501, 1700});
  EXPECT_EQ(released(track), Stamps({0, 500, -1, 1501}));
  const Reach reach = track.reach(track.firstIndex() + 1);
  EXPECT_EQ(reach.what, Reach::What::kBreak);
  EXPECT_EQ(reach.reason, impact::Reason::kGap);
}

// README: "no object is faster than its `max_speed`, `max_spin`"
TEST(Track, NothingIsSweptThroughATeleport) {
  TrackOptions with = options();
  with.max_speed = 10.0;
  Track track(with);
  track.add(at(0, 0.0), false, {});
  track.add(at(100, 0.99), false, {});
  track.add(at(200, 2.01), false, {});
  track.releaseAll();
  EXPECT_EQ(released(track), Stamps({0, 100, -1, 200}));

  with = options();
  with.bounds.max_spin = 1.0;
  Track turning(with);
  motion::StampedPose turned = at(100);
  turned.pose.orientation = geometry::Quat(Eigen::AngleAxisd(0.11, Vec3::UnitZ()));
  turning.add(at(0), false, {});
  turning.add(turned, false, {});
  turning.releaseAll();
  EXPECT_EQ(released(turning), Stamps({0, -1, 100}));
}

TEST(Track, RejectsPosesThatAreNone) {
  Track track(options());
  motion::StampedPose bad = at(0);
  bad.pose.position.x() = std::nan("");
  track.add(bad, false, {});
  bad = at(0);
  bad.pose.orientation.coeffs().setZero();
  track.add(bad, false, {});
  bad = at(0);
  bad.stamp_ns = std::numeric_limits<Nanoseconds>::max();
  track.add(bad, false, {});
  EXPECT_EQ(track.counts().rejected, 3u);
  EXPECT_EQ(track.status(), Track::Status::kWaiting);
}

TEST(Track, AGuessedStampCastsDoubtOnBothItsSegments) {
  Track track(options());
  track.add(at(0), false, {});
  track.add(at(100), true, {});
  track.add(at(200), false, {});
  track.add(at(300), false, {});
  track.releaseAll();
  const std::size_t i = track.firstIndex();
  EXPECT_EQ(track.reach(i).doubt, impact::Reason::kStampGuessed);
  EXPECT_EQ(track.reach(i + 1).doubt, impact::Reason::kStampGuessed);
  EXPECT_EQ(track.reach(i + 2).doubt, impact::Reason::kNone);
}

// README: "poses tell which way round an object turned: less than half a turn between two, or twists with
// `motion: spin`"
TEST(Track, ATwistOfMoreThanHalfATurnPerSegmentIsAliased) {
  for (const double rate : {31.0, 32.0}) {  // half a turn in 0.1 s is 31.4 rad/s
    Track track(options());
    motion::StampedPose pose = at(0);
    pose.has_twist = true;
    pose.angular = Vec3(0, 0, rate);
    track.add(pose, false, {});
    pose.stamp_ns = 100 * kMs;
    track.add(pose, false, {});
    track.releaseAll();
    const impact::Reason expected = rate > 31.5 ? impact::Reason::kAlias : impact::Reason::kNone;
    EXPECT_EQ(track.reach(track.firstIndex()).doubt, expected) << rate;
  }
}

TEST(Track, ABodyThatMayTurnHalfAroundBetweenTwoPosesIsAliasedUnlessTwistsSayOtherwise) {
  TrackOptions with = options();
  with.bounds.max_spin = 31.0;  // [rad/s]: less than half a turn in 0.1 s, more in 0.2 s
  for (const bool has_twist : {false, true}) {
    Track track(with);
    for (const Nanoseconds stamp : {0, 100, 300}) {
      motion::StampedPose pose = at(stamp);
      pose.has_twist = has_twist;
      track.add(pose, false, {});
    }
    track.releaseAll();
    const std::size_t first = track.firstIndex();
    EXPECT_EQ(track.reach(first).doubt, impact::Reason::kNone);
    EXPECT_EQ(track.reach(first + 1).doubt, has_twist ? impact::Reason::kNone : impact::Reason::kAlias);
  }
}

TEST(Track, OfSeveralDoubtsTheWorstIsSaid) {
  using impact::Reason;
  EXPECT_EQ(worseDoubt(Reason::kNone, Reason::kAlias), Reason::kAlias);
  EXPECT_EQ(worseDoubt(Reason::kTimeout, Reason::kNone), Reason::kTimeout);
  EXPECT_EQ(worseDoubt(Reason::kTimeout, Reason::kStampGuessed), Reason::kStampGuessed);
  EXPECT_EQ(worseDoubt(Reason::kAlias, Reason::kTimeout), Reason::kAlias);
}

TEST(Track, ADroppedTrackBreaksAndComesBackNoEarlierThanTheFloor) {
  Track track = fed({0, 100, 200});
  track.timeOut();
  EXPECT_EQ(track.status(), Track::Status::kTimedOut);
  EXPECT_EQ(track.reach(track.firstIndex() + 2).reason, impact::Reason::kTimeout);
  track.add(at(900), false, 1000 * kMs);
  EXPECT_EQ(track.counts().late, 1u);
  track.add(at(1100), false, 1000 * kMs);
  EXPECT_EQ(track.status(), Track::Status::kLive);
  EXPECT_EQ(track.frontier(), 1000 * kMs);
  track.add(at(1050), false, 5000 * kMs);  // the floor is that of the return, not a later one
  track.add(at(1200), false, {});
  EXPECT_EQ(released(track), Stamps({0, 100, 200, -1, 1050, 1100}));
  EXPECT_EQ(track.sample(track.firstIndex() + 3).join, Join::kTimeout);
}

TEST(Track, AFrozenTrackRestsUntilItsReturn) {
  TrackOptions with = options();
  with.on_timeout = OnTimeout::kFreeze;
  Track track = fed({0, 100, 200}, with);
  track.timeOut();
  Reach reach = track.reach(track.firstIndex() + 2);
  EXPECT_EQ(reach.what, Reach::What::kStill);
  EXPECT_TRUE(reach.guess_of_rest);
  EXPECT_EQ(reach.doubt, impact::Reason::kTimeout);
  track.add(at(2000), false, 1900 * kMs);
  track.add(at(2100), false, {});
  reach = track.reach(track.firstIndex() + 2);
  EXPECT_EQ(reach.what, Reach::What::kStill);
  EXPECT_FALSE(reach.guess_of_rest);
  EXPECT_EQ(reach.until_ns, 2000 * kMs);
}

TEST(Track, ClockWentBackBeginsAnEpochWhateverTheStamps) {
  Track track = fed({0, 100, 200});
  track.clockWentBack(1);
  EXPECT_EQ(released(track), Stamps({0, 100, 200}));
  track.beginEpoch(1);
  track.add(at(150), false, {});
  track.add(at(250), false, {});
  EXPECT_EQ(released(track), Stamps({150}));
}

TEST(Track, ALeftoverFromBeforeTheClockWentBackDoesNotOpenTheEpoch) {
  Track track = fed({0, 100, 5000});
  track.clockWentBack(1);
  track.beginEpoch(1);
  track.add(at(5100), false, {});  // was still on its way
  track.add(at(0), false, {});
  track.add(at(100), false, {});
  EXPECT_EQ(track.epoch(), 1u);
  EXPECT_EQ(released(track), Stamps({0}));
  EXPECT_EQ(track.counts().late, 1u);
}

TEST(Track, TheClockDoesNotCutATrackThatHasGoneBackByItself) {
  Track track = fed({5000, 5100, 0, 100});
  track.beginEpoch(1);
  track.clockWentBack(2);
  EXPECT_EQ(track.epoch(), 1u);
  track.clockWentBack(2);
  EXPECT_EQ(track.epoch(), 2u);
}

TEST(Track, AFixedPoseNeverEnds) {
  Pose pose;
  pose.position = {1, 2, 3};
  Track track(pose);
  EXPECT_EQ(track.status(), Track::Status::kFixed);
  const Reach reach = track.reach(0);
  EXPECT_EQ(reach.what, Reach::What::kStill);
  EXPECT_EQ(reach.until_ns, std::numeric_limits<Nanoseconds>::max());
  EXPECT_EQ(track.restAt(0).at(1e9).position, pose.position);
}

TEST(Track, ForgetsSamplesButNeverTheLast) {
  Track track = fed({0, 100, 200, 300});
  track.dropBefore(track.firstIndex() + 2);
  EXPECT_EQ(released(track), Stamps({200}));
  track.dropBefore(1000);
  track.add(at(400), false, {});
  EXPECT_EQ(released(track), Stamps({200, 300}));
  EXPECT_EQ(track.sample(track.firstIndex() + 1).join, Join::kJoined);
}

}  // namespace
}  // namespace collision_node::scene
