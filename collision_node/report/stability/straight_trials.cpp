#include "collision_node/report/stability/straight_trials.h"

#include <cmath>
#include <stdexcept>

namespace collision_node::report {
namespace {

using geometry::Quat;
using geometry::Vec3;

/// A point in the middle of a random face, turned; the middle of the body when it has no faces.
Vec3 aim(const Surface<double>& surface, Random& random, Vec3* outward) {
  *outward = Vec3::Zero();
  if (surface.faces.empty()) return surface.vertices[0];
  const auto& face =
      surface
          .faces[static_cast<std::size_t>(random.in(0.0, 1.0) * static_cast<double>(surface.faces.size()))];
  const double first = random.in(0.2, 0.5), second = random.in(0.1, 0.4);
  const Vec3 &p = surface.vertices[face[0]], &q = surface.vertices[face[1]], &r = surface.vertices[face[2]];
  const Vec3 normal = (q - p).cross(r - p);
  if (normal.norm() > 0.0) *outward = normal.normalized();
  return first * p + second * q + (1.0 - first - second) * r;
}

class Drawing {
 public:
  Drawing(Group& group, const Setting& setting, double margin, Random& random)
      : group_(group),
        setting_(setting),
        margin_(margin),
        random_(random),
        path_(setting.speed * 1e-9 * static_cast<double>(setting.step_ns)) {
    q_a_ = random.orientation();
    q_b_ = random.orientation();
    a_ = surfaceOf<double>(bodyA(), q_a_);
    b_ = surfaceOf<double>(bodyB(), q_b_);
    Vec3 outward;
    const Vec3 target = aim(a_, random, &outward);
    const auto which =
        static_cast<std::size_t>(random.in(0.0, 1.0) * static_cast<double>(b_.vertices.size()));
    do {
      along_ = random.direction();
    } while (outward.dot(along_) > -0.4 && !outward.isZero());
    aim_ = target - b_.vertices[which];
  }

  /// False: the rounding of the poses left them in contact at the start; draw again.
  bool add(int kind) {
    // Rounding may already take the aim out of a face that is thin enough: then the poses say what is true.
    const double straight_on = meet(aim_).value_or(0.0);
    Vec3 base = aim_;
    double begin = straight_on - random_.in(0.3, 0.7) * path_;
    if (kind == 1) {
      begin = straight_on - 1.1 * path_;
    } else if (kind == 2) {
      const auto [outline, when] = outlineOf();
      base = aim_ + (outline + margin_) * side_;
      begin = when - 0.5 * path_;
    }
    return record(base + begin * along_, base + (begin + path_) * along_);
  }

 private:
  const geometry::Body& bodyA() const { return *group_.trials.set.bodies[0]; }
  const geometry::Body& bodyB() const { return *group_.trials.set.bodies[1]; }

  /// Where on the line through `base` along the path they touch first [m].
  std::optional<double> meet(const Vec3& base) const {
    const auto touch = firstTouch<double>(a_, b_, base, along_);
    if (!touch) return std::nullopt;
    return touch->time;
  }

  /// How far aside the path must lie to miss, and where it met last.
  std::pair<double, double> outlineOf() {
    side_ = random_.across(along_, 1.0, 1.0);
    double hits = 0.0, misses = 2.2 * (bodyA().reach() + bodyB().reach()), when = meet(aim_).value_or(0.0);
    while (misses - hits > 1e-10 * misses + 1e-14) {
      const double middle = 0.5 * (hits + misses);
      const auto touch = meet(aim_ + middle * side_);
      (touch ? hits : misses) = middle;
      if (touch) when = *touch;
    }
    return {misses, when};
  }

  bool record(const Vec3& begin, const Vec3& end) {
    const Vec3 place = setting_.offset * Vec3(0.6, -0.64, 0.48);
    const Vec3 drift = setting_.both_move ? random_.vector(0.2 * path_, 2.0 * path_) : Vec3::Zero();
    const Flight a = flight(setting_, place, place + drift, q_a_);
    const Flight b = flight(setting_, place + begin, place + drift + end, q_b_);
    const Vec<Exact> d = b.start() - a.start(), v = b.velocity() - a.velocity();
    if (v.isZero()) return false;
    const auto touch =
        firstTouch<Exact>(surfaceOf<Exact>(bodyA(), q_a_), surfaceOf<Exact>(bodyB(), q_b_), d, v);
    impact::Piece piece = pieceOf(a, b);
    if (!setting_.both_move) piece.a = motion::fixedAt(a.from.pose);
    if (!touch || touch->time > secondsOf(a)) {
      group_.addApart(piece, nearestOf(begin, (end - begin) / path_));
      return true;
    }
    if (touch->time <= Exact(0)) return false;
    const Vec<Exact> point = a.start() + touch->time * a.velocity() + touch->point;
    group_.addContact(piece, touch->time, touch->one_point ? &point : nullptr,
                      closingOf(begin, (end - begin) / path_));
    return true;
  }

  /// When the two are first within `gap` on the way [m].
  std::optional<double> within(double gap, const Vec3& begin, const Vec3& along) const {
    Surface<double> grown = a_;
    grown.radius += gap;
    const auto touch = firstTouch<double>(grown, b_, begin, along);
    if (!touch || touch->time > path_) return std::nullopt;
    return touch->time;
  }

  /// How near they come that stay apart [m].
  double nearestOf(const Vec3& begin, const Vec3& along) const {
    double apart = 0.0, met = 2.0 * (begin.norm() + path_);
    while (met - apart > 1e-3 * met + 1e-15) {
      const double gap = 0.5 * (apart + met);
      (within(gap, begin, along) ? met : apart) = gap;
    }
    return met;
  }

  /// The least speed at which the last millimetre, or the last part of it, closes [m/s].
  double closingOf(const Vec3& begin, const Vec3& along) const {
    const double met = within(0.0, begin, along).value_or(0.0);
    double least = setting_.speed;
    for (const double gap : {1e-3, 1e-4, 1e-5, 1e-6}) {
      const double before = met - within(gap, begin, along).value_or(met);
      if (before > 0.0) least = std::min(least, setting_.speed * gap / before);
    }
    return least;
  }

  Group& group_;
  const Setting& setting_;
  double margin_;
  Random& random_;
  double path_;
  Quat q_a_, q_b_;
  Surface<double> a_, b_;
  Vec3 along_, aim_, side_ = Vec3::Zero();
};

}  // namespace

motion::RigidMotion Flight::motion() const { return motion::straightSlerp(from, to); }

Vec<Exact> Flight::velocity() const {
  return (lift<Exact>(to.pose.position) - lift<Exact>(from.pose.position)) / secondsOf(*this);
}

Flight flight(const Setting& setting, const Vec3& from, const Vec3& to, const Quat& q) {
  Flight result;
  result.from.stamp_ns = setting.start_ns;
  result.to.stamp_ns = setting.start_ns + setting.step_ns;
  result.from.pose = {from, q};
  result.to.pose = {to, q};
  return result;
}

impact::Piece pieceOf(const Flight& a, const Flight& b) {
  impact::Piece piece;
  piece.start_ns = a.from.stamp_ns;
  piece.end_ns = a.to.stamp_ns;
  piece.a = a.motion();
  piece.b = b.motion();
  return piece;
}

Exact secondsOf(const Flight& flight) {
  return Exact(flight.to.stamp_ns - flight.from.stamp_ns) / Exact(1'000'000'000);
}

void addStraightTrials(Group& group, const Setting& setting, double margin, int count, Random& random) {
  for (int i = 0; i < count; ++i) {
    int tries = 0;
    while (!Drawing(group, setting, margin, random).add(i % 3)) {
      if (++tries == 1000) throw std::logic_error(group.trials.name + ": no trial starts apart");
    }
  }
}

}  // namespace collision_node::report
