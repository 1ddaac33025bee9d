#include "test/impact/fuzz_check.h"

#include <chrono>

#include "test/impact/fuzz_facts.h"
#include "test/impact/fuzz_shapes.h"

namespace fuzz {

namespace impact = collision_node::impact;
namespace motion = collision_node::motion;
using impact::Certificate;
using impact::Kind;
using impact::PairEvent;
using oracle::Pair;
using oracle::Real;
using oracle::V3;

namespace {

/// One run of a method on a case, and the complaints about it.
class Examination {
 public:
  Examination(const Case& c, const Pair& pair, const Truth& truth)
      : case_(c), pair_(pair), truth_(truth), random_(c.seed ^ 0x5eed, c.index) {}

  void run(const impact::PairMethod& method) {
    outcome_ = method.advance(case_.piece, state_, events_);
    method.finish(state_, events_);
  }

  void examine() {
    if (!wellFormed()) return;
    start();
    if (truth_.well_apart) farApart();
    if (truth_.apart_at_start && !truth_.well_apart) firstContact();
    sequence();
  }

  const std::vector<PairEvent>& events() const { return events_; }
  const impact::PieceOutcome& outcome() const { return outcome_; }
  const std::vector<std::string>& complaints() const { return complaints_; }
  int gaveUp() const { return gave_up_; }
  bool pointChecked() const { return point_checked_; }
  bool normalChecked() const { return normal_checked_; }
  bool confirmedFirst() const { return confirmed_first_; }  ///< the first contact, transversal
  Real sharpest() const { return sharpest_; }               ///< error of a sharp instant, in steps; -1 none

 private:
  template <class... Arguments>
  void complain(const char* format, Arguments... arguments) {
    complaints_.push_back(text(format, arguments...));
  }

  bool wellFormed() {
    const double end = case_.duration();
    bool touching = false;
    double last = 0;
    for (const PairEvent& e : events_) {
      const char* kind = toString(e.kind);
      if (!(e.toi_lower >= 0 && e.toi_lower <= e.toi_upper && e.toi_upper <= end * (1 + 1e-15))) {
        complain("%s bracket [%.17g, %.17g] is not within [0, %.17g]", kind, e.toi_lower, e.toi_upper, end);
      }
      if (e.interval_start_ns != case_.piece.start_ns || e.interval_end_ns != case_.piece.end_ns) {
        complain("%s names another piece", kind);
      }
      if (e.toi_lower < last) complain("%s at %.17g comes after one at %.17g", kind, e.toi_lower, last);
      last = e.toi_lower;
      if (e.certificate == Certificate::kUncertified) complain("%s is UNCERTIFIED", kind);
      if (e.certificate != Certificate::kConfirmed) continue;
      if ((e.kind == Kind::kSeparation) != touching)
        complain("%s while %s", kind, touching ? "touching" : "apart");
      if (e.kind == Kind::kInitialOverlap && (&e != &events_.front() || e.toi_upper != 0)) {
        complain("INITIAL_OVERLAP must come first, with times 0; toi_upper %.17g", e.toi_upper);
      }
      touching = e.kind != Kind::kSeparation;
    }
    return complaints_.empty();
  }

  void start() {
    const bool said = !events_.empty() && events_[0].kind == Kind::kInitialOverlap;
    if (truth_.overlaps_at_start && !(said && events_[0].certificate == Certificate::kConfirmed)) {
      // On the very boundary either answer is right.
      const bool deep = truth_.overlaps_deeply;
      if (deep && (events_.empty() || events_[0].toi_lower > 0))
        complain("overlaps at the start, and no event says so");
      else if (deep && !said)
        complain("overlaps at the start, first event is %s", toString(events_[0].kind));
    }
    if (truth_.apart_at_start && said) {
      complain("INITIAL_OVERLAP, but the distance at the start is %.6Lg m", pair_.distance(0));
    }
  }

  void farApart() {
    if (!events_.empty())
      complain("well apart, yet %zu events, first a %s", events_.size(), toString(events_[0].kind));
    if (outcome_.answer != impact::Answer::kClear && outcome_.answer != impact::Answer::kCulled) {
      complain("well apart, yet the answer is %d", static_cast<int>(outcome_.answer));
    }
  }

  void firstContact() {
    const oracle::FirstTouch& touch = truth_.first;
    if (touch.gave_up) {
      ++gave_up_;
      return;
    }
    if (!touch.found) {
      for (const PairEvent& e : events_) {
        if (e.certificate == Certificate::kConfirmed)
          complain("%s CONFIRMED at %.17g, but they never touch", toString(e.kind), e.toi_lower);
      }
      return;
    }
    if (events_.empty()) {
      if (touch.verified) complain("MISS: touching at [%.17Lg, %.17Lg] s, no event", touch.lo, touch.hi);
      return;
    }
    // A near miss just before may stay undecided; `possible` looks at how near it was.
    const auto passed = [&](const PairEvent& e) {
      return e.certificate == Certificate::kPossible && e.toi_upper < touch.lo;
    };
    const auto at = std::find_if_not(events_.begin(), events_.end(), passed);
    if (at == events_.end()) {
      if (touch.verified)
        complain("MISS: touching at [%.17Lg, %.17Lg] s, only POSSIBLE before", touch.lo, touch.hi);
      return;
    }
    const PairEvent& e = *at;
    const Real slack = 1e-18L * pair_.duration() +
                       (truth_.closing_speed > 0 ? 2 * pair_.touchDistance() / truth_.closing_speed : 0);
    if (touch.verified && e.toi_lower > touch.hi + slack) {
      complain("LATE: touching by %.20Lg s, toi_lower %.20Lg s", touch.hi, static_cast<Real>(e.toi_lower));
    }
    if (touch.verified && e.toi_upper < touch.lo - slack) {
      complain("the first bracket ends at %.20Lg s, apart until %.20Lg s", static_cast<Real>(e.toi_upper),
               touch.lo);
    }
    if (!truth_.transversal) return;
    if (e.kind != Kind::kImpact) complain("first event is %s, wanted IMPACT", toString(e.kind));
    if (e.certificate != Certificate::kConfirmed) {
      complain("transversal hit at %.17Lg s (v_n %.3Lg m/s) is %s [%.17g, %.17g], reason %s", touch.lo,
               truth_.closing_speed, toString(e.certificate), e.toi_lower, e.toi_upper, toString(e.reason));
      return;
    }
    if (e.toi_upper - e.toi_lower > truth_.width * (1 + 1e-6L)) {
      complain("bracket of %.6g s at a transversal hit, W is %.6Lg s", e.toi_upper - e.toi_lower,
               truth_.width);
    }
    confirmed_first_ = true;
    const Facts facts = checkFacts(case_, pair_, truth_, e, complaints_);
    point_checked_ = facts.point;
    normal_checked_ = facts.normal;
    sharp(e);
  }

  /// Where W allows it the instant itself is known to 1e-12 of the step. Of two cylinders the oracle does not
  /// always know it as well.
  void sharp(const PairEvent& e) {
    const Real step = pair_.duration();
    if (truth_.width > 1e-12L * step || truth_.first.hi - truth_.first.lo > 1e-13L * step) return;
    const Real off = std::max(truth_.first.hi - e.toi_lower, e.toi_upper - truth_.first.lo);
    sharpest_ = off / step;
    if (off > 1e-12L * step) complain("the instant is off by %.3Lg of the step", off / step);
  }

  /// Free where said to be free (by the march), touching where said to touch (by samples).
  void sequence() {
    const Real end = pair_.duration();
    Real since = 0;  // of the current claim
    bool touching = false;
    const PairEvent* before = nullptr;
    for (const PairEvent& e : events_) {
      const Real lower = e.toi_lower, upper = std::min<Real>(e.toi_upper, end);
      if (e.kind != Kind::kInitialOverlap) touching ? touches(since, lower) : free(since, lower);
      if (e.certificate == Certificate::kPossible)
        possible(e);
      else if (e.kind == Kind::kImpact)
        impactIsReal(lower, upper);
      else if (e.kind == Kind::kSeparation)
        separationIsReal(lower, upper, before && before->toi_lower == e.toi_lower);
      if (e.certificate == Certificate::kConfirmed) touching = e.kind != Kind::kSeparation;
      since = std::max(since, upper);
      before = &e;
      if (!complaints_.empty()) return;
    }
    if (since >= end * (1 - 1e-15L)) return;  // up to the piece's end as a double
    touching ? touches(since, end) : free(since, end);
  }

  void free(Real from, Real to) {
    if (!(from < to) || (truth_.well_apart) || (from == 0 && !truth_.apart_at_start)) return;
    if (from == 0 && truth_.first.gave_up) return;
    // The first contact is already known.
    const oracle::FirstTouch touch = from == 0 ? truth_.first : pair_.firstTouch(from, to, 0, kMarchSteps);
    gave_up_ += touch.gave_up;
    if (touch.found && touch.verified && touch.hi < to - 1e-17L * pair_.duration()) {
      complain("said to be apart on (%.17Lg, %.17Lg) s, touching at %.17Lg s", from, to, touch.hi);
    }
  }

  void touches(Real from, Real to) {
    if (!(from < to)) return;
    std::vector<Real> instants;
    for (int i = 0; i < 16; ++i)
      instants.push_back(from + (to - from) * (i + static_cast<Real>(random_.unit())) / 16);
    for (Real part = 1e-9L; part < 1e-2L; part *= 100) {
      instants.push_back(from + part * (to - from));
      instants.push_back(to - part * (to - from));
    }
    if (to == pair_.duration()) instants.push_back(to);
    for (Real t : instants) {
      const Real d = pair_.provedDistance(t);
      if (!(d > 1e3L * truth_.budget)) continue;
      // A free time shorter than W may be merged; this one is measured.
      const oracle::FirstTouch next = pair_.firstTouch(t, to, 0, kMarchSteps);
      const Real until = next.found || next.gave_up ? next.lo : to;
      if (until - t + d / pair_.maxSpeed() > 4 * case_.options.time_precision) {
        complain("said to touch on [%.17Lg, %.17Lg] s, apart by %.6Lg m at %.17Lg s, free until %.17Lg s",
                 from, to, d, t, until);
        return;
      }
    }
  }

  void impactIsReal(Real lower, Real upper) {
    const oracle::FirstTouch touch =
        pair_.firstTouch(lower, upper + 1e-16L * pair_.duration(), 0, kMarchSteps);
    gave_up_ += touch.gave_up;
    if (!touch.found && !touch.gave_up) {
      complain("IMPACT CONFIRMED on [%.20Lg, %.20Lg] s, no contact there; distances %.3Lg and %.3Lg m", lower,
               upper, pair_.distance(lower), pair_.distance(upper));
    }
  }

  /// `with_impact`: in one bracket with its impact, as a point through a surface; contact is then somewhere
  /// inside.
  void separationIsReal(Real lower, Real upper, bool with_impact) {
    const Real tolerance = (pair_.hasTwoCylinders() ? 1e-11L : 1e-15L) * pair_.scale();
    if (!(with_impact && pair_.hasPoint()) && pair_.provedDistance(lower) > tolerance) {
      complain("SEPARATION says contact at %.20Lg s, apart there by %.6Lg m", lower, pair_.distance(lower));
    }
    if (upper < pair_.duration() && pair_.touching(upper + 1e-16L * pair_.duration())) {
      complain("SEPARATION says apart after %.20Lg s, they touch there", upper);
    }
    // Width, where the parting is as steep as a transversal hit.
    const Real step = upper - lower;
    if (!(step > 0)) return;
    if (upper + step > pair_.duration()) return;
    const Real v = (pair_.distance(upper + step) - pair_.distance(upper)) / step;
    const Real width = std::max<Real>(case_.options.time_precision, 8 * truth_.budget / std::max(v, 1e-300L));
    const bool steep =
        v > 1e-4L * pair_.maxSpeed() && v * v >= 1e4L * pair_.maxAcceleration() * truth_.budget;
    // Two cylinders' distance is too rough to tell a speed from.
    if (steep && !pair_.hasTwoCylinders() && upper - lower > width * (1 + 1e-3L)) {
      complain("SEPARATION bracket of %.6Lg s at a steep parting (%.3Lg m/s), W is %.6Lg s", upper - lower, v,
               width);
    }
  }

  /// Undecided is for what is hard to decide.
  void possible(const PairEvent& e) {
    const Real width = e.toi_upper - e.toi_lower;
    if (e.reason == impact::Reason::kBudget) return;
    const Real moved = pair_.maxSpeed() * std::min<Real>(width, 4 * case_.options.time_precision);
    for (int i = 0; i <= 8; ++i) {
      const Real t = e.toi_lower + width * i / 8, d = pair_.provedDistance(t);
      if (d > 1e-3L * pair_.size() + 1e3L * truth_.budget + moved) {
        complain("%s POSSIBLE on [%.17g, %.17g] s, reason %s, but %.3Lg m apart at %.17Lg s",
                 toString(e.kind), e.toi_lower, e.toi_upper, toString(e.reason), d, t);
        return;
      }
    }
  }

  const Case& case_;
  const Pair& pair_;
  const Truth& truth_;
  Random random_;
  impact::PairState state_;
  std::vector<PairEvent> events_;
  impact::PieceOutcome outcome_;
  std::vector<std::string> complaints_;
  int gave_up_ = 0;
  bool point_checked_ = false, normal_checked_ = false;
  Real sharpest_ = -1;
  bool confirmed_first_ = false;
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::vector<std::string> check(const Case& c, const impact::PairMethod& method, Tally* tally) {
  const double t0 = seconds();
  const Pair pair = c.pair();
  const Truth truth = truthOf(c, pair);
  Examination examination(c, pair, truth);
  const double t1 = seconds();
  examination.run(method);
  const double t2 = seconds();
  examination.examine();
  if (!tally) return examination.complaints();

  const auto& events = examination.events();
  tally->oracle_seconds += t1 - t0 + seconds() - t2;
  tally->method_seconds += t2 - t1;
  ++tally->cases;
  tally->touching += truth.overlaps_at_start || truth.first.found;
  tally->initial_overlaps += truth.overlaps_at_start;
  tally->transversal += truth.transversal;
  tally->well_apart += truth.well_apart;
  tally->events += static_cast<int>(events.size());
  tally->gave_up += examination.gaveUp() > 0;
  tally->points_checked += examination.pointChecked();
  tally->normals_checked += examination.normalChecked();
  tally->most_node_tests = std::max(tally->most_node_tests, examination.outcome().node_tests);
  tally->confirmed_first += examination.confirmedFirst();
  tally->sharp += examination.sharpest() >= 0;
  tally->worst_sharp = std::max(tally->worst_sharp, static_cast<double>(examination.sharpest()));
  // The pair's own question; that one of many later changes of contact grazes is counted below.
  const bool open = examination.outcome().budget_met ||
                    (!events.empty() && events[0].certificate == Certificate::kPossible);
  const bool two_points = pair.a().only_points && pair.b().only_points;
  const bool rounding_only =
      pair.provedDistance(0) + pair.maxSpeed() * pair.duration() <= 1e3L * truth.budget;
  tally->unprovable += open && (two_points || rounding_only);
  if (open) tally->undecided.push_back({c.index, c.kind, examination.outcome().budget_met});
  tally->with_possible += std::any_of(events.begin(), events.end(), [](const PairEvent& e) {
    return e.certificate == Certificate::kPossible;
  });
  if (truth.transversal && !events.empty() && events[0].certificate == Certificate::kConfirmed) {
    const PairEvent& e = events[0];
    tally->worst_width =
        std::max(tally->worst_width, static_cast<double>((e.toi_upper - e.toi_lower) / truth.width));
    tally->worst_early =
        std::max(tally->worst_early, static_cast<double>((truth.first.lo - e.toi_lower) / truth.width));
    if (examination.pointChecked()) tally->worst_ball = std::max(tally->worst_ball, e.position_error);
  }
  return examination.complaints();
}

}  // namespace fuzz
