#include <algorithm>
#include <optional>
#include <vector>

#include "collision_node/report/methods/own_methods.h"
#include "collision_node/report/methods/peer_models.h"
#include "collision_node/report/methods/static_test.h"

namespace collision_node::report {
namespace {

using geometry::Vec3;
using impact::PairEvent;

/// The paper's method of a set's pairs, made when first asked for.
class PaperMethods {
 public:
  PaperMethods(const QuerySet& set, impact::MethodName name) : set_(set), name_(name) {}

  std::optional<PairEvent> firstEvent(const Query& query, const impact::Piece& piece) {
    auto& method = methodOf(query);
    impact::PairState state;
    events_.clear();
    method.advance(piece, state, events_);
    if (events_.empty()) return std::nullopt;
    return events_.front();
  }

 private:
  struct Made {
    std::uint32_t a, b;
    std::unique_ptr<impact::PairMethod> method;
  };

  impact::PairMethod& methodOf(const Query& query) {
    const auto same = [&query](const Made& made) { return made.a == query.a && made.b == query.b; };
    auto found = std::find_if(made_.begin(), made_.end(), same);
    if (found == made_.end()) {
      auto method = makeMethod(name_, *set_.bodies[query.a], *set_.bodies[query.b], impact::PairOptions());
      found = made_.insert(made_.end(), {query.a, query.b, std::move(method)});
    }
    return *found->method;
  }

  const QuerySet& set_;
  impact::MethodName name_;
  std::vector<Made> made_;
  std::vector<PairEvent> events_;
};

Answer answerOf(const PairEvent& event) {
  Answer answer = hitAt(event.toi_lower);
  answer.point = event.position;
  answer.closing_speed = event.closing_speed;
  return answer;
}

class Paper : public Contestant {
 public:
  Paper(const QuerySet& set, impact::MethodName name) : methods_(set, name), name_(toString(name)) {}

  std::string name() const override { return name_; }

  Answer answer(const Query& query) override {
    const auto event = methods_.firstEvent(query, query.piece);
    return event ? answerOf(*event) : clear();
  }

 private:
  static const char* toString(impact::MethodName name) {
    return name == impact::MethodName::kPaperA ? "paper A" : "paper B";
  }

  PaperMethods methods_;
  std::string name_;
};

class PaperSampled : public Contestant {
 public:
  PaperSampled(const QuerySet& set, impact::MethodName name) : set_(set), methods_(set, name), test_(set) {}

  std::string name() const override { return "paper, sampled near S"; }

  Answer answer(const Query& query) override {
    const auto event = methods_.firstEvent(query, query.piece);
    if (!event) return clear();
    // When the particle reaches S: method A's own time; after method B's entry, at the velocity there.
    const geometry::Body &a = *set_.bodies[query.a], &b = *set_.bodies[query.b];
    const bool swapped = a.radius() < b.radius();  // the paper's B is the smaller one
    const geometry::Body& particle = swapped ? a : b;
    const impact::Side& side = swapped ? event->a : event->b;
    const Vec3 velocity = swapped ? -event->relative_velocity : event->relative_velocity;
    const double speed2 = velocity.squaredNorm();
    if (speed2 == 0.0) return answerOf(*event);
    const double reached =
        event->toi_lower + (event->position - side.pose * side.point).dot(velocity) / speed2;
    const double around = particle.radius() / std::sqrt(speed2);
    const double from = std::max(0.0, reached - around),
                 to = std::min(durationOf(query.piece), reached + around);
    for (int i = 0; i <= kSamples; ++i) {
      const double t = from + (to - from) * i / kSamples;
      if (!test_.touching(query, t)) continue;
      Answer answer = answerOf(*event);
      answer.toi_lower = answer.toi_upper = t;
      return answer;
    }
    return answerOf(*event);
  }

 private:
  static constexpr int kSamples = 64;
  const QuerySet& set_;
  PaperMethods methods_;
  StaticTest test_;
};

/// Method A is a ray against all triangles; what makes it a line of sight is a target that stands still and a
/// shot that flies on as it does at the stamp.
class LineOfSight : public Contestant {
 public:
  explicit LineOfSight(const QuerySet& set) : set_(set), methods_(set, impact::MethodName::kPaperA) {}

  std::string name() const override { return "line of sight"; }

  Answer answer(const Query& query) override {
    const bool swapped = set_.bodies[query.a]->radius() < set_.bodies[query.b]->radius();
    impact::Piece piece = query.piece;
    freeze(swapped ? piece.b : piece.a, piece, false);
    freeze(swapped ? piece.a : piece.b, piece, true);
    const auto event = methods_.firstEvent(query, piece);
    return event ? answerOf(*event) : clear();
  }

 private:
  static void freeze(motion::RigidMotion& motion, const impact::Piece& piece, bool flies_on) {
    const double s = leadOf(motion, piece);
    const Vec3 velocity = motion.fixed || !flies_on ? Vec3(Vec3::Zero()) : motion.velocity(s);
    const geometry::Pose pose = motion.at(s);
    motion = motion::RigidMotion();
    motion.start_ns = piece.start_ns;
    motion.end_ns = piece.end_ns;
    motion.c[0] = pose.position;
    motion.c[1] = velocity;
    motion.q0 = pose.orientation;
  }

  const QuerySet& set_;
  PaperMethods methods_;
};

}  // namespace

ContestantPtr makePaperA(const QuerySet& set) {
  return std::make_unique<Paper>(set, impact::MethodName::kPaperA);
}
ContestantPtr makePaperB(const QuerySet& set) {
  return std::make_unique<Paper>(set, impact::MethodName::kPaperB);
}
ContestantPtr makePaperASampled(const QuerySet& set) {
  return std::make_unique<PaperSampled>(set, impact::MethodName::kPaperA);
}
ContestantPtr makePaperBSampled(const QuerySet& set) {
  return std::make_unique<PaperSampled>(set, impact::MethodName::kPaperB);
}
ContestantPtr makeLineOfSight(const QuerySet& set) { return std::make_unique<LineOfSight>(set); }

}  // namespace collision_node::report
