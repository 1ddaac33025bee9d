#include "collision_node/impact/paper_methods.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "collision_node/geometry/body.h"

namespace collision_node::impact {
namespace {

using geometry::Body;
using motion::RigidMotion;

constexpr double kPi = 3.14159265358979323846;

// ---------------------------------------------------------------- A's triangles

/// A surface of revolution about z through `profile` (radius, height), closed where the radius is 0.
void addRevolution(const std::vector<std::array<double, 2>>& profile, const Pose& origin, int shape,
                   std::vector<PaperTriangle>& out) {
  const auto at = [&](std::size_t ring, int side) {
    const double angle = 2.0 * kPi * (side % kPaperSides) / kPaperSides;
    const double r = profile[ring][0];
    return origin * Vec3(r * std::cos(angle), r * std::sin(angle), profile[ring][1]);
  };
  for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
    for (int side = 0; side < kPaperSides; ++side) {
      const Vec3 a = at(ring, side), b = at(ring, side + 1), c = at(ring + 1, side + 1),
                 d = at(ring + 1, side);
      if (profile[ring][0] > 0.0) out.push_back({{a, b, c}, shape, Feature::kSmooth});
      if (profile[ring + 1][0] > 0.0) out.push_back({{a, c, d}, shape, Feature::kSmooth});
    }
  }
}

/// Sphere (length 0) and capsule: a lower and an upper half circle, `length` apart.
void addCapsule(double radius, double length, const Pose& origin, int shape,
                std::vector<PaperTriangle>& out) {
  std::vector<std::array<double, 2>> profile;
  const int quarter = kPaperSides / 4;
  for (int i = -quarter; i <= quarter; ++i) {
    const double latitude = 0.5 * kPi * i / quarter;
    const double r = std::abs(i) == quarter ? 0.0 : radius * std::cos(latitude);
    if (i == 0 && length > 0.0) profile.push_back({r, -0.5 * length});
    profile.push_back({r, radius * std::sin(latitude) + (i < 0 ? -0.5 : 0.5) * length});
  }
  addRevolution(profile, origin, shape, out);
}

void addBox(const Vec3& size, const Pose& origin, int shape, std::vector<PaperTriangle>& out) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const auto corner = [&](double u, double v) {
        Vec3 p;
        p[axis] = 0.5 * sign * size[axis];
        p[(axis + 1) % 3] = 0.5 * u * size[(axis + 1) % 3];
        p[(axis + 2) % 3] = 0.5 * v * size[(axis + 2) % 3];
        return origin * p;
      };
      const Vec3 a = corner(-1, -1), b = corner(1, -1), c = corner(1, 1), d = corner(-1, 1);
      out.push_back({{a, b, c}, shape, Feature::kFace});
      out.push_back({{a, c, d}, shape, Feature::kFace});
    }
  }
}

struct Tessellator {
  const Pose& origin;
  int shape;
  std::vector<PaperTriangle>& out;

  void operator()(const geometry::Point&) const {}
  void operator()(const geometry::Mesh&) const {}
  void operator()(const geometry::Sphere& s) const { addCapsule(s.radius, 0.0, origin, shape, out); }
  void operator()(const geometry::Capsule& s) const { addCapsule(s.radius, s.length, origin, shape, out); }
  void operator()(const geometry::Box& s) const { addBox(s.size, origin, shape, out); }
  void operator()(const geometry::Cylinder& s) const {
    const double half = 0.5 * s.length;
    addRevolution({{0.0, -half}, {s.radius, -half}, {s.radius, half}, {0.0, half}}, origin, shape, out);
  }
  void operator()(const geometry::Convex& s) const {
    const auto& vertices = s.mesh->vertices;
    for (const auto& t : s.mesh->triangles) {
      out.push_back({{origin * vertices[t[0]], origin * vertices[t[1]], origin * vertices[t[2]]},
                     shape,
                     Feature::kFace});
    }
  }
};

// ---------------------------------------------------------------- B's path in A's frame

/// y(u) = k[0] + k[1] u + k[2] u^2 + k[3] u^3, u = fraction of the piece in [0, 1].
struct Cubic {
  Vec3 k[4];

  Vec3 at(double u) const { return k[0] + u * (k[1] + u * (k[2] + u * k[3])); }
  Vec3 derivative(double u) const { return k[1] + u * (2.0 * k[2] + 3.0 * u * k[3]); }
};

/// Seconds from the motion's own first stamp to the piece's start.
double lead(const RigidMotion& m, const Piece& piece) {
  return m.fixed ? 0.0 : motion::secondsBetween(m.start_ns, piece.start_ns);
}

/// How far the origin has gone from its c[0] after `s` seconds; kept apart from c[0] so that a large world
/// offset cancels between the two objects before anything is added to it.
Vec3 travelled(const RigidMotion& m, double s) { return s * (m.c[1] + s * (m.c[2] + s * m.c[3])); }

/// Eqs. 1-4: the particle's path relative to A, turned into A's frame. Eq. 3 knows no orientation of A; we
/// read it with A's orientation at the piece's start. The particle's arm from B's origin goes straight from
/// its first to its last direction, so both ends of the path are where the particle truly is.
Cubic relativePath(const Piece& piece, const RigidMotion& a, const RigidMotion& b, const Vec3& particle) {
  const double duration = motion::secondsBetween(piece.start_ns, piece.end_ns);
  const double sa = lead(a, piece), sb = lead(b, piece);
  const Vec3 arm0 = b.at(sb).orientation * particle;
  const Vec3 arm1 = b.at(sb + duration).orientation * particle;

  Cubic world;
  world.k[0] = (b.c[0] - a.c[0]) + (travelled(b, sb) - travelled(a, sa)) + arm0;
  world.k[1] = (b.velocity(sb) - a.velocity(sa)) * duration + (arm1 - arm0);
  world.k[2] = ((b.c[2] + 3.0 * sb * b.c[3]) - (a.c[2] + 3.0 * sa * a.c[3])) * (duration * duration);
  world.k[3] = (b.c[3] - a.c[3]) * (duration * duration * duration);

  const geometry::Mat3 to_a = a.at(sa).orientation.toRotationMatrix().transpose();
  Cubic path;
  for (int i = 0; i < 4; ++i) path.k[i] = to_a * world.k[i];
  return path;
}

// ---------------------------------------------------------------- the bounding sphere

/// Step 1 of method A, read as: the path itself, from its first to its last point, comes within the sphere.
bool segmentMeetsSphere(const Vec3& from, const Vec3& step, const Vec3& centre, double radius) {
  const double length2 = step.squaredNorm();
  const double nearest = length2 > 0.0 ? std::clamp((centre - from).dot(step) / length2, 0.0, 1.0) : 0.0;
  return (from + nearest * step - centre).norm() <= radius;
}

double evaluate(const std::vector<double>& polynomial, double u) {
  double value = 0.0;
  for (std::size_t i = polynomial.size(); i-- > 0;) value = value * u + polynomial[i];
  return value;
}

/// The change of sign between lo and hi, to the last bit.
double bisect(const std::vector<double>& polynomial, double lo, double hi) {
  const bool low_positive = evaluate(polynomial, lo) > 0.0;
  for (;;) {
    const double middle = 0.5 * (lo + hi);
    if (!(middle > lo && middle < hi)) return hi;
    ((evaluate(polynomial, middle) > 0.0) == low_positive ? lo : hi) = middle;
  }
}

/// Where the polynomial changes sign in (0, 1), ascending. Between two turning points it is monotone.
std::vector<double> signChanges(const std::vector<double>& polynomial) {
  if (polynomial.size() < 2) return {};
  std::vector<double> slope;
  for (std::size_t i = 1; i < polynomial.size(); ++i) slope.push_back(static_cast<double>(i) * polynomial[i]);
  std::vector<double> ends = signChanges(slope);
  ends.insert(ends.begin(), 0.0);
  ends.push_back(1.0);
  std::vector<double> changes;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if ((evaluate(polynomial, ends[i]) > 0.0) != (evaluate(polynomial, ends[i + 1]) > 0.0)) {
      changes.push_back(bisect(polynomial, ends[i], ends[i + 1]));
    }
  }
  return changes;
}

/// Step 1 of method B: the first u in [0, 1] at which the curve is in the sphere; 0 when it starts there.
std::optional<double> sphereEntry(const Cubic& path, const Vec3& centre, double radius) {
  Cubic from_centre = path;
  from_centre.k[0] -= centre;
  std::vector<double> excess(7, 0.0);  // |y - centre|^2 - radius^2
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) excess[i + j] += from_centre.k[i].dot(from_centre.k[j]);
  }
  excess[0] -= radius * radius;
  if (excess[0] <= 0.0) return 0.0;
  const std::vector<double> crossings = signChanges(excess);
  if (crossings.empty()) return std::nullopt;
  return crossings.front();
}

// ---------------------------------------------------------------- the methods

/// Eqs. 5-6 on one triangle: where `from + lambda step` meets the plane, and whether that is in the triangle.
std::optional<double> meetTriangle(const Vec3& from, const Vec3& step, const std::array<Vec3, 3>& t,
                                   InsideTest inside) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double slope = normal.dot(step);
  if (slope == 0.0) return std::nullopt;  // the path lies along the plane, or the triangle has no area
  const double lambda = normal.dot(t[0] - from) / slope;
  if (!(lambda >= 0.0 && lambda <= 1.0)) return std::nullopt;
  if (!insideTriangle(from + lambda * step, t, inside)) return std::nullopt;
  return lambda;
}

struct Hit {
  double lambda =
      std::numeric_limits<double>::infinity();  ///< fraction of the tested segment; infinite: no hit
  Vec3 point;                                   ///< in A's frame
  Vec3 normal;                                  ///< in A's frame, unit, against the particle's motion
  Side side;                                    ///< shape, feature and triangle of A
};

/// Where B's particle sits in its object's frame.
Vec3 particleOf(const Body& b) {
  const bool one_primitive = b.shapes().size() == 1 &&
                             !std::holds_alternative<geometry::Mesh>(b.shapes()[0].shape) &&
                             !std::holds_alternative<geometry::Convex>(b.shapes()[0].shape);
  return one_primitive ? b.shapes()[0].origin.position : b.centre();
}

class PaperMethod : public PairMethod {
 public:
  PaperMethod(PaperVariant variant, InsideTest inside, const Body& a, const Body& b)
      : variant_(variant),
        inside_(inside),
        swapped_(a.radius() < b.radius()),
        reference_(swapped_ ? b : a),
        particle_(particleOf(swapped_ ? a : b)),
        particle_is_point_(isPoint(swapped_ ? a : b)),
        primitives_(tessellatePrimitives(reference_)) {}

  PieceOutcome advance(const Piece& piece, PairState& state, std::vector<PairEvent>& events) const override {
    PieceOutcome outcome;
    const RigidMotion& a = swapped_ ? piece.b : piece.a;
    const RigidMotion& b = swapped_ ? piece.a : piece.b;
    const Cubic path = relativePath(piece, a, b, particle_);

    // The tested segment starts at the fraction `entry` of the piece; method A tests the whole chord.
    double entry = 0.0;
    Vec3 from = path.k[0];
    Vec3 step = path.k[1] + path.k[2] + path.k[3];
    bool near = false;
    if (variant_ == PaperVariant::kA) {
      near = segmentMeetsSphere(from, step, reference_.centre(), reference_.radius());
    } else if (const auto u = sphereEntry(path, reference_.centre(), reference_.radius())) {
      // The static test: along the velocity at the entry, as far as it carries until the piece ends.
      near = true;
      entry = *u;
      from = path.at(entry);
      step = (1.0 - entry) * path.derivative(entry);
    }

    outcome.answer = near ? Answer::kClear : Answer::kCulled;
    if (near) {
      // A piece owns (start, end]; only a pair's first piece owns its start.
      const bool owns_start = state.phase == PairState::Phase::kNew || entry > 0.0;
      const Hit hit = nearestHit(from, step, owns_start, outcome.node_tests);
      if (std::isfinite(hit.lambda)) {
        outcome.answer = Answer::kImpact;
        const double u = variant_ == PaperVariant::kA ? hit.lambda : entry;
        const Vec3 velocity = variant_ == PaperVariant::kA ? step : path.derivative(entry);
        events.push_back(makeEvent(piece, u, hit, velocity));
      }
    }
    state.phase = PairState::Phase::kApart;
    state.last_piece = piece;
    return outcome;
  }

  void finish(PairState&, std::vector<PairEvent>&) const override {}

  void interrupt(PairState& state, Reason, std::vector<PairEvent>&) const override { state = PairState{}; }

 private:
  static bool isPoint(const Body& b) {
    return b.shapes().size() == 1 && std::holds_alternative<geometry::Point>(b.shapes()[0].shape);
  }

  Hit nearestHit(const Vec3& from, const Vec3& step, bool owns_start, std::uint64_t& tests) const {
    Hit best;
    const auto consider = [&](const std::array<Vec3, 3>& corners, int shape, Feature feature, int triangle) {
      ++tests;
      const auto lambda = meetTriangle(from, step, corners, inside_);
      if (!lambda || *lambda >= best.lambda || (*lambda == 0.0 && !owns_start)) return;
      best.lambda = *lambda;
      best.point = from + *lambda * step;
      best.normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
      if (best.normal.dot(step) > 0.0) best.normal = -best.normal;
      best.side.shape = shape;
      best.side.feature = feature;
      best.side.triangle = triangle;
    };
    Vec3 buffer[3];
    for (std::int32_t id = 0; id < reference_.elementCount(); ++id) {
      const geometry::Element element = reference_.element(id, buffer);
      if (element.triangle < 0 || element.count != 3) continue;
      consider({element.vertices[0], element.vertices[1], element.vertices[2]}, element.shape, Feature::kFace,
               element.triangle);
    }
    for (const PaperTriangle& t : primitives_) consider(t.corners, t.shape, t.feature, -1);
    return best;
  }

  /// `u`: fraction of the piece at which the method puts the impact; `velocity`: of B in A's frame, per
  /// piece.
  PairEvent makeEvent(const Piece& piece, double u, const Hit& hit, const Vec3& velocity) const {
    const RigidMotion& a = swapped_ ? piece.b : piece.a;
    const double duration = motion::secondsBetween(piece.start_ns, piece.end_ns);
    const double toi = u * duration;

    PairEvent event;
    event.kind = Kind::kImpact;
    event.certificate = Certificate::kUncertified;
    event.reason = Reason::kMethod;
    event.interval_start_ns = piece.start_ns;
    event.interval_end_ns = piece.end_ns;
    event.toi_lower = event.toi_upper = toi;

    // Eq. 7: back to the world with A's position at that time and, as in eq. 3, A's orientation at the start.
    Pose at_hit = a.at(lead(a, piece) + toi);
    at_hit.orientation = a.at(lead(a, piece)).orientation;
    event.position = at_hit * hit.point;
    event.position_error = std::numeric_limits<double>::quiet_NaN();
    event.normal_error = kPi;
    const double from_reference = swapped_ ? -1.0 : 1.0;  // a to b and b minus a, when the paper's A is our b
    event.normal = from_reference * (at_hit.orientation * hit.normal);
    event.relative_velocity = from_reference * (at_hit.orientation * velocity) / duration;
    event.closing_speed = -event.relative_velocity.dot(event.normal);

    Side reference = hit.side;
    reference.point = hit.point;
    Side particle;
    particle.shape = 0;
    particle.feature = particle_is_point_ ? Feature::kVertex : Feature::kUnknown;
    particle.point = particle_;
    event.a = swapped_ ? particle : reference;
    event.b = swapped_ ? reference : particle;
    complete(event.a, piece.a, piece, toi);
    complete(event.b, piece.b, piece, toi);
    return event;
  }

  static void complete(Side& side, const RigidMotion& motion, const Piece& piece, double toi) {
    side.pose = motion.at(lead(motion, piece) + toi);
    side.sample_before_ns = motion.fixed ? 0 : motion.start_ns;
    side.sample_after_ns = motion.fixed ? 0 : motion.end_ns;
  }

  PaperVariant variant_;
  InsideTest inside_;
  bool swapped_;            ///< our b is the paper's A
  const Body& reference_;   ///< the paper's A
  Vec3 particle_;           ///< the paper's B, in its object's frame
  bool particle_is_point_;  ///< nothing of B is neglected
  std::vector<PaperTriangle> primitives_;
};

}  // namespace

bool insideTriangle(const Vec3& p, const std::array<Vec3, 3>& t, InsideTest test) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  if (normal.squaredNorm() == 0.0) return false;
  const double ab = (t[1] - t[0]).cross(p - t[0]).dot(normal);
  const double bc = (t[2] - t[1]).cross(p - t[1]).dot(normal);
  if (ab < 0.0 || bc < 0.0) return false;
  return test == InsideTest::kTwoSigns || (t[0] - t[2]).cross(p - t[2]).dot(normal) >= 0.0;
}

std::vector<PaperTriangle> tessellatePrimitives(const Body& body) {
  std::vector<PaperTriangle> triangles;
  for (std::size_t i = 0; i < body.shapes().size(); ++i) {
    const geometry::PlacedShape& placed = body.shapes()[i];
    std::visit(Tessellator{placed.origin, static_cast<int>(i), triangles}, placed.shape);
  }
  return triangles;
}

std::unique_ptr<PairMethod> makePaper(PaperVariant variant, InsideTest inside, const Body& a, const Body& b) {
  return std::make_unique<PaperMethod>(variant, inside, a, b);
}

std::unique_ptr<PairMethod> makePaperA(const Body& a, const Body& b, const PairOptions&) {
  return makePaper(PaperVariant::kA, InsideTest::kThreeSigns, a, b);
}

std::unique_ptr<PairMethod> makePaperB(const Body& a, const Body& b, const PairOptions&) {
  return makePaper(PaperVariant::kB, InsideTest::kThreeSigns, a, b);
}

}  // namespace collision_node::impact
