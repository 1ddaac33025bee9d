#include "collision_node/report/stability/turning_trials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "collision_node/report/made_meshes.h"
#include "collision_node/report/stability/exact_root.h"
#include "collision_node/report/stability/shapes.h"
#include "collision_node/report/stability/straight_trials.h"

namespace collision_node::report {
namespace {

using geometry::Quat;
using geometry::Vec3;

constexpr double kPi = 3.141592653589793;
constexpr double kArm = 1.0, kBarRadius = 0.025, kBallRadius = 0.05;  // [m] of bar and ball

/// A bar's body has its length along z: `direction` (across the z axis of the world) is where it points
/// first.
Quat pointing(const Vec3& direction) { return Quat::FromTwoVectors(Vec3::UnitZ(), direction).normalized(); }

/// The bar of the groups at rest at the origin, A, turning about the world's z; B a ball on a straight path.
struct BarAndBall {
  Quat bar;
  double spin;
  Flight ball;

  impact::Piece piece() const {
    impact::Piece piece;
    piece.start_ns = ball.from.stamp_ns;
    piece.end_ns = ball.to.stamp_ns;
    piece.a.start_ns = piece.start_ns;
    piece.a.end_ns = piece.end_ns;
    piece.a.q0 = bar;
    piece.a.omega = Vec3(0.0, 0.0, spin);
    piece.b = ball.motion();
    return piece;
  }
  /// From the ball's centre to the bar's core, less both radii.
  Exact gap(const Exact& t) const {
    const Vec<Exact> tip =
        turnedBy(Exact(spin) * t, Vec<Exact>(0, 0, 1), turned(bar, Vec<Exact>(0, 0, Exact(kArm))));
    const Vec<Exact> c = ball.start() + t * ball.velocity();
    Exact share = c.dot(tip) / tip.squaredNorm();
    share = std::max(Exact(-1), std::min(Exact(1), share));
    return (c - share * tip).norm() - Exact(kBarRadius) - Exact(kBallRadius);
  }
};

Group barGroup(const std::string& name) {
  return makeGroup(name, geometry::Capsule{kBarRadius, 2.0 * kArm}, geometry::Sphere{kBallRadius});
}

/// The lowest vertex of `mesh` turned by `q`: doubles choose the candidates, far coarser than they round.
Vec<Exact> lowestOf(const geometry::TriangleMesh& mesh, const Quat& q) {
  double lowest = std::numeric_limits<double>::infinity();
  const Vec3 up = q.conjugate() * Vec3::UnitZ();
  for (const auto& v : mesh.vertices) lowest = std::min(lowest, up.dot(v));
  std::optional<Vec<Exact>> found;
  for (const auto& v : mesh.vertices) {
    if (up.dot(v) > lowest + 1e-9) continue;
    const Vec<Exact> candidate = turned(q, lift<Exact>(v));
    if (!found || candidate.z() < found->z()) found = candidate;
  }
  return *found;
}

Vec3 level(double angle) { return {std::cos(angle), std::sin(angle), 0.0}; }

}  // namespace

Group barAndBall(double spin, motion::Nanoseconds step_ns, int count, Random& random) {
  Group group = barGroup("bar and ball");
  const double step = 1e-9 * static_cast<double>(step_ns), thick = kBarRadius + kBallRadius;
  Setting setting;
  setting.step_ns = step_ns;
  for (int i = 0; i < count; ++i) {
    const bool meets = i % 2 == 0 && spin > 0.0;
    const double start = random.in(-kPi, kPi), reach = random.in(0.6, 0.9) * kArm;
    // The bar's side meets the ball when its angle to it has fallen to `beside`; from less than a quarter
    // turn on the distance falls all the way.
    const double beside = std::asin(thick / reach);
    const double ahead = beside + random.in(0.3, 0.7) * std::min(spin * step, 0.5 * kPi);
    const Vec3 place = meets ? Vec3(reach * level(start + ahead))
                             : Vec3((kArm + thick + 5e-3) * level(random.in(-kPi, kPi)));
    const BarAndBall trial{pointing(level(start)), spin, flight(setting, place, place, Quat::Identity())};
    if (!meets) {
      group.addApart(trial.piece(), 5.1e-3);
      continue;
    }
    const Exact toi = rootOf([&](const Exact& t) { return trial.gap(t); }, Exact(0),
                             std::min(Exact(step), Exact(ahead) / Exact(spin)));
    group.addContact(trial.piece(), toi, nullptr, spin * reach);
  }
  return group;
}

Group slowApproach(double spin, double approach, motion::Nanoseconds step_ns, int count, Random& random) {
  Group group = barGroup("slow approach");
  const double step = 1e-9 * static_cast<double>(step_ns);
  const double ring = kArm + kBarRadius + kBallRadius;
  Setting setting;
  setting.step_ns = step_ns;
  for (int i = 0; i < count; ++i) {
    const bool meets = i % 2 == 0;
    const double from = random.in(-kPi, kPi), start = random.in(-kPi, kPi);
    const double way = approach * step;
    // The tips' ring is reached at `share` of the step. From then on the ball is hit at the first passage of
    // a tip whose angle to it is within acos K(t), K = (D^2 + L^2 - R^2) / (2 D L), D the ball's distance.
    const double share = random.in(0.3, 0.5);
    const double out = meets ? ring + share * way : ring + 1e-6 + way;
    BarAndBall trial{pointing(level(start)), spin,
                     flight(setting, out * level(from), (out - way) * level(from), Quat::Identity())};
    if (!meets) {
      group.addApart(trial.piece(), 1.1e-6);
      continue;
    }
    const double reached = share * step, half_turn = kPi / spin;
    const double first = std::fmod(std::fmod(from - start, kPi) + kPi, kPi) / spin;  // a tip points at it
    const double passage = first + std::ceil((reached - first) / half_turn) * half_turn;
    // The passage before must be over when the ring is reached, and stay so: the tips leave the ball behind
    // faster than the angle opens by a margin.
    const double behind = spin * (reached - (passage - half_turn));
    const double opens = std::sqrt(2.0 * (kBarRadius + kBallRadius) * approach * half_turn) / kArm;
    if (behind < 4.0 * opens || spin * (passage - reached) < 0.3 || passage > 0.98 * step) {
      if (spin * step > 3.0 * kPi) --i;  // drawn again; slower ones may have no such passage
      continue;
    }
    const Exact lower = Exact(passage) - Exact(0.45 * half_turn);
    const Exact toi =
        rootOf([&](const Exact& t) { return trial.gap(t); }, std::max(lower, Exact(reached)), Exact(passage));
    // A tip comes within some gap of it at a passage before: half turns are added to what the gap takes.
    group.addContact(trial.piece(), toi, nullptr, approach / (1.0 + 1e5 * approach * half_turn));
  }
  return group;
}

Group spinningFall(const MeshPtr& mesh, double spin, double fall, motion::Nanoseconds step_ns, int count,
                   Random& random) {
  constexpr double kFace = 10.0;  // [m] the cube's half size
  Group group = makeGroup("spinning fall", geometry::Mesh{cubeMesh(2.0 * kFace)}, geometry::Mesh{mesh});
  const double way = fall * 1e-9 * static_cast<double>(step_ns);
  Setting setting;
  setting.step_ns = step_ns;
  for (int i = 0; i < count; ++i) {
    const bool meets = i % 2 == 0;
    const Quat q = random.orientation();
    const Vec<Exact> lowest = lowestOf(*mesh, q);
    const double above = kFace - toDouble(lowest.z()) + (meets ? random.in(0.3, 0.7) * way : 1.1 * way);
    const double x = random.in(-3.0, 3.0), y = random.in(-3.0, 3.0);
    const Flight a = flight(setting, Vec3::Zero(), Vec3::Zero(), Quat::Identity());
    const Flight b = flight(setting, Vec3(x, y, above), Vec3(x + 0.3 * way, y, above - way), q);
    impact::Piece piece = pieceOf(a, b);
    piece.a = motion::fixedAt(a.from.pose);
    piece.b.omega = Vec3(0.0, 0.0, spin);
    // The face is the plane z = 10, and a turn about z leaves all heights.
    const Exact toi = (Exact(kFace) - b.start().z() - lowest.z()) / b.velocity().z();
    if (toi > secondsOf(b)) {
      group.addApart(piece, 0.1 * way);
      continue;
    }
    const Vec<Exact> point =
        b.start() + toi * b.velocity() + turnedBy(Exact(spin) * toi, Vec<Exact>(0, 0, 1), lowest);
    group.addContact(piece, toi, &point, fall);
  }
  return group;
}

Group longArm(double length, int count, Random& random) {
  constexpr double kTipSpeed = 100.0, kFace = 2.0;  // [m/s], [m] the cube's half size
  const double spin = kTipSpeed / length;
  Group group = makeGroup("arm", geometry::Mesh{cubeMesh(2.0 * kFace)},
                          geometry::Mesh{moved(*tetrahedron(0.5), Vec3(length, 0.0, 0.0))});
  Setting setting;
  setting.step_ns = 20'000'000;
  const Surface<Exact> tip = surfaceOf<Exact>(*group.trials.set.bodies[1], Quat::Identity());
  for (int i = 0; i < count; ++i) {
    const bool meets = i % 2 == 0;
    const double step = 1e-9 * static_cast<double>(setting.step_ns);
    const double at = meets ? random.in(0.4, 0.7) * step : 1.1 * step;
    double highest = 0.0;  // of the tip at that time
    for (const auto& v : tip.vertices) {
      highest = std::max(highest, length * std::sin(spin * at) + toDouble(v.y()));
    }
    const double x = length * std::cos(spin * at) + random.in(-0.5, 0.5), z = random.in(-0.5, 0.5);
    const Flight a =
        flight(setting, Vec3(x, highest + kFace, z), Vec3(x, highest + kFace, z), Quat::Identity());
    const Flight b = flight(setting, Vec3::Zero(), Vec3::Zero(), Quat::Identity());
    impact::Piece piece = pieceOf(a, b);
    piece.a = motion::fixedAt(a.from.pose);
    piece.b.omega = Vec3(0.0, 0.0, spin);
    // The cube's lower face is the plane y = a.y - 2; every corner of the tip rises all the time (its angle
    // stays below a quarter turn). The first to reach the plane is the contact.
    const Exact face = a.start().y() - Exact(kFace);
    std::optional<Exact> toi;
    Vec<Exact> point;
    for (const auto& v : tip.vertices) {
      const auto at_time = [&](const Exact& t) { return turnedBy(Exact(spin) * t, Vec<Exact>(0, 0, 1), v); };
      const auto gap = [&](const Exact& t) { return face - at_time(t).y(); };
      if (gap(secondsOf(b)) > Exact(0)) continue;
      const Exact t = rootOf(gap, Exact(0), secondsOf(b));
      if (toi && *toi <= t) continue;
      toi = t;
      point = at_time(t);
    }
    if (toi) {
      group.addContact(piece, *toi, &point, kTipSpeed);
    } else {
      group.addApart(piece, 0.1 * kTipSpeed * step + 0.5);
    }
  }
  return group;
}

Group reversal(double most, motion::Nanoseconds step_ns, int count, Random& random) {
  constexpr double kFace = 10.0, kRadius = 0.5;  // [m] the cube's half size, the ball
  Group group = makeGroup("reversal", geometry::Mesh{cubeMesh(2.0 * kFace)}, geometry::Sphere{kRadius});
  const Exact h = Exact(step_ns) / Exact(1'000'000'000);
  const double step = 1e-9 * static_cast<double>(step_ns), speed = most * step / 6.0;
  // Equal heights and speeds -V at both ends: z = z0 - V h (s - 3 s^2 + 2 s^3), s = t / h, lowest at
  // s = 1/2 - 1/sqrt(12), by V h / sqrt(108).
  const double dip = speed * step / std::sqrt(108.0);
  Setting setting;
  setting.step_ns = step_ns;
  for (int i = 0; i < count; ++i) {
    const double under = i % 3 == 0 ? 0.3 : i % 3 == 1 ? 1e-3 : -1e-3;
    const double height = kFace + kRadius + (1.0 - under) * dip;
    const Vec3 place(random.in(-5.0, 5.0), random.in(-5.0, 5.0), height);
    Flight b = flight(setting, place, place, random.orientation());
    b.from.has_twist = b.to.has_twist = true;
    b.from.linear = b.to.linear = Vec3(0.0, 0.0, -speed);
    const Flight a = flight(setting, Vec3::Zero(), Vec3::Zero(), Quat::Identity());
    impact::Piece piece = pieceOf(a, b);
    piece.a = motion::fixedAt(a.from.pose);
    piece.b = motion::hermite(b.from, b.to);
    const auto gap = [&](const Exact& t) {
      const Exact s = t / h;
      return b.start().z() - Exact(speed) * h * s * (Exact(1) + s * (Exact(-3) + Exact(2) * s)) -
             Exact(kFace) - Exact(kRadius);
    };
    const Exact lowest = h * (Exact(1) / Exact(2) - Exact(1) / sqrt(Exact(12)));
    if (gap(lowest) > Exact(0)) {
      group.addApart(piece, 1.1e-3 * dip);
      continue;
    }
    const Exact toi = rootOf(gap, Exact(0), lowest);
    const Vec<Exact> point(b.start().x(), b.start().y(), Exact(kFace));
    group.addContact(piece, toi, &point, std::sqrt(under) * speed);
  }
  return group;
}

}  // namespace collision_node::report
