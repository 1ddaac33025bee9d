/// Contacts carried across many pieces of one pair, poses of both tracks at stamps of their own: every shape
/// against every other, held against the march on every piece.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "collision_node/impact/convex/gjk.h"
#include "test/impact/claims.h"
#include "test/impact/fuzz_object.h"

namespace moving {
namespace {

namespace motion = collision_node::motion;
using motion::StampedPose;

constexpr std::uint64_t kSeed = 20261128;
constexpr int kMarchSteps = 100000;

struct Track {
  int model = 0;  ///< slerp, hermite, spin
  std::vector<StampedPose> poses;

  RigidMotion segmentAt(Nanoseconds from_ns) const {
    std::size_t i = 0;
    while (i + 2 < poses.size() && poses[i + 1].stamp_ns <= from_ns) ++i;
    const StampedPose &p = poses[i], &q = poses[i + 1];
    return model == 0 ? motion::straightSlerp(p, q) : model == 1 ? motion::hermite(p, q) : motion::spin(p, q);
  }
};

/// Sways to and fro by `sway` [m] and tumbles, with stamps that are as good as never those of the other.
Track makeTrack(Random& random, Nanoseconds start_ns, Nanoseconds end_ns, double period_ns, double sway,
                const Vec3& drift) {
  Track track;
  track.model = random.below(3);
  const double whole = 1e-9 * static_cast<double>(end_ns - start_ns), rate = random.decade(0.2, 1.4) / whole;
  const double phase = random.in(0, 6), turn = random.chance(0.5) ? random.in(0, 3) : random.decade(-3, 0);
  const double more = track.model == 2 && random.chance(0.5) ? random.in(0, 20) : 0.0;  // hidden turns [rad]
  const Vec3 one = sway * random.direction(), other = sway * random.direction();
  Quat orientation = random.orientation();
  auto stamp = start_ns - static_cast<Nanoseconds>(random.in(0, 1) * period_ns);
  for (bool is_over = false; !is_over;) {
    const double t = 1e-9 * static_cast<double>(stamp - start_ns);
    const double step_ns = period_ns * (random.chance(0.3) ? random.in(0.1, 1.5) : 1.0);
    const Vec3 axis = random.direction();
    StampedPose pose;
    pose.stamp_ns = stamp;
    pose.pose = {drift * t + std::sin(rate * t + phase) * one + std::cos(0.7 * rate * t) * other,
                 orientation};
    pose.has_twist = true;
    pose.linear = drift + rate * std::cos(rate * t + phase) * one;
    pose.angular = (turn + more) / (1e-9 * step_ns) * axis;
    motion::checkAndNormalise(pose);
    track.poses.push_back(pose);
    is_over = stamp > end_ns;
    orientation = (Quat(Eigen::AngleAxisd(turn, axis)) * orientation).normalized();
    stamp += 1 + static_cast<Nanoseconds>(step_ns);
  }
  return track;
}

struct Story {
  Shapes a, b;
  PairOptions options;
  std::vector<Piece> pieces;

  Nanoseconds start() const { return pieces.front().start_ns; }
  Real secondsTo(Nanoseconds stamp_ns) const { return 1e-9L * static_cast<Real>(stamp_ns - start()); }
};

Story makeStory(Random& random, fuzz::ShapeKind kind_a, fuzz::ShapeKind kind_b) {
  Story s;
  const double scale = random.chance(0.7) ? 1.0 : random.chance(0.5) ? 1e-6 : 1e6;
  const fuzz::Object a = fuzz::makeObject(random, kind_a, scale),
                     b = fuzz::makeObject(random, kind_b, scale * random.decade(-0.7, 0.5));
  s.a = a.shapes, s.b = b.shapes;
  const double reach = std::max(a.reach + b.reach, 0.1 * scale);
  if (random.chance(0.3)) s.options.contact_distance = random.decade(-4, -0.5) * reach;
  const double period_ns = random.decade(6, 8.5);
  const Nanoseconds start = 1'700'000'000'000'000'000,
                    end = start + static_cast<Nanoseconds>((3 + random.below(17)) * period_ns);
  const bool is_deep = random.chance(0.3);
  const double sway = (is_deep ? 0.02 : 1.0) * random.decade(-2, 0.1) * reach;
  const Vec3 drift =
      random.chance(0.3) ? Vec3(reach / (1e-9 * period_ns) * random.direction()) : Vec3::Zero();
  Track track_a = makeTrack(random, start, end, period_ns, 0.3 * sway, drift);
  Track track_b = makeTrack(random, start, end, period_ns * random.decade(-0.4, 0.6), sway, drift);
  // Two points of the bodies meet on the way, or nearly.
  const auto at = start + static_cast<Nanoseconds>(random.in(0.2, 0.8) * static_cast<double>(end - start));
  const oracle::Frame fa = oracle::Path(track_a.segmentAt(at), at, {}).at(0),
                      fb = oracle::Path(track_b.segmentAt(at), at, {}).at(0);
  const oracle::V3 shift = fa.place(oracle::exact(a.aim)) - fb.place(oracle::exact(b.aim));
  const Vec3 aside = is_deep ? Vec3::Zero() : Vec3(random.in(0, 0.4) * reach * random.direction());
  for (StampedPose& pose : track_b.poses)
    pose.pose.position += aside + Vec3(static_cast<double>(shift.x), static_cast<double>(shift.y),
                                       static_cast<double>(shift.z));
  std::set<Nanoseconds> stamps = {start, end};
  for (Track* track : {&track_a, &track_b}) {
    for (const StampedPose& pose : track->poses)
      if (pose.stamp_ns > start && pose.stamp_ns < end) stamps.insert(pose.stamp_ns);
  }
  for (auto from = stamps.begin(), to = std::next(from); to != stamps.end(); ++from, ++to)
    s.pieces.push_back({*from, *to, track_a.segmentAt(*from), track_b.segmentAt(*from)});
  return s;
}

/// What `events` say of each piece, against the march.
class Judge {
 public:
  Judge(const Story& story, const std::vector<PairEvent>& events) : story_(story) {
    std::vector<PairEvent> whole = events;  // with times from the first piece's start
    for (PairEvent& e : whole) {
      const double off = motion::secondsBetween(story.start(), e.interval_start_ns);
      e.toi_lower += off, e.toi_upper += off;
    }
    const double end = motion::secondsBetween(story.start(), story.pieces.back().end_ns);
    const std::vector<Claim> claims = claimsOf(whole, end);
    const Body a(story.a), b(story.b);
    for (const Piece& piece : story.pieces) {
      const oracle::Pair pair = oracle::makePair(story.a, story.b, piece.a, piece.b, piece.start_ns,
                                                 piece.end_ns, story.options.contact_distance);
      const double budget = PairPiece(a, b, piece, story.options.contact_distance).point_error;
      for (const Claim& claim : claims) {
        // A double that counts from the first piece's start is off by some of its steps.
        const Real off = story.secondsTo(piece.start_ns), rounding = 1e-15L * end;
        const Real from = std::max<Real>(0, claim.from + rounding - off),
                   to = std::min(pair.duration(), claim.to - rounding - off);
        if (!(from < to)) continue;
        if (claim.said == Said::kApart) isApart(pair, from, to, off);
        if (claim.said == Said::kTouching) touches(pair, budget, from, to, off);
      }
      for (const PairEvent& e : events) {
        if (e.interval_start_ns == piece.start_ns && e.certificate == Certificate::kConfirmed)
          changes(pair, budget, e);
      }
    }
  }

  int apart() const { return apart_; }
  int touching() const { return touching_; }
  int brackets() const { return brackets_; }

 private:
  void isApart(const oracle::Pair& pair, Real from, Real to, Real off) {
    ++apart_;
    if (!(pair.provedDistance(from) > 0)) return;  // at the end of a bracket, where rounding decides
    const oracle::FirstTouch touch = pair.firstTouch(from, to, 0, kMarchSteps);
    EXPECT_FALSE(touch.found && touch.verified)
        << "MISS: apart on (" << off + from << ", " << off + to << ") s, touching at " << off + touch.hi;
  }

  void touches(const oracle::Pair& pair, double budget, Real from, Real to, Real off) {
    ++touching_;
    constexpr int kLooks = 8;
    for (int i = 0; i <= kLooks; ++i) {
      const Real t = from + (to - from) * i / kLooks, d = pair.provedDistance(t);
      if (!(d > 1e3L * budget)) continue;
      const oracle::FirstTouch next = pair.firstTouch(t, to, 0, kMarchSteps);
      const Real until = next.found || next.gave_up ? next.lo : to;
      EXPECT_LE(until - t + d / pair.maxSpeed(), 4 * story_.options.time_precision)
          << "touching on (" << off + from << ", " << off + to << ") s, " << d << " m apart at " << off + t;
    }
  }

  /// Contact at one end of the bracket, and no wider than W where two part steeply.
  void changes(const oracle::Pair& pair, double budget, const PairEvent& e) {
    const Real lower = e.toi_lower, upper = e.toi_upper;
    if (!(upper < pair.duration())) return;
    ++brackets_;
    if (e.kind == Kind::kImpact) {
      const oracle::FirstTouch touch =
          pair.firstTouch(lower, upper + 1e-16L * pair.duration(), 0, kMarchSteps);
      EXPECT_TRUE(touch.found || touch.gave_up) << "no contact in the bracket of " << listOf({e});
    }
    if (e.kind != Kind::kSeparation || pair.hasPoint()) return;
    EXPECT_LE(pair.provedDistance(lower), (pair.hasTwoCylinders() ? 1e-11L : 1e-15L) * pair.scale())
        << "no contact at " << listOf({e});
    EXPECT_FALSE(pair.touching(upper + 1e-16L * pair.duration())) << "still touching after " << listOf({e});
    const Real step = upper - lower;
    if (pair.hasTwoCylinders() || !(step > 0) || !(upper + step < pair.duration())) return;
    const Real v = (pair.distance(upper + step) - pair.distance(upper)) / step;
    if (!(v > 1e-4L * pair.maxSpeed()) || !(v * v >= 1e4L * pair.maxAcceleration() * budget)) return;
    const Real width = std::max<Real>(story_.options.time_precision, 8 * budget / v);
    EXPECT_LE(step, 1.001L * width) << listOf({e});
  }

  const Story& story_;
  int apart_ = 0, touching_ = 0, brackets_ = 0;
};

TEST(CarriedContacts, AreWhatTheMarchFindsOnEveryPiece) {
  int pieces = 0, apart = 0, touching = 0, brackets = 0, carried = 0;
  for (int a = 0; a < fuzz::kShapeKinds; ++a) {
    for (int b = 0; b < fuzz::kShapeKinds; ++b) {
      Random random(kSeed, a * fuzz::kShapeKinds + b);
      const Story story = makeStory(random, static_cast<fuzz::ShapeKind>(a), static_cast<fuzz::ShapeKind>(b));
      Watched pair(story.a, story.b, story.options);
      for (const Piece& piece : story.pieces) {
        carried += pair.state.phase == PairState::Phase::kTouching;
        EXPECT_LE(pair.advance(piece).node_tests, story.options.node_budget);
      }
      pair.finish();
      SCOPED_TRACE(std::string(fuzz::toString(static_cast<fuzz::ShapeKind>(a))) + " - " +
                   fuzz::toString(static_cast<fuzz::ShapeKind>(b)) + ", " +
                   std::to_string(story.pieces.size()) + " pieces\n" + pair.list());
      const Judge judge(story, pair.events);
      pieces += static_cast<int>(story.pieces.size());
      apart += judge.apart(), touching += judge.touching(), brackets += judge.brackets();
      if (testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(carried, 600);
  EXPECT_GT(brackets, 150);
  std::printf("%d pieces, %d begun in contact; %d times apart, %d in contact, %d brackets\n", pieces, carried,
              apart, touching, brackets);
}

/// A box comes down to the contact distance and leaves again, one corner a hair beside the other box's.
TEST(CarriedContacts, ThatBeginAndEndWithACornerOverACornerDoSoWithinW) {
  Random random(kSeed, 1000);
  const PlacedShape box = placed(collision_node::geometry::Box{{1.0, 1.0, 1.0}});
  const Body body({box});
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    PairOptions options;
    options.contact_distance = random.decade(-5, -0.3);
    const Quat turn = random.orientation();
    const Vec3 low =
        turn * collision_node::impact::supportOf(body.primitive(0), turn.conjugate() * Vec3(0.0, 0.0, -1.0));
    const double speed = random.decade(-2, 0), beside = random.decade(-13, -6), depth = 0.01 * speed;
    const Vec3 at = Vec3(0.5, 0.5, 0.5) - low + beside * randomVec(random, 1.0);
    Watched pair({box}, {box}, options);
    for (int k = 0; k < 6; ++k) {  // down in three pieces, up in three
      const Nanoseconds from = k * kFrame, to = from + kFrame;
      const double h = 1e-9 * static_cast<double>(kFrame), way = k < 3 ? -speed : speed;
      const double height = speed * h * std::abs(3 - k) - depth + options.contact_distance;
      pair.advance(from, to, resting(),
                   flight(from, to, at + Vec3(0, 0, height), {0, 0, way}, Vec3::Zero(), turn));
    }
    ASSERT_EQ(pair.story(), kInAndOut) << pair.list();
    for (const PairEvent& e : pair.events)
      EXPECT_LE(widthOf(e), 1.001 * options.time_precision) << pair.list();
  }
}

}  // namespace
}  // namespace moving
