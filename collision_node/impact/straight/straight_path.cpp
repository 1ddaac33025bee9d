/// Which pairs are a straight path, where it runs and what rounding may have made of it.
///
/// Guarantee: the exact path stays within error() of at(t) for every t of the piece (docs/solver.md,
/// "Straight paths"). Everything is seen from the triangles' own frame.
#include "collision_node/impact/straight/straight_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSlowest = 1e-150;  ///< [m/s] below, reciprocals of velocities might overflow

bool isZero(const Vec3& v) { return motion::areZero(v.data(), 3); }

}  // namespace

__attribute__((flatten)) std::optional<StraightPath> StraightPath::pastMesh(const Body& a, const Body& b,
                                                                            const Piece& piece,
                                                                            double contact_distance) {
  if (piece.tube > 0.0 || piece.end_ns <= piece.start_ns) return std::nullopt;
  const bool point_is_a = a.triangleCount() == 0;
  const Body &single = point_is_a ? a : b, &mesh = point_is_a ? b : a;
  if (single.triangleCount() != 0 || single.elementCount() != 1) return std::nullopt;
  if (mesh.triangleCount() == 0 || mesh.triangleCount() != mesh.elementCount()) return std::nullopt;
  const motion::RigidMotion &flies = point_is_a ? piece.a : piece.b, &rests = point_is_a ? piece.b : piece.a;
  if (!flies.isStraight() || !rests.isStraight() || rests.turns()) return std::nullopt;
  const Element& point = single.primitive(0);
  if (point.vertices == nullptr || point.count != 1) return std::nullopt;
  if (flies.turns() && !isZero(point.vertices[0])) return std::nullopt;
  const double speed2 = (flies.c[1] - rests.c[1]).squaredNorm();
  if (!(speed2 > kSlowest * kSlowest && speed2 < kInfinity)) return std::nullopt;
  return std::optional<StraightPath>(std::in_place, Pair{a, b, piece, contact_distance, point_is_a});
}

StraightPath::StraightPath(const Pair& pair)
    : mesh_(pair.point_is_a ? &pair.b : &pair.a),
      single_(pair.point_is_a ? &pair.a : &pair.b),
      bvh_(&mesh_->wideBvh()),
      point_is_a_(pair.point_is_a),
      line_(pair.piece.a, pair.piece.b, pair.piece.start_ns, pair.piece.end_ns),
      contact_distance_(pair.contact_distance) {
  const motion::RigidMotion &flies = point_is_a_ ? pair.piece.a : pair.piece.b,
                            &rests = point_is_a_ ? pair.piece.b : pair.piece.a;
  const Element& point = single_->primitive(0);
  const Vec3& vertex = point.vertices[0];
  radius_ = point.radius + contact_distance_;
  const double sign = point_is_a_ ? -1.0 : 1.0;
  p_ = sign * line_.d;
  v_ = sign * line_.rate;
  if (!isZero(vertex)) p_ += flies.q0.normalized().toRotationMatrix() * vertex;
  turned_ = !motion::areZero(rests.q0.coeffs().data(), 3);
  if (turned_) {
    to_world_ = rests.q0.normalized().toRotationMatrix();
    p_ = to_world_.transpose() * p_;
    v_ = to_world_.transpose() * v_;
  }
  frame_.follow(p_, v_);
  setBudget(pair.piece);
}

/// PairPiece's, for bodies that do not turn: the spin of a vertex at its own origin moves nothing. The
/// distance of the origins is convex in time, so its ends bound it.
void StraightPath::setBudget(const Piece& piece) {
  const double reach = mesh_->reach() + single_->reach(), duration = line_.duration;
  const Vec3 end = line_.d + duration * line_.rate;
  speed_ = line_.rate.norm() * kUp;
  max_distance_ = std::sqrt(std::max(line_.d.squaredNorm(), end.squaredNorm())) * kUp;
  const Vec3 &rate_a = piece.a.c[1], &rate_b = piece.b.c[1];
  // Where one stands, the other's speed is the relative one.
  const bool a_stands = isZero(rate_a), b_stands = isZero(rate_b);
  const double speed_a = a_stands ? 0.0 : b_stands ? speed_ : rate_a.norm() * kUp;
  const double speed_b = b_stands ? 0.0 : a_stands ? speed_ : rate_b.norm() * kUp;
  const double magnitude =
      (piece.b.c[0] - piece.a.c[0]).norm() + 2.0 * speed_ * line_.reach + speed_a * std::abs(line_.shift);
  const double translation =
      kUnit * (motion::kTermRounding * magnitude + motion::kLineRounding * line_.reach * (speed_a + speed_b));
  const double distance = max_distance_ + reach + contact_distance_;
  point_error_ = 2.0 * (translation + kTurnError * reach + mesh_->placingError() + single_->placingError()) +
                 64.0 * kUnit * (distance + speed_ * duration);
  size_ = 2.0 * (max_distance_ + reach);
  error_ = 2.0 * (point_error_ + 2.0 * kTurnError * distance) + 16.0 * kUnit * size_;

  // A line that is off by the error at both ends of the piece is off by more beyond them, where triangles
  // that it meets in the piece may have vertices.
  const double middle = (bvh_->centre()[frame_.kz] - frame_.origin[2]) * frame_.per_rate,
               half = bvh_->half()[frame_.kz] * std::abs(frame_.per_rate);
  const double beyond = std::max(0.0, std::max(half - middle, middle + half - duration)) / duration;
  frame_.error = 2.0 * error_ * (1.0 + 2.0 * beyond) + 16.0 * kUnit * size_;
}

bool StraightPath::startsOutside() const {
  const Vec3 beyond = (p_ - bvh_->centre()).cwiseAbs() - bvh_->half();
  return beyond.maxCoeff() > radius_ + error_ + 8.0 * kUnit * size_;
}

void StraightPath::first(double from, double to, double width, PathContact& contact, Lanes lanes) const {
  contact.kind = PathContact::Kind::kClear;
  contact.count = 0;
  contact.tests = 0;
  if (radius_ > 0.0) {
    firstOfSphere(from, to, width, contact, lanes);
  } else {
    firstOfPoint(from, to, width, contact, lanes);
  }
  // Near the rounding budget the general search brackets more closely.
  if (contact.kind == PathContact::Kind::kContact &&
      contact.upper - contact.lower > std::max(width, 8.0 * point_error_ / speed_)) {
    contact.kind = PathContact::Kind::kCannotTell;
  }
}

}  // namespace collision_node::impact
