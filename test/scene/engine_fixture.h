/// Small scenes of spheres on the x axis, a stand-in for the solver, and events as text.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "collision_node/geometry/body.h"
#include "collision_node/scene/engine.h"

namespace collision_node::scene {

constexpr Nanoseconds kMs = 1'000'000;

inline motion::StampedPose poseAt(Nanoseconds stamp_ms, double x) {
  motion::StampedPose pose;
  pose.stamp_ns = stamp_ms * kMs;
  pose.pose.position.x() = x;
  return pose;
}

/// A sphere of radius 0.5 m that a topic moves.
inline Object movingSphere(const std::string& name) {
  Object object;
  object.name = name;
  object.source.type = PoseSource::Type::kTopic;
  object.source.topic = name + "/pose";
  Link link;
  link.name = "body";
  link.shapes = {{geometry::Sphere{0.5}, {}, "sphere"}};
  link.body = std::make_shared<geometry::Body>(link.shapes);
  object.links.push_back(link);
  return object;
}

inline Object fixedSphere(const std::string& name, double x) {
  Object object = movingSphere(name);
  object.source = {};
  object.source.fixed.position.x() = x;
  return object;
}

/// Watches every pair. `objects` must come in byte order of their names.
inline std::shared_ptr<Scene> sceneOf(std::vector<Object> objects) {
  auto scene = std::make_shared<Scene>();
  scene->file = "test.yaml";
  scene->objects = std::move(objects);
  return scene;
}

/// Spheres of radius 0.5 m on the x axis, solved in closed form; the brackets have no width.
class LineMethod : public impact::PairMethod {
 public:
  explicit LineMethod(int* advances = nullptr) : advances_(advances) {}

  impact::PieceOutcome advance(const impact::Piece& piece, impact::PairState& state,
                               std::vector<impact::PairEvent>& events) const override {
    using Phase = impact::PairState::Phase;
    if (advances_) ++*advances_;
    const double h = motion::secondsBetween(piece.start_ns, piece.end_ns);
    const double from = gap(piece, 0.0), to = gap(piece, h);
    const std::size_t before = events.size();
    if (state.phase == Phase::kNew) {
      state.phase = std::abs(from) <= 1.0 ? Phase::kTouching : Phase::kApart;
      if (state.phase == Phase::kTouching)
        events.push_back(eventAt(piece, impact::Kind::kInitialOverlap, 0.0));
    }
    // The gap is a straight line: it meets +1 and -1 at most once each.
    double times[2] = {h * (-1.0 - from) / (to - from), h * (1.0 - from) / (to - from)};
    if (times[1] < times[0]) std::swap(times[0], times[1]);
    if (state.phase == Phase::kApart && times[0] > 0.0 && times[0] <= h) {
      events.push_back(eventAt(piece, impact::Kind::kImpact, times[0]));
      state.phase = Phase::kTouching;
    }
    if (state.phase == Phase::kTouching && times[1] > 0.0 && times[1] <= h) {
      events.push_back(eventAt(piece, impact::Kind::kSeparation, times[1]));
      state.phase = Phase::kApart;
    }
    state.last_piece = piece;
    impact::PieceOutcome outcome;
    outcome.node_tests = 1;
    const bool contact = events.size() > before || state.phase == Phase::kTouching;
    outcome.answer = contact ? impact::Answer::kImpact : impact::Answer::kClear;
    return outcome;
  }

  void finish(impact::PairState&, std::vector<impact::PairEvent>&) const override {}

  void interrupt(impact::PairState& state, impact::Reason reason,
                 std::vector<impact::PairEvent>& events) const override {
    if (state.phase == impact::PairState::Phase::kTouching) {
      const impact::Piece& piece = state.last_piece;
      const double h = motion::secondsBetween(piece.start_ns, piece.end_ns);
      impact::PairEvent event = eventAt(piece, impact::Kind::kSeparation, h);
      event.certificate = impact::Certificate::kUncertified;
      event.reason = reason;
      events.push_back(event);
    }
    state = impact::PairState();
  }

 protected:
  static double gap(const impact::Piece& piece, double s) {
    return at(piece, piece.b, s).position.x() - at(piece, piece.a, s).position.x();
  }
  static Pose at(const impact::Piece& piece, const motion::RigidMotion& motion, double s) {
    return motion.at(motion.fixed ? 0.0 : s + motion::secondsBetween(motion.start_ns, piece.start_ns));
  }
  static impact::PairEvent eventAt(const impact::Piece& piece, impact::Kind kind, double s) {
    impact::PairEvent event;
    event.kind = kind;
    event.certificate = impact::Certificate::kConfirmed;
    event.interval_start_ns = piece.start_ns;
    event.interval_end_ns = piece.end_ns;
    event.toi_lower = event.toi_upper = s;
    event.a.pose = at(piece, piece.a, s);
    event.b.pose = at(piece, piece.b, s);
    event.position = 0.5 * (event.a.pose.position + event.b.pose.position);
    event.a.point = event.a.pose.inverse() * event.position;
    event.b.point = event.b.pose.inverse() * event.position;
    event.a.sample_before_ns = piece.a.start_ns;
    event.a.sample_after_ns = piece.a.end_ns;
    event.b.sample_before_ns = piece.b.start_ns;
    event.b.sample_after_ns = piece.b.end_ns;
    return event;
  }

 private:
  int* advances_;
};

/// An engine and everything it said.
struct Rig {
  explicit Rig(std::shared_ptr<const Scene> scene, int* advances = nullptr)
      : Rig(std::move(scene),
            [advances](const geometry::Body&, const geometry::Body&, const impact::PairOptions&) {
              return std::make_unique<LineMethod>(advances);
            }) {}
  Rig(std::shared_ptr<const Scene> scene, const Engine::MethodFactory& factory,
      const EngineOptions& options = {true, 1})
      : engine(std::move(scene), factory, sinks(), options) {}
  Rig(std::shared_ptr<const Scene> scene, impact::MethodName method, const EngineOptions& options = {})
      : engine(std::move(scene), method, sinks(), options) {}

  Engine::Sinks sinks() {
    return {[this](const Event& event) { events.push_back(event); },
            [this](const Stats& beat) { beats.push_back(beat); }};
  }

  /// Poses every `step_ms` on the line x = x0 + v t.
  void feedLine(int object, Nanoseconds from_ms, Nanoseconds to_ms, Nanoseconds step_ms, double x0,
                double v) {
    for (Nanoseconds t = from_ms; t <= to_ms; t += step_ms)
      engine.addPose(object, poseAt(t, x0 + v * 1e-3 * static_cast<double>(t)));
  }

  std::vector<Event> events;
  std::vector<Stats> beats;
  Engine engine;
};

inline std::string text(const Vec3& v) {
  std::ostringstream out;
  out << std::hexfloat;
  for (int k = 0; k < 3; ++k) std::isnan(v[k]) ? out << " none" : out << ' ' << v[k];
  return out.str();
}

inline std::string text(const EventSide& side) {
  std::ostringstream out;
  const geometry::Quat& q = side.pose.orientation;
  out << ' ' << side.object << '/' << side.link << " zone '" << side.zone << "' " << side.zone_certain
      << " shape " << side.shape << ' ' << static_cast<int>(side.feature) << ' ' << side.triangle << " point"
      << text(side.point) << " pose" << text(side.pose.position) << text(Vec3(q.vec())) << std::hexfloat
      << ' ' << q.w() << " samples " << side.sample_before_ns << ' ' << side.sample_after_ns;
  return out.str();
}

/// All that an event says, to the bit.
inline std::string text(const Event& e) {
  std::ostringstream out;
  out << "epoch " << e.epoch << " event " << e.event_id << " contact " << e.contact_id << ' '
      << toString(e.kind) << ' ' << toString(e.certificate) << ' ' << toString(e.reason) << " stamp "
      << e.stamp_ns << " interval " << e.interval_start_ns << ' ' << e.interval_end_ns << std::hexfloat
      << " toi " << e.toi_lower << ' ' << e.toi_upper << " at" << text(e.position) << " ball "
      << e.position_error << ' ' << e.multiple << " normal" << text(e.normal) << ' ' << e.normal_error
      << " speed" << text(e.relative_velocity) << ' ' << e.closing_speed << " model"
      << text(Vec3(e.model_toi_lower, e.model_toi_upper, e.model_position_error)) << " opens "
      << e.opens_contact << " a" << text(e.a) << " b" << text(e.b);
  return out.str();
}

inline std::vector<std::string> texts(const std::vector<Event>& events) {
  std::vector<std::string> out;
  for (const Event& event : events) out.push_back(text(event));
  return out;
}

/// "IMPACT/CONFIRMED/NONE" for each event: what most tests are about.
inline std::vector<std::string> kinds(const std::vector<Event>& events) {
  std::vector<std::string> out;
  for (const Event& e : events)
    out.push_back(std::string(toString(e.kind)) + '/' + toString(e.certificate) + '/' + toString(e.reason));
  return out;
}

}  // namespace collision_node::scene
