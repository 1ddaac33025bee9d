#include "collision_node/impact/piece_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "collision_node/impact/event_writer.h"

namespace collision_node::impact {
namespace {

using Phase = PairState::Phase;

/// Successive instants of a search behind a bracket's start. What rounding hides is up to six budgets wide;
/// with this overshoot the bracket stays within eight.
constexpr double kGrow = 1.3;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The state machine on one piece. Times are seconds from the piece's start.
class Run {
 public:
  Run(const PairPiece& pair, const Piece& piece, const PairOptions& options, Workspace& workspace,
      PairState& state, std::vector<PairEvent>& events)
      : pair_(pair),
        piece_(piece),
        options_(options),
        search_(pair, options.node_budget, workspace),
        writer_(pair, piece, options, search_),
        state_(state),
        events_(events),
        end_(pair.motion.duration()) {
    const double speed = std::max(pair.speed, 1e-300);
    // Refine the bracket until neither its width nor what it adds to the ball matters; the rounding budget is
    // the floor.
    floor_ = std::max(pair.point_error / speed, 64.0 * kUnit * end_);
    width_ = std::max(std::min(options.time_precision, 0.02 * options.distance_precision / speed), floor_);
  }

  PieceOutcome run() {
    const std::size_t before = events_.size();
    PieceOutcome outcome;
    if (search_.outOfReach()) {
      outcome.answer = Answer::kCulled;
      if (state_.phase == Phase::kNew) state_.phase = Phase::kApart;
      if (state_.phase == Phase::kApart) return outcome;
    }
    double t = 0.0;
    if (state_.phase == Phase::kNew) {
      start();
    } else if (state_.phase != Phase::kApart) {
      state_.pending_speed = std::max(state_.pending_speed, pair_.any_speed);
      state_.pending_spin = std::max(state_.pending_spin, pair_.motion.spinA() + pair_.motion.spinB());
    }
    std::optional<ContactWitness> witness;
    if (start_witness_) witness = std::move(start_witness_);
    while (true) {
      if (options_.scope == Scope::kFirstContact && events_.size() > before) break;
      if (search_.exhausted()) {
        stopForBudget(t);
        break;
      }
      if (state_.phase == Phase::kApart) {
        if (t >= end_) break;  // just proved
        const Search::First first = search_.firstPossible(t, end_, 0.1 * width_, 2.0 * width_);
        if (!first.found) break;
        free_since_ = t;
        open(Kind::kImpact, first.time, first.pair);
        t = first.time;
      } else if (state_.phase == Phase::kUndecided) {
        if (!resolve(t, witness)) break;
      } else {
        if (!follow(t, witness)) break;
      }
    }
    outcome.node_tests = search_.nodeTests();
    outcome.subdivisions = search_.subdivisions();
    outcome.budget_met = search_.exhausted();
    outcome.answer = state_.phase == Phase::kUndecided                             ? Answer::kUndecided
                     : state_.phase == Phase::kTouching || events_.size() > before ? Answer::kImpact
                                                                                   : Answer::kClear;
    for (std::size_t i = before; i < events_.size(); ++i) {
      if (events_[i].certificate == Certificate::kPossible) outcome.answer = Answer::kUndecided;
    }
    return outcome;
  }

 private:
  /// A pair's first instant: overlapping, apart, or not known.
  void start() {
    ContactWitness witness;
    switch (search_.classify(0.0, &witness, end_)) {
      case Proved::kApart:
        state_.phase = Phase::kApart;
        return;
      case Proved::kContact:
        beginOverlap(0.0, witness);
        start_witness_ = std::move(witness);
        return;
      case Proved::kNothing:
        open(Kind::kInitialOverlap, 0.0, writer_.anyNear(0.0, 0.0));
        return;
    }
  }

  /// Contact is proved at `t`, and nothing is known of how it began.
  void beginOverlap(double t, const ContactWitness& witness) {
    PairEvent event = writer_.stamped(Kind::kInitialOverlap, t);
    writer_.fill(event, describeOverlap(pair_, pair_.at(t), witness), t, t);
    event.certificate = Certificate::kConfirmed;
    event.reason = Reason::kNone;
    events_.push_back(event);
    state_.phase = Phase::kTouching;
    state_.contact = event;
  }

  /// Opens a bracket at `t`: contact is possible from here on.
  void open(Kind kind, double t, ElementPair pair) {
    state_.phase = Phase::kUndecided;
    state_.was_touching = kind == Kind::kSeparation;
    state_.published = false;
    state_.pending = writer_.stamped(kind, t);
    state_.pending_speed = pair_.any_speed;
    state_.pending_spin = pair_.motion.spinA() + pair_.motion.spinB();
    opened_ = pair;
  }

  /// Behind the start of an open bracket: finds what is proved first, contact or clearance. Returns false at
  /// the end.
  bool resolve(double& t, std::optional<ContactWitness>& witness) {
    const double from = t;
    const bool carried = state_.pending.interval_start_ns != piece_.start_ns;
    double proved_nothing = from;  // the last instant at which nothing was proved
    ContactWitness found;
    const PathContact* met = carried || state_.was_touching ? nullptr : search_.provedAt(from);
    if (met != nullptr && closeStraight(*met, witness)) {
      t = met->upper;
      return true;
    }
    bool small = carried;  // start from the smallest step: something may be decided at once
    double step = small ? floor_ : 0.5 * width_;
    while (true) {
      if (search_.exhausted()) return true;
      const double at = std::min(end_, from + step);
      // Most often the pair that could not be proved apart is the one that touches.
      Proved proved = Proved::kNothing;
      if (opened_.a >= 0) proved = search_.classifyPair(at, opened_, &found);
      if (proved != Proved::kContact) proved = search_.classify(at, &found, end_);
      if (proved == Proved::kContact) {
        confirm(from, at, found, witness);
        t = at;
        return true;
      }
      if (proved == Proved::kApart && !(from >= end_)) {
        if (passed(from, at, t)) return true;
        if (!small && floor_ < 0.5 * step) {  // too far at once: look into what was skipped
          small = true;
          step = floor_;
          continue;
        }
        if (inBetween(proved_nothing, at, found)) {
          confirm(from, found_at_, found, witness);
          t = found_at_;
          return true;
        }
        if (search_.nearPairs(from, at, 1).empty() && !search_.exhausted() &&
            !carried) {  // a second look proves the bracket free
          state_.phase = Phase::kApart;
          t = at;
          return true;
        }
        const Search::First next = search_.firstPossible(at, end_, 0.1 * width_);
        if (next.found && next.time - at <= std::max(at - from, width_) && next.time < end_) {
          step = std::max(next.time - from,
                          step * kGrow);  // a gap shorter than the bracket: the bracket goes on
          proved_nothing = next.time;
          continue;
        }
        publishPossible(at, true);
        state_.phase = Phase::kApart;
        t = at;
        return true;
      }
      if (at >= end_) return waitForMore();
      proved_nothing = at;
      step *= kGrow;
    }
  }

  /// The bracket's search has proved the contact itself. False where it is not known what comes behind it.
  bool closeStraight(const PathContact& met, std::optional<ContactWitness>& witness) {
    const StraightPath& path = *search_.straight();
    const bool whole = options_.scope == Scope::kWholePiece;
    const Phase next = behind(path, met);
    if (next == Phase::kUndecided) return false;
    PairEvent event = state_.pending;
    event.kind = Kind::kImpact;
    writer_.finishStraight(event, path, met);
    event.certificate = Certificate::kConfirmed;
    event.reason =
        event.toi_upper - event.toi_lower > options_.time_precision ? Reason::kPrecision : Reason::kNone;
    events_.push_back(event);
    state_.contact = event;
    state_.phase = next;
    if (next == Phase::kApart) {
      event.kind = Kind::kSeparation;
      events_.push_back(event);
    } else if (path.radius() == 0.0) {
      witness.emplace();  // held by the solid
      witness->point = event.position - pair_.motion.poseA(event.toi_lower).position;
    } else if (whole) {
      ContactWitness found;
      found.element_a = opened_.a;
      found.element_b = opened_.b;
      Vec3 buffer_a[3], buffer_b[3];
      const Element a = pair_.a.element(opened_.a, buffer_a), b = pair_.b.element(opened_.b, buffer_b);
      const Instant now = pair_.at(met.upper);
      if (touchesAt(pair_, now, a, b, closestPoints(Cores(now, a, b), Vec3::Zero()), found)) witness = found;
    }
    return true;
  }

  /// What a pair that was apart is, behind a contact on a straight path: a sphere touches; a point is inside
  /// what it went into if that is solid, and apart again if that is a surface. Through several solids at
  /// once: not known.
  Phase behind(const StraightPath& path, const PathContact& met) const {
    if (path.radius() > 0.0) return Phase::kTouching;
    const Body& body = path.pointIsA() ? pair_.b : pair_.a;
    const auto into_solid = [&](const PathContact::Met& one) {
      const std::vector<int>& solids = body.solids();
      return std::find(solids.begin(), solids.end(), body.shapeOf(one.element)) != solids.end();
    };
    if (std::none_of(met.met, met.met + met.count, into_solid)) return Phase::kApart;
    return met.count == 1 && met.met[0].sure ? Phase::kTouching : Phase::kUndecided;
  }

  /// The piece ends inside an open bracket. One that has been open for a whole piece is published and holds
  /// up nothing.
  bool waitForMore() {
    const bool carried = state_.pending.interval_start_ns != piece_.start_ns;
    if (carried && !state_.published) giveUp();
    return false;
  }

  /// Contact is proved at `at`: closes the open bracket as CONFIRMED.
  void confirm(double from, double at, const ContactWitness& found, std::optional<ContactWitness>& witness) {
    witness = found;
    if (state_.was_touching) {  // it never parted, as far as anybody can prove
      state_.phase = Phase::kTouching;
      return;
    }
    if (state_
            .published) {  // the onset is an open question already published: what is proved is contact, here
      beginOverlap(at, found);
      return;
    }
    ElementPair pair{found.element_a, found.element_b};
    const bool sure_of_pair = pair.a >= 0;
    if (!sure_of_pair) pair = opened_.a >= 0 ? opened_ : writer_.anyNear(from, at);
    PairEvent event = state_.pending;
    event.kind = Kind::kImpact;
    writer_.finishImpact(event, from, at, pair, state_, sure_of_pair);
    event.certificate = Certificate::kConfirmed;
    event.reason =
        event.toi_upper - event.toi_lower > options_.time_precision ? Reason::kPrecision : Reason::kNone;
    events_.push_back(event);
    state_.contact = event;
    state_.phase = Phase::kTouching;
  }

  /// Contact at a few instants strictly between two?
  bool inBetween(double low, double high, ContactWitness& found) {
    constexpr int kLooks = 7;
    for (int i = 1; i <= kLooks; ++i) {
      const double at = low + (high - low) * i / (kLooks + 1);
      if (at <= low || at >= high) continue;
      if (search_.classify(at, &found, end_) == Proved::kContact) {
        found_at_ = at;
        return true;
      }
    }
    return false;
  }

  /// A point went through a surface between the two instants: an impact and its separation in one bracket.
  /// Seen from a little earlier and, where it fails, a little later: what is proved apart around the bracket
  /// holds no contact, so a passage of all that time is one of the bracket.
  bool passed(double from, double at, double& t) {
    if (state_.was_touching || pair_.contact_distance > 0.0) return false;
    const std::vector<ElementPair> near = search_.nearPairs(from, at, 64);
    const double earlier = std::max(std::min(free_since_, from), from - std::max(at - from, 32.0 * floor_));
    const Instant first = pair_.at(earlier);
    for (const double more : {0.0, 1.0, 4.0, 16.0}) {
      const double later = std::min(end_, at + more * (at - earlier));
      if (more > 0.0 && (!(later > at) || search_.firstPossible(at, later, 0.1 * width_).found)) return false;
      for (const ElementPair& pair : near) {
        if (!passesBetween(first, pair_.at(later), near, pair)) continue;
        PairEvent event = state_.pending;
        event.kind = Kind::kImpact;
        writer_.finishImpact(event, from, at, pair, state_);
        event.certificate = Certificate::kConfirmed;
        event.reason = Reason::kNone;
        events_.push_back(event);
        state_.contact = event;
        event.kind = Kind::kSeparation;
        events_.push_back(event);
        state_.phase = Phase::kApart;
        t = at;
        return true;
      }
    }
    return false;
  }

  /// Whether the pair is a point that passes through the other's triangle, or through those around it.
  bool passesBetween(const Instant& first, const Instant& last, const std::vector<ElementPair>& near,
                     ElementPair pair) const {
    Vec3 buffer_a[3], buffer_b[3];
    const Element a = pair_.a.element(pair.a, buffer_a), b = pair_.b.element(pair.b, buffer_b);
    const bool point_is_a = a.count == 1 && b.triangle >= 0, point_is_b = b.count == 1 && a.triangle >= 0;
    if (!(point_is_a || point_is_b) || a.radius + b.radius > 0.0) return false;
    const Element& triangle = point_is_a ? b : a;
    const Vec3 point = point_is_a ? a.vertices[0] : b.vertices[0];
    const std::array<Vec3, 3> corners = {triangle.vertices[0], triangle.vertices[1], triangle.vertices[2]};
    if (passesThrough(pair_, first, last, point_is_a, point, {corners})) return true;
    const auto patch = patchAround(near, pair, point_is_a, triangle.shape);  // through an edge or a vertex
    return passesThrough(pair_, first, last, point_is_a, point, patch);
  }

  /// The triangles of one mesh among the near pairs of the same point.
  std::vector<std::array<Vec3, 3>> patchAround(const std::vector<ElementPair>& near, ElementPair pair,
                                               bool point_is_a, int shape) const {
    std::vector<std::array<Vec3, 3>> patch;
    for (const ElementPair& other : near) {
      if (point_is_a ? other.a != pair.a : other.b != pair.b) continue;
      Vec3 buffer[3];
      const Element e = point_is_a ? pair_.b.element(other.b, buffer) : pair_.a.element(other.a, buffer);
      if (e.triangle >= 0 && e.shape == shape) patch.push_back({e.vertices[0], e.vertices[1], e.vertices[2]});
    }
    return patch;
  }

  /// In contact at `t`: follows the proof forward, and where it ends looks for the next one or for clearance.
  bool follow(double& t, std::optional<ContactWitness>& witness) {
    double look = floor_;
    double proved = t;  // contact is proved up to here
    if (!witness) {     // a new piece: the last one's contact still has to be found in this one
      ContactWitness found;
      const Proved now = search_.classify(t, &found, end_);
      if (now == Proved::kContact) witness = std::move(found);
      if (now == Proved::kApart) {
        openSeparation(t);
        publishSeparation(t);
        return true;
      }
    }
    while (t < end_) {
      if (search_.exhausted()) return true;
      if (witness) {
        persist(t, *witness);
        proved = t;
        last_witness_ = *witness;
        witness.reset();
        look = floor_;
        if (t >= end_) break;
      }
      const double at = std::min(end_, proved + look);
      ContactWitness found;
      const Proved now = search_.classify(at, &found, end_ - at);
      if (now == Proved::kContact) {
        t = at;
        witness = std::move(found);
        continue;
      }
      if (now == Proved::kApart) {
        const Search::First next = search_.firstPossible(at, end_, 0.1 * width_);
        const bool owed = !next.found || next.time - at > at - proved;
        if (owed) {
          openSeparation(proved);
          publishSeparation(at);
          t = at;
          return true;
        }
        look = std::max(next.time - proved, look * kGrow);
      } else {
        look *= kGrow;
      }
      if (at >= end_) {
        openSeparation(proved);
        state_.phase = Phase::kUndecided;
        return waitForMore();
      }
    }
    openSeparation(proved);  // where the next piece would begin to look
    state_.phase = Phase::kTouching;
    return false;
  }

  /// Moves t forward as long as this witness proves contact.
  void persist(double& t, ContactWitness& witness) {
    if (witness.element_a < 0) {  // one body inside the other: until surfaces can meet
      const Search::First first = search_.firstPossible(t, end_, 0.1 * width_);
      t = first.found ? std::max(t, first.time) : end_;
      return;
    }
    Vec3 buffer_a[3], buffer_b[3];
    const Element a = pair_.a.element(witness.element_a, buffer_a),
                  b = pair_.b.element(witness.element_b, buffer_b);
    double step = end_ - t;
    Instant now = pair_.at(t);
    const auto renew = [&](double from_depth) {
      ContactWitness fresh;
      fresh.shrunk = from_depth;
      if (!touchesAt(pair_, now, a, b, closestPoints(Cores(now, a, b), Vec3::Zero()), fresh)) return;
      fresh.element_a = witness.element_a;
      fresh.element_b = witness.element_b;
      witness = std::move(fresh);
    };
    if (witness.shrunk > 0.0) renew(kInfinity);
    while (t < end_ && !search_.exhausted()) {
      const double next = std::min(end_, t + step);
      const Instant later = pair_.at(next);
      search_.countTest();
      if (next > t && touchesThrough(pair_, now, later, a, b, witness)) {
        t = next;
        now = later;
        renew(witness.shrunk);
        step *= 2.0;
      } else {
        step *= 0.25;
        if (step < floor_) return;
      }
    }
  }

  void openSeparation(double t) {
    const PairEvent contact = state_.contact;
    open(Kind::kSeparation, t, {last_witness_.element_a, last_witness_.element_b});
    state_.contact = contact;
  }

  /// Closes a separation's bracket at `at`. `apart`: proved there, else the question stays open.
  void publishSeparation(double at, bool apart = true) {
    PairEvent event = state_.pending;
    const double from = std::max(0.0, writer_.localStart(event));
    ElementPair pair = opened_;
    if (pair.a < 0) pair = writer_.anyNear(from, at);
    writer_.finishSeparation(event, from, at, pair, state_, opened_.a >= 0);
    const bool sure = apart && state_.contact.certificate == Certificate::kConfirmed;
    event.certificate = sure ? Certificate::kConfirmed : Certificate::kPossible;
    event.reason = search_.exhausted()                                           ? Reason::kBudget
                   : !sure                                                       ? Reason::kGrazing
                   : event.toi_upper - event.toi_lower > options_.time_precision ? Reason::kPrecision
                                                                                 : Reason::kNone;
    events_.push_back(event);
    state_.phase = Phase::kApart;
    state_.was_touching = false;
  }

  /// Closes the open bracket at `at`, where the pair is proved apart again or the data end, without a proof
  /// of contact.
  void publishPossible(double at, bool proved_apart = false) {
    if (state_.was_touching) {
      publishSeparation(at, proved_apart);
      return;
    }
    if (state_.published) return;
    PairEvent event = state_.pending;
    const double from = std::max(0.0, writer_.localStart(event));
    const ElementPair pair = opened_.a >= 0 ? opened_ : writer_.anyNear(from, at);
    writer_.finishImpact(event, from, at, pair, state_, opened_.a >= 0);
    if (event.kind == Kind::kInitialOverlap) {
      event.normal = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
      event.normal_error = M_PI;
      event.closing_speed = event.normal.x();
    }
    event.certificate = Certificate::kPossible;
    event.reason = search_.exhausted() ? Reason::kBudget : Reason::kGrazing;
    events_.push_back(event);
  }

  /// The node budget is spent: everything from `t` on is one open question.
  void stopForBudget(double t) {
    if (state_.phase == Phase::kApart) open(Kind::kImpact, t, {});
    if (state_.phase == Phase::kTouching) openSeparation(t);
    if (state_.pending.kind == Kind::kInitialOverlap)
      state_.pending.kind = Kind::kImpact;  // all of it is open
    if (!state_.published) giveUp();
  }

  /// Publishes the open bracket as POSSIBLE up to the piece's end. It holds nothing up any more; the pair is
  /// neither in contact nor apart until one of them is proved.
  void giveUp() {
    publishPossible(end_);
    state_.phase = Phase::kUndecided;
    state_.was_touching = false;
    state_.published = true;
  }

  const PairPiece& pair_;
  const Piece& piece_;
  const PairOptions& options_;
  Search search_;
  EventWriter writer_;
  PairState& state_;
  std::vector<PairEvent>& events_;
  const double end_;
  double floor_, width_;
  ElementPair opened_;
  ContactWitness last_witness_;
  std::optional<ContactWitness> start_witness_;
  double found_at_ = 0.0;
  double free_since_ = kInfinity;  ///< the search that opened the bracket proved the time since then free
};

}  // namespace

PieceOutcome runPiece(const PairPiece& pair, const Piece& piece, const PairOptions& options,
                      Workspace& workspace, PairState& state, std::vector<PairEvent>& events) {
  return Run(pair, piece, options, workspace, state, events).run();
}

}  // namespace collision_node::impact
