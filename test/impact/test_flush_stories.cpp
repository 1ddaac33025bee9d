/// A slider that rests on slabs of random lengths: deep enough for a proof, exactly flush, or over a gap.
/// Truth is the arithmetic of intervals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "test/impact/claims.h"

namespace moving {
namespace {

using collision_node::geometry::Box;
using collision_node::geometry::Convex;
using collision_node::geometry::Cylinder;
using collision_node::geometry::Mesh;

constexpr std::uint64_t kSeed = 20261127;
constexpr Nanoseconds kEnd = 1'000'000'000;

enum class Slab { kDeep, kFlush, kNone };

/// When the slider is over a slab of this kind [s].
struct Stay {
  Slab slab;
  double from, to;
};

struct Story {
  Shapes slabs, slider;
  PairOptions options;
  double speed = 0.0, spin = 0.0, half = 0.0;
  std::vector<Stay> stays;

  /// By how much the time near to a slab may be longer than over it: at a contact distance c, what is deep is
  /// near from a little beside the slab, too, and some of what is flush may be. [s]
  double beside() const { return std::sqrt(2e-9 * options.contact_distance) / speed; }

  std::string text() const {
    std::ostringstream out;
    out.precision(12);
    out << "speed " << speed << " spin " << spin << " contact distance " << options.contact_distance << ";";
    for (const Stay& stay : stays)
      out << (stay.slab == Slab::kDeep ? " deep [" : " flush [") << stay.from << ", " << stay.to << "]";
    return out.str();
  }

  /// The times of longer than `least` in which it is over no slab at all.
  std::vector<Stay> freeTimes(double least) const {
    std::vector<Stay> free;
    double until = 0.0;
    for (const Stay& stay : stays) {
      if (stay.slab == Slab::kNone) continue;
      if (stay.from - until > least) free.push_back({Slab::kNone, until, stay.from});
      until = std::max(until, stay.to);
    }
    if (1.0 - until > least) free.push_back({Slab::kNone, until, 1.0});
    return free;
  }
};

PlacedShape asKind(int kind, double half) {
  switch (kind) {
    case 0:
      return placed(Box{{2 * half, 2 * half, 2 * half}});
    case 1:
      return placed(Convex{std::get<Mesh>(boxMesh({half, half, half}).shape).mesh});
    case 2:
      return boxMesh({half, half, half});
    default:
      return placed(Cylinder{half, 2 * half});
  }
}

/// Moves along x for a second, its lower face at z = 0; a cylinder's or a turning slider's ends in x are
/// those of its round face, so that turning changes nothing.
Story makeStory(Random& random, int kind) {
  Story s;
  s.half = 0.03125;
  s.speed = random.decade(-1, 1);
  s.spin = kind == 3 && random.chance(0.5) ? random.decade(-3, 1) : 0.0;
  s.slider = {asKind(kind, s.half)};
  if (random.chance(0.3)) s.options.contact_distance = 0.0625;
  double x = -10.0;
  Slab before = Slab::kNone;
  double length = 10.0 - random.in(0.0, 0.3) * s.speed;
  for (int i = 0; x < 1.1 * s.speed; ++i) {
    Slab now;
    do now = static_cast<Slab>(random.below(3));
    while (now == before);
    const double end = x + length;
    if (now != Slab::kNone) {
      const double top = (now == Slab::kDeep ? 1e-9 : 0.0) - s.options.contact_distance;
      // A gap closes for a slider that is longer; what is over it has both ends in it.
      s.slabs.push_back(placed(Box{{length, 2, 1}}, Vec3(x + 0.5 * length, 0, top - 0.5)));
      s.stays.push_back({now, (x - s.half) / s.speed - s.beside(), (end + s.half) / s.speed + s.beside()});
    }
    before = now;
    x = end;
    length = (now == Slab::kNone ? 0.0 : 2 * s.half) + random.decade(-6, -0.3) * s.speed;
    if (random.chance(0.5)) length += 2 * s.half;
  }
  return s;
}

TEST(FlushStories, NoFreeTimeIsPassedOver) {
  // "proved contact but for gaps no longer than a bracket or no wider than 256 rounding budgets", and apart
  // only where nothing is deep.
  int free_times = 0, told = 0, possible = 0, events = 0;
  for (int i = 0; i < 400; ++i) {
    Random random(kSeed, i);
    const Story s = makeStory(random, i % 4);
    SCOPED_TRACE(std::to_string(i) + ": " + s.text());
    if (s.slabs.empty()) continue;
    Watched pair(s.slabs, s.slider, s.options);
    // Seen from anywhere: what is flush is so within the rounding only.
    const Quat turn = random.chance(0.5) ? random.orientation() : Quat::Identity();
    const Vec3 place = random.chance(0.5) ? randomVec(random, 100.0) : Vec3::Zero();
    pair.advanceInParts(0, kEnd, resting(place, turn),
                        flight(0, kEnd, place + turn * Vec3(0, 0, s.half), turn * Vec3(s.speed, 0, 0),
                               turn * Vec3(0, 0, s.spin), turn),
                        random.chance(0.5) ? 1 : 1 + random.below(20));
    pair.finish();
    std::vector<PairEvent> whole = pair.events;
    for (PairEvent& e : whole) {
      const double off = 1e-9 * static_cast<double>(e.interval_start_ns);
      e.toi_lower += off, e.toi_upper += off;
      possible += e.certificate == Certificate::kPossible;
    }
    events += static_cast<int>(whole.size());
    const double rounding = 1e-12, merged = 3e-9;
    for (const Claim& claim : claimsOf(whole, 1.0)) {
      if (claim.said != Said::kTouching) continue;
      for (const Stay& free : s.freeTimes(merged)) {
        const double passed = std::min(claim.to, free.to) - std::max(claim.from, free.from);
        EXPECT_LE(passed, merged + rounding) << "touching on [" << claim.from << ", " << claim.to
                                             << "] s, free on [" << free.from << ", " << free.to << "] s\n"
                                             << listOf(whole);
      }
    }
    // Behind a POSSIBLE the pair may be an open question.
    double apart_from = 0.0;
    for (std::size_t i = 0; i <= whole.size(); ++i) {
      const double apart_to = i < whole.size() ? whole[i].toi_lower : 1.0;
      for (const Stay& stay : s.stays) {
        if (stay.slab != Slab::kDeep) continue;
        EXPECT_LE(std::min(apart_to, stay.to - s.beside()) - std::max(apart_from, stay.from + s.beside()),
                  rounding)
            << "apart on [" << apart_from << ", " << apart_to << "] s, deep on [" << stay.from << ", "
            << stay.to << "] s\n"
            << listOf(whole);
      }
      const bool parts = i < whole.size() && whole[i].kind == Kind::kSeparation &&
                         whole[i].certificate == Certificate::kConfirmed;
      apart_from = parts ? whole[i].toi_upper : 1.0;
    }
    for (const Stay& free : s.freeTimes(merged)) {
      ++free_times;
      told += std::any_of(whole.begin(), whole.end(), [&](const PairEvent& e) {
        return e.kind == Kind::kSeparation && e.toi_lower <= free.to && e.toi_upper >= free.from;
      });
    }
  }
  // An open question about everything would be right, too.
  EXPECT_GT(2 * told, free_times);
  EXPECT_LT(4 * possible, events);
  std::printf("%d free times, %d told by a separation; %d events, %d POSSIBLE\n", free_times, told, events,
              possible);
}

TEST(FlushStories, AnOpenOverlapHasNoNormalWhenTheDataEndEither) {
  Watched pair({placed(Box{{1, 1, 1}})}, {placed(Box{{1, 1, 1}})});
  pair.advance(0, kEnd, resting(), resting({0.25, 0.125, 1}));
  pair.finish();
  ASSERT_EQ(pair.story(), "INITIAL_OVERLAP POSSIBLE") << pair.list();
  EXPECT_TRUE(pair.events[0].normal.array().isNaN().all()) << pair.list();
  EXPECT_TRUE(std::isnan(pair.events[0].closing_speed)) << pair.list();
}

TEST(FlushStories, WhoTouchedOnAnEarlierPieceOfTheBracketIsSaidToBeThereToo) {
  // Flush on one slab up to the stamp, flush and then deep on others behind it.
  Watched pair({placed(Box{{0.25, 2, 1}}, Vec3(-0.2, 0, -0.5)), placed(Box{{0.3, 2, 1}}, Vec3(0.05, 0, -0.5)),
                placed(Box{{1, 2, 1}}, Vec3(0.575, 0, -0.5 + 1e-6))},
               {asKind(0, 0x1p-6)});
  const RigidMotion slides = flight(0, 2 * kEnd, {-1, 0, 0x1p-6}, {1, 0, 0});
  pair.advance(0, kEnd, resting(), slides);
  pair.advance(kEnd, 2 * kEnd, resting(), slides);
  ASSERT_FALSE(pair.events.empty());
  EXPECT_TRUE(pair.events[0].multiple) << pair.list();
}

TEST(FlushStories, WhatCannotBeFollowedIsPossibleAndNotContact) {
  // "the time between them is a SEPARATION, POSSIBLE, and the contact behind it an INITIAL_OVERLAP": a box
  // spins on a slab a little deep, then on one that is flush.
  const auto slab = [](double from, double to, double top) {
    return placed(Box{{to - from, 2, 1}}, Vec3(0.5 * (from + to), 0, top - 0.5));
  };
  PairOptions options;
  options.node_budget = 100000;
  Watched pair({slab(-1, 0, 1e-7), slab(0, 0.5, 0), slab(0.5, 1.5, 1e-7)}, {asKind(0, 0.03125)}, options);
  const auto spinning = flight(0, kEnd, {-0.1, 0, 0.03125}, {1, 0, 0}, {0, 0, 30});
  pair.advance(0, kEnd, resting(), spinning);
  ASSERT_EQ(pair.story(), "INITIAL_OVERLAP CONFIRMED, SEPARATION POSSIBLE, INITIAL_OVERLAP CONFIRMED")
      << pair.list();
  EXPECT_LE(pair.events[1].toi_upper, pair.events[2].toi_lower);
  EXPECT_LT(pair.events[1].toi_lower, 0.2) << "flush from then on at the latest";
  EXPECT_GT(pair.events[1].toi_upper, 0.5) << "deep again from then on at the earliest";
}

/// A small box moves at 1 m/s from x = -1 for two seconds: `before` the second one flush or deep, flush until
/// `flush` seconds after it began, free, in contact from `bump` for `length`, free. By the second: pieces.
struct Bump {
  double flush, bump, length, before = 1e-9, depth = 1e-9;
  std::vector<double> cuts = {};
  std::uint64_t node_budget = PairOptions().node_budget;

  std::unique_ptr<Watched> run() const {
    constexpr double kHalf = 0x1p-10;
    const auto slab = [](double from, double to, double top) {
      return placed(Box{{to - from, 2, 1}}, Vec3(0.5 * (from + to), 0, top - 0.5));
    };
    PairOptions options;
    options.node_budget = node_budget;
    auto pair = std::make_unique<Watched>(Shapes{slab(-10, -0.5, before), slab(-0.5, flush - kHalf, 0.0),
                                                 slab(bump + kHalf, bump + length - kHalf, depth)},
                                          Shapes{placed(Box{Vec3::Constant(2 * kHalf)})}, options);
    const RigidMotion slides = flight(0, 2 * kEnd, {-1, 0, kHalf}, {1, 0, 0});
    Nanoseconds from = 0;
    for (const double cut : cuts) {
      const auto to = static_cast<Nanoseconds>(cut * 1e9);
      pair->advance(from, to, resting(), slides);
      from = to;
    }
    pair->advance(from, 2 * kEnd, resting(), slides);
    pair->finish();
    return pair;
  }
};

double from1s(const PairEvent& e, double toi) {
  return 1e-9 * static_cast<double>(e.interval_start_ns - kEnd) + toi;
}

TEST(FlushStories, AFreeTimeBehindAPieceThatEndedFlushIsTold) {
  for (int i = 0; i < 60; ++i) {
    const double flush = 0.2 * std::pow(1.3, i / 60.0);
    Bump story{flush, 1.05 * flush, 0.15 * flush};
    story.cuts = {1.0};
    const auto pair = story.run();
    ASSERT_EQ(pair->story(),
              "INITIAL_OVERLAP CONFIRMED, SEPARATION CONFIRMED, IMPACT CONFIRMED, SEPARATION CONFIRMED")
        << pair->list();
    EXPECT_GE(from1s(pair->events[1], pair->events[1].toi_upper), flush);
    EXPECT_LE(from1s(pair->events[2], pair->events[2].toi_lower), story.bump);
    EXPECT_GE(from1s(pair->events[2], pair->events[2].toi_upper), story.bump);
  }
}

TEST(FlushStories, AContactWithinATimeThatEndsFreeIsTold) {
  // "Every free interval longer than W is owed a SEPARATION": not the last one alone.
  for (int i = 0; i < 200; ++i) {
    const double flush = 0.2 * std::pow(1.3, i / 200.0);
    Bump story{flush, 1.12 * flush, 0.004};
    if (i % 2 == 1) story.cuts = {1.0};
    const auto pair = story.run();
    ASSERT_EQ(pair->story(),
              "INITIAL_OVERLAP CONFIRMED, SEPARATION CONFIRMED, IMPACT CONFIRMED, SEPARATION CONFIRMED")
        << pair->list();
  }
}

TEST(FlushStories, WhereTheBudgetEndsNoFreeTimeIsCalledContact) {
  for (const double flush : {0.2, 0.23}) {
    for (std::uint64_t budget = 1; budget < 600; ++budget) {
      Bump story{flush, 1.1 * flush, 0.5};
      story.node_budget = budget;
      const auto pair = story.run();
      for (const Claim& claim : claimsOf(pair->events, 2.0)) {
        if (claim.said != Said::kTouching) continue;
        EXPECT_LE(std::min(claim.to, 1 + story.bump) - std::max(claim.from, 1 + flush), 1e-8)
            << "budget " << budget << '\n'
            << pair->list();
      }
    }
  }
}

TEST(FlushStories, BehindAnOpenQuestionNoContactIsPassedOver) {
  // Flush for two pieces, so that the question is published; what is open of the third is a bracket again.
  for (const double length : {0.01, 0.004, 0.001}) {
    for (int i = 0; i < 100; ++i) {
      const double flush = 0.2 * std::pow(1.3, i / 100.0);
      Bump story{flush, 1.12 * flush, length, 0.0, 1e-4};
      story.cuts = {0.5, 1.0};
      const auto pair = story.run();
      EXPECT_TRUE(std::any_of(pair->events.begin(), pair->events.end(),
                              [&](const PairEvent& e) {
                                return from1s(e, e.toi_lower) <= story.bump + length &&
                                       from1s(e, e.toi_upper) >= story.bump;
                              }))
          << "contact on [" << story.bump << ", " << story.bump + length << "] s\n"
          << pair->list();
    }
  }
}

}  // namespace
}  // namespace moving
