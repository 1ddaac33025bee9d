#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "collision_node/scene/tracks/pieces.h"
#include "collision_node/scene/tracks/time_line.h"

namespace collision_node::scene {
namespace {

constexpr Nanoseconds kMs = 1'000'000;
constexpr Nanoseconds kTimeout = 1500 * kMs;

TrackOptions options(OnTimeout on_timeout = OnTimeout::kDrop) {
  TrackOptions options;
  options.on_timeout = on_timeout;
  options.reorder_ns = 100 * kMs;
  options.max_gap_ns = 1000 * kMs;
  options.jump_ns = 1000 * kMs;
  return options;
}

motion::StampedPose at(Nanoseconds stamp_ms) {
  motion::StampedPose pose;
  pose.stamp_ns = stamp_ms * kMs;
  return pose;
}

TimeLine twoTracks(OnTimeout second = OnTimeout::kDrop) {
  return TimeLine({Track(options()), Track(options(second))}, kTimeout);
}

void feed(TimeLine& line, int track, Nanoseconds from_ms, Nanoseconds to_ms) {
  for (Nanoseconds t = from_ms; t <= to_ms; t += 100) line.add(track, at(t), false);
}

TEST(TimeLine, WatermarkIsTheSmallestLastReleasedStamp) {
  TimeLine line = twoTracks();
  feed(line, 0, 0, 500);
  EXPECT_FALSE(line.watermark());  // the other one is waited for
  feed(line, 1, 50, 350);
  EXPECT_EQ(line.watermark(), 250 * kMs);
  feed(line, 1, 450, 850);
  EXPECT_EQ(line.watermark(), 400 * kMs);
  EXPECT_EQ(line.firstReleased(), 0);
  EXPECT_EQ(line.newestReleased(), 750 * kMs);
}

TEST(TimeLine, AFirstPoseIsWaitedForUpToTimeout) {
  TimeLine line = twoTracks();
  feed(line, 0, 0, 1600);
  EXPECT_FALSE(line.watermark());
  EXPECT_EQ(line.tracks()[1].status(), Track::Status::kWaiting);
  feed(line, 0, 1700, 1700);
  EXPECT_EQ(line.tracks()[1].status(), Track::Status::kUncovered);
  EXPECT_EQ(line.watermark(), 1600 * kMs);
  line.add(1, at(1500), false);  // too late to join
  EXPECT_EQ(line.tracks()[1].counts().late, 1u);
  line.add(1, at(1650), false);
  EXPECT_EQ(line.tracks()[1].status(), Track::Status::kLive);
  feed(line, 0, 1800, 2200);
  EXPECT_EQ(line.watermark(), 1600 * kMs);  // held for the one that has just joined
  line.add(1, at(1750), false);
  EXPECT_EQ(line.watermark(), 1650 * kMs);
}

TEST(TimeLine, ASilentTrackIsDroppedByDataTime) {
  TimeLine line = twoTracks();
  feed(line, 0, 0, 100);
  feed(line, 1, 0, 100);
  feed(line, 0, 200, 1700);
  EXPECT_EQ(line.watermark(), 0);
  EXPECT_EQ(line.tracks()[1].status(), Track::Status::kLive);
  feed(line, 0, 1800, 1800);
  EXPECT_EQ(line.tracks()[1].status(), Track::Status::kTimedOut);
  EXPECT_EQ(line.tracks()[1].lastReleased(), 100 * kMs);
  EXPECT_EQ(line.watermark(), 1700 * kMs);
}

TEST(TimeLine, TheWatermarkNeverGoesBack) {
  const unsigned seed = 4242;
  std::mt19937_64 random(seed);
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    TimeLine line({Track(options()), Track(options(OnTimeout::kFreeze)), Track(options())}, kTimeout);
    Nanoseconds clock[3] = {0, static_cast<Nanoseconds>(random() % 3000), 0};
    std::optional<Nanoseconds> before;
    std::uint32_t epoch = 0;
    for (int i = 0; i < 300; ++i) {
      const int track = static_cast<int>(random() % 3);
      clock[track] += static_cast<Nanoseconds>(random() % 90);
      if (random() % 100 == 0) clock[track] += 2000;
      if (random() % 150 == 0) clock[track] = 0;
      line.add(track, at(clock[track]), false);
      while (line.epochIsOver()) {
        line.closeEpoch();
        line.nextEpoch();
      }
      if (line.epoch() != epoch) before.reset();
      ASSERT_GE(line.epoch(), epoch);
      epoch = line.epoch();
      ASSERT_FALSE(before && !line.watermark());
      if (before && line.watermark()) {
        ASSERT_GE(*line.watermark(), *before);
      }
      before = line.watermark();
    }
  }
}

TEST(TimeLine, AnEpochIsOverWhenEveryLiveTrackHasLeftIt) {
  TimeLine line = twoTracks();
  feed(line, 0, 5000, 5500);
  feed(line, 1, 5000, 5500);
  feed(line, 0, 0, 300);
  EXPECT_FALSE(line.epochIsOver());
  EXPECT_EQ(line.watermark(), 5400 * kMs);  // the other one's; the epoch goes on for it
  feed(line, 1, 0, 100);
  ASSERT_TRUE(line.epochIsOver());
  line.closeEpoch();
  line.nextEpoch();
  EXPECT_EQ(line.epoch(), 1u);
  EXPECT_EQ(line.watermark(), 0);
  EXPECT_EQ(line.newestReleased(), 200 * kMs);
}

TEST(TimeLine, ATrackThatStaysBehindIsNotWaitedForLongerThanTimeout) {
  TimeLine line = twoTracks();
  feed(line, 0, 5000, 5500);
  feed(line, 1, 5000, 5500);
  feed(line, 0, 0, 1600);
  EXPECT_FALSE(line.epochIsOver());
  feed(line, 0, 1700, 1700);
  ASSERT_TRUE(line.epochIsOver());
  line.closeEpoch();
  line.nextEpoch();
  EXPECT_EQ(line.tracks()[1].status(), Track::Status::kUncovered);
  line.add(1, at(5600), false);  // it never went back; it goes on in the new epoch
  EXPECT_EQ(line.tracks()[1].status(), Track::Status::kLive);
}

TEST(TimeLine, ClockWentBackTakesAllTracksAlong) {
  TimeLine line = twoTracks();
  line.clockWentBack();
  EXPECT_FALSE(line.epochIsOver());  // nothing to go back from
  feed(line, 0, 5000, 5500);
  feed(line, 1, 5000, 5500);
  feed(line, 0, 0, 100);  // this one was faster than /clock
  line.clockWentBack();
  ASSERT_TRUE(line.epochIsOver());
  line.closeEpoch();
  line.nextEpoch();
  EXPECT_EQ(line.epoch(), 1u);
  EXPECT_FALSE(line.epochIsOver());
  EXPECT_EQ(line.tracks()[0].status(), Track::Status::kLive);
  EXPECT_EQ(line.tracks()[1].status(), Track::Status::kWaiting);
}

TEST(TimeLine, TheClockMayFollowAJumpThatTheSceneHasAlreadyMade) {
  // The second object flew for half a second and is long gone when the bag loops: the first one's poses alone
  // carry the scene into the new round, and /clock tells of it a moment later. The second object belongs to
  // that same round.
  TimeLine line = twoTracks();
  feed(line, 0, 5000, 5500);
  feed(line, 1, 5000, 5500);
  feed(line, 0, 5600, 8200);
  ASSERT_EQ(line.tracks()[1].status(), Track::Status::kTimedOut);
  feed(line, 0, 5000, 5100);
  ASSERT_TRUE(line.epochIsOver());
  line.closeEpoch();
  line.nextEpoch();
  line.clockWentBack();
  EXPECT_FALSE(line.epochIsOver());
  feed(line, 1, 5000, 5500);
  feed(line, 0, 5200, 5500);
  EXPECT_EQ(line.epoch(), 1u);
  EXPECT_FALSE(line.epochIsOver());
  EXPECT_EQ(line.tracks()[0].status(), Track::Status::kLive);
  EXPECT_EQ(line.tracks()[1].status(), Track::Status::kLive);
  // The clock goes back once more: now it is news.
  line.clockWentBack();
  EXPECT_TRUE(line.epochIsOver());
}

TEST(TimeLine, APoseHeldSinceTheClockWentBackDoesNotSpeakOfWhatIsDecided) {
  TimeLine line = twoTracks();
  feed(line, 0, 0, 2000);
  feed(line, 1, 0, 2000);
  line.clockWentBack();
  ASSERT_TRUE(line.epochIsOver());
  line.closeEpoch();
  line.nextEpoch();
  line.add(0, at(2500), false);  // perhaps a leftover of the time before
  feed(line, 1, 0, 6000);        // nobody waits for the first one any more
  ASSERT_EQ(line.watermark(), 5900 * kMs);
  for (const Nanoseconds t : {2600, 2700}) line.add(0, at(t), false);
  EXPECT_EQ(line.tracks()[0].counts().late, 3u);
  EXPECT_FALSE(line.tracks()[0].lastReleased());
  for (const Nanoseconds t : {5950, 6100}) line.add(0, at(t), false);
  EXPECT_EQ(line.tracks()[0].lastReleased(), 5950 * kMs);
}

// ---- pieces

struct Walk {
  std::vector<std::pair<Nanoseconds, Nanoseconds>> pieces;  // [ms]; a break is {-1, reason}
};

Walk walk(PieceCursor& cursor, const TimeLine& line, Nanoseconds rest_known_ms = 0) {
  Walk out;
  for (;;) {
    const Step step = cursor.next(line.tracks()[0], line.tracks()[1], rest_known_ms * kMs);
    if (step.what == Step::What::kWait) return out;
    if (step.what == Step::What::kBreak) {
      out.pieces.push_back({-1, static_cast<Nanoseconds>(step.reason)});
    } else {
      out.pieces.push_back({step.piece.start_ns / kMs, step.piece.end_ns / kMs});
    }
  }
}

using Pieces = std::vector<std::pair<Nanoseconds, Nanoseconds>>;

TEST(PieceCursor, CutsAtEveryStampOfEitherTrackAndKeepsEachTracksOwnSegment) {
  TimeLine line = twoTracks();
  line.add(0, at(0), false);
  line.add(0, at(200), false);
  line.add(0, at(400), false);
  line.add(1, at(150), false);
  line.add(1, at(300), false);
  line.add(1, at(500), false);
  line.releaseAll();
  PieceCursor cursor;
  cursor.restart(line.tracks()[0], line.tracks()[1]);
  const Step first = cursor.next(line.tracks()[0], line.tracks()[1], 0);
  ASSERT_EQ(first.what, Step::What::kPiece);
  EXPECT_EQ(first.piece.start_ns, 150 * kMs);
  EXPECT_EQ(first.piece.a.start_ns, 0);  // not re-interpolated at the other's stamp
  EXPECT_EQ(first.piece.a.end_ns, 200 * kMs);
  EXPECT_EQ(first.piece.b.start_ns, 150 * kMs);
  EXPECT_EQ(walk(cursor, line).pieces, (Pieces{{200, 300}, {300, 400}}));
}

TEST(PieceCursor, BreaksAtAGapAndBeginsAgainBehindIt) {
  TimeLine line = twoTracks();
  feed(line, 0, 0, 1500);
  feed(line, 1, 0, 200);
  feed(line, 1, 1300, 1500);
  line.releaseAll();
  PieceCursor cursor;
  cursor.restart(line.tracks()[0], line.tracks()[1]);
  const auto gap = static_cast<Nanoseconds>(impact::Reason::kGap);
  EXPECT_EQ(walk(cursor, line).pieces, (Pieces{{0, 100}, {100, 200}, {-1, gap}, {1300, 1400}, {1400, 1500}}));
}

TEST(PieceCursor, AFrozenObjectIsKnownUpToTheWatermark) {
  TimeLine line = twoTracks(OnTimeout::kFreeze);
  feed(line, 0, 0, 100);
  feed(line, 1, 0, 100);
  feed(line, 0, 200, 1900);
  ASSERT_EQ(line.tracks()[1].status(), Track::Status::kTimedOut);
  PieceCursor cursor;
  cursor.restart(line.tracks()[0], line.tracks()[1]);
  EXPECT_EQ(walk(cursor, line, 250).pieces, (Pieces{{0, 100}, {100, 200}}));
  const Step step = cursor.next(line.tracks()[0], line.tracks()[1], 300 * kMs);
  EXPECT_EQ(step.trust.doubt, impact::Reason::kTimeout);
  EXPECT_TRUE(step.piece.b.fixed);
}

TEST(PieceCursor, TheRestOfAFrozenObjectEndsAtItsReturn) {
  TimeLine line = twoTracks(OnTimeout::kFreeze);
  feed(line, 0, 0, 100);
  feed(line, 1, 0, 100);
  feed(line, 0, 200, 1900);
  line.add(1, at(1850), false);
  line.add(1, at(1950), false);
  line.add(0, at(2000), false);
  line.releaseAll();
  PieceCursor cursor;
  cursor.restart(line.tracks()[0], line.tracks()[1]);
  const Pieces pieces = walk(cursor, line, 10000).pieces;
  ASSERT_GE(pieces.size(), 4u);
  const Pieces last(pieces.end() - 4, pieces.end());
  const auto timeout = static_cast<Nanoseconds>(impact::Reason::kTimeout);
  EXPECT_EQ(last, (Pieces{{1800, 1850}, {-1, timeout}, {1850, 1900}, {1900, 1950}}));
}

TEST(PieceCursor, LetsGoOfWhatNobodyCanJoinAnyMore) {
  TimeLine line = twoTracks();
  feed(line, 0, 0, 5000);
  PieceCursor cursor;
  cursor.restart(line.tracks()[0], line.tracks()[1]);
  cursor.skipTo(line.tracks()[0], line.tracks()[1], *line.watermark());
  EXPECT_EQ(line.tracks()[0].stamp(cursor.indexA()), line.watermark());
}

}  // namespace
}  // namespace collision_node::scene
