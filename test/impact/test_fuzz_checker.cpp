/// Proof that the fuzz test can go red: methods that are wrong on purpose must each draw complaints, and one
/// that answers with the oracle's own numbers must draw none.
#include <gtest/gtest.h>

#include <cmath>

#include "test/impact/fuzz_check.h"

namespace {

namespace impact = collision_node::impact;
using fuzz::Case;
using impact::Certificate;
using impact::Kind;
using impact::PairEvent;
using impact::PairState;
using impact::Piece;
using impact::PieceOutcome;
using oracle::Pair;
using oracle::Real;
using oracle::V3;

constexpr std::uint64_t kSeed = 424242;
constexpr int kCases = 40;

class Stub : public impact::PairMethod {
 public:
  void finish(PairState&, std::vector<PairEvent>&) const override {}
  void interrupt(PairState& state, impact::Reason, std::vector<PairEvent>&) const override { state = {}; }
};

class AlwaysClear : public Stub {
 public:
  PieceOutcome advance(const Piece&, PairState& state, std::vector<PairEvent>&) const override {
    state.phase = PairState::Phase::kApart;
    return {};
  }
};

class AlwaysPossible : public Stub {
 public:
  PieceOutcome advance(const Piece& piece, PairState&, std::vector<PairEvent>& events) const override {
    PairEvent e;
    e.certificate = Certificate::kPossible;
    e.interval_start_ns = piece.start_ns, e.interval_end_ns = piece.end_ns;
    e.toi_upper = collision_node::motion::secondsBetween(piece.start_ns, piece.end_ns);
    events.push_back(e);
    PieceOutcome outcome;
    outcome.answer = impact::Answer::kUndecided;
    return outcome;
  }
};

/// What a perfect method would say, from the oracle; `spoil` may then change the events.
class FromTheOracle : public Stub {
 public:
  using Spoil = void (*)(std::vector<PairEvent>&, double duration);
  FromTheOracle(const Case& c, Spoil spoil)
      : case_(c), pair_(c.pair()), truth_(truthOf(c, pair_)), spoil_(spoil) {}

  PieceOutcome advance(const Piece&, PairState&, std::vector<PairEvent>& events) const override {
    const Real end = pair_.duration();
    Real now = 0;
    bool touching = pair_.touching(0);
    if (touching) events.push_back(event(Kind::kInitialOverlap, 0, 0));
    while (now < end && events.size() < 40) {
      if (!touching) {
        const oracle::FirstTouch touch = pair_.firstTouch(now, end);
        if (!touch.found) break;
        if (!touch.verified) {  // a near miss within rounding
          now = touch.lo + 1e-9L * end;
          continue;
        }
        PairEvent e = event(Kind::kImpact, touch.lo, touch.hi);
        if (events.empty()) facts(e, touch);
        events.push_back(e);
        now = touch.hi, touching = true;
      } else {
        Real apart = now;
        while (apart < end && pair_.touching(apart))
          apart = apart == now ? now + 1e-12L * end : apart + std::min(apart - now, end / 300);
        if (!(apart < end)) break;
        Real last = now;
        for (int i = 0; i < 80; ++i) {
          const Real mid = (last + apart) / 2;
          (pair_.touching(mid) ? last : apart) = mid;
        }
        events.push_back(event(Kind::kSeparation, last, apart));
        now = events.back().toi_upper + 1e-12L * end, touching = pair_.touching(now);
        if (touching) events.pop_back();  // only a flicker of rounding
      }
    }
    PieceOutcome outcome;
    outcome.answer = events.empty() ? impact::Answer::kClear : impact::Answer::kImpact;
    if (spoil_) spoil_(events, static_cast<double>(end));
    return outcome;
  }

 private:
  PairEvent event(Kind kind, Real lower, Real upper) const {
    PairEvent e;
    e.kind = kind, e.certificate = Certificate::kConfirmed;
    e.interval_start_ns = case_.piece.start_ns, e.interval_end_ns = case_.piece.end_ns;
    const double end = case_.duration();
    e.toi_lower = lower > 0 ? std::nextafter(static_cast<double>(lower), 0.0) : 0.0;
    e.toi_upper = upper > 0 ? std::min(end, std::nextafter(static_cast<double>(upper), 2 * end)) : 0.0;
    return e;
  }

  void facts(PairEvent& e, const oracle::FirstTouch& touch) const {
    const auto vec = [](const V3& v) {
      return impact::Vec3(static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
    };
    const V3 origin = oracle::exact(case_.piece.a.c[0]);
    e.multiple = !truth_.point_known;
    e.position = vec(truth_.point + origin);
    e.position_error = static_cast<double>(1e-9L * pair_.scale() + 1e-15L * norm(origin));
    e.normal = vec(truth_.normal);
    e.normal_error = 1e-6;
    const oracle::Frame fa = pair_.pathA().at(e.toi_lower), fb = pair_.pathB().at(e.toi_lower);
    const V3 velocity = fb.velocityAt(truth_.point) - fa.velocityAt(truth_.point);
    e.relative_velocity = vec(velocity);
    e.closing_speed = -e.relative_velocity.dot(e.normal);
    const auto nearest = pair_.partGapAt(touch.part_a, touch.part_b, touch.lo);
    const auto side = [&](impact::Side& s, const oracle::Frame& f,
                          const collision_node::motion::RigidMotion& m, const V3& p) {
      s.pose.position = vec(f.position + origin);
      const V3 r = p - f.position;
      s.point =
          vec({dot(f.rotation.column[0], r), dot(f.rotation.column[1], r), dot(f.rotation.column[2], r)});
      s.sample_before_ns = m.start_ns, s.sample_after_ns = m.end_ns;
    };
    side(e.a, fa, case_.piece.a, nearest.a + fa.position);
    side(e.b, fb, case_.piece.b, nearest.b + fa.position);
  }

  const Case& case_;
  Pair pair_;
  fuzz::Truth truth_;
  Spoil spoil_;
};

/// Over all cases: complaints drawn by a method, and how many cases it ought to have been caught on.
struct Catch {
  int due = 0, caught = 0;
};

template <class MakeMethod, class Due>
Catch catchAll(const MakeMethod& make, const Due& due) {
  Catch out;
  for (int i = 0; i < kCases; ++i) {
    const Case c = fuzz::makeCase(kSeed, i);
    const fuzz::Truth truth = truthOf(c, c.pair());
    if (!due(truth)) continue;
    ++out.due;
    if (check(c, *make(c)).empty()) {
      ADD_FAILURE() << "no complaint about " << c.describe();
    } else {
      ++out.caught;
    }
  }
  return out;
}

bool touches(const fuzz::Truth& t) { return t.first.found && t.first.verified; }
bool transversal(const fuzz::Truth& t) { return t.transversal; }

TEST(FuzzChecker, TheOraclesOwnAnswerDrawsNoComplaint) {
  for (int i = 0; i < kCases; ++i) {
    const Case c = fuzz::makeCase(kSeed, i);
    for (const std::string& line : check(c, FromTheOracle(c, nullptr)))
      ADD_FAILURE() << line << "\n" << c.describe();
  }
}

TEST(FuzzChecker, ClearEverywhereIsCaughtOnEveryContact) {
  const Catch all = catchAll([](const Case&) { return std::make_unique<AlwaysClear>(); }, touches);
  EXPECT_GT(all.due, kCases / 4);
}

TEST(FuzzChecker, PossibleEverywhereIsCaughtOnEveryHitAndEveryClearPair) {
  const Catch all = catchAll([](const Case&) { return std::make_unique<AlwaysPossible>(); },
                             [](const fuzz::Truth& t) { return t.transversal || t.well_apart; });
  EXPECT_GT(all.due, kCases / 2);
}

TEST(FuzzChecker, AMillionthOfTheStepTooLateIsCaught) {
  const auto late = [](std::vector<PairEvent>& events, double duration) {
    for (PairEvent& e : events) {
      e.toi_lower = std::min(duration, e.toi_lower + 1e-6 * duration);
      e.toi_upper = std::min(duration, e.toi_upper + 1e-6 * duration);
    }
  };
  const Catch all =
      catchAll([&](const Case& c) { return std::make_unique<FromTheOracle>(c, late); }, transversal);
  EXPECT_GT(all.due, kCases / 4);
}

TEST(FuzzChecker, ABracketWiderThanPromisedIsCaught) {
  const auto wide = [](std::vector<PairEvent>& events, double duration) {
    if (!events.empty()) events[0].toi_lower = std::max(0.0, events[0].toi_lower - 0.01 * duration);
  };
  catchAll([&](const Case& c) { return std::make_unique<FromTheOracle>(c, wide); }, transversal);
}

TEST(FuzzChecker, ALostSeparationIsCaught) {
  const auto stuck = [](std::vector<PairEvent>& events, double) {
    if (events.size() > 1) events.resize(1);
  };
  const Catch all = catchAll([&](const Case& c) { return std::make_unique<FromTheOracle>(c, stuck); },
                             [](const fuzz::Truth& t) { return t.transversal; });
  // Where contact lasts to the piece's end nothing was lost.
  EXPECT_GT(all.caught, 0);
}

TEST(FuzzChecker, AWrongPlaceOrNormalIsCaught) {
  const auto moved = [](std::vector<PairEvent>& events, double) {
    if (!events.empty()) events[0].position += impact::Vec3(0, 0, 1e-3 + 10 * events[0].position_error);
  };
  const auto turned = [](std::vector<PairEvent>& events, double) {
    if (!events.empty()) events[0].normal = -events[0].normal, events[0].closing_speed *= -1;
  };
  const auto known = [](const fuzz::Truth& t) { return t.transversal && t.point_known; };
  catchAll([&](const Case& c) { return std::make_unique<FromTheOracle>(c, moved); }, known);
  catchAll([&](const Case& c) { return std::make_unique<FromTheOracle>(c, turned); }, known);
}

}  // namespace
