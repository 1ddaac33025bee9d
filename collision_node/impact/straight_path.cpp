#include "collision_node/impact/straight_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace collision_node::impact {
namespace {

using Met = PathContact::Met;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kUp = 1.0 + 64.0 * kUnit;

/// The columns are the object's axes in the world.
Mat3 axesOf(const geometry::Quat& q) {
  if (q.vec().isZero(0.0)) return Mat3::Identity();
  return q.normalized().toRotationMatrix();
}

double sumOf(const Vec3& v) { return std::abs(v.x()) + std::abs(v.y()) + std::abs(v.z()); }

/// Closest point of a segment, for a triangle without area.
Vec3 closestOnSegment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const double length2 = e.squaredNorm();
  return length2 > 0.0 ? Vec3(a + std::clamp((x - a).dot(e) / length2, 0.0, 1.0) * e) : a;
}

/// A triangle as the path sees it: which side of each edge it passes, positive inside when `turn` is.
struct Seen {
  double x[3], y[3], z[3];
  double side[3], turn, error;

  Seen(const ShearedFrame& f, const Vec3* vertices, const std::int32_t* corner) {
    double size = 0.0;
    for (int k = 0; k < 3; ++k) {
      const Vec3& v = vertices[corner[k]];
      z[k] = v[f.kz] - f.origin[2];
      x[k] = (v[f.kx] - f.origin[0]) - f.shear_x * z[k];
      y[k] = (v[f.ky] - f.origin[1]) - f.shear_y * z[k];
      size = std::max({size, std::abs(x[k]), std::abs(y[k])});
    }
    error = size * (4.0 * f.error + 8.0 * kUnit * size) + 2.0 * f.error * f.error;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      side[k] = x[j] * y[i] - y[j] * x[i];
    }
    turn = side[0] + side[1] + side[2];
  }
  double least() const { return std::min({side[0], side[1], side[2]}); }
  double most() const { return std::max({side[0], side[1], side[2]}); }
};

Met metOf(const WideLeaf& leaf, int lane) {
  Met met{};
  met.element = leaf.element[lane];
  for (int k = 0; k < 3; ++k) met.vertex[k] = leaf.vertex[k][lane];
  return met;
}

/// Keeps what may be met before the earliest proof.
class Collector : public PathVisitor {
 public:
  Collector(PathContact& contact, const PathWalk& walk, double limit, bool shrinks)
      : contact_(contact), walk_(walk), limit_(limit), shrinks_(shrinks) {
    contact.count = 0;
  }
  double limit() const { return limit_; }  ///< [s] what begins after it was not looked for
  bool overflowed() const { return overflowed_; }

 protected:
  ~Collector() = default;

  float add(const Met& met, float limit) {
    if (met.lower > limit_) return limit;
    if (contact_.count == PathContact::kMost) dropLate();
    if (contact_.count == PathContact::kMost) {
      overflowed_ = true;
      return -1.0f;
    }
    contact_.met[contact_.count++] = met;
    if (!shrinks_ || !met.sure || !(met.upper < limit_)) return limit;
    limit_ = met.upper;
    return std::min(limit, walk_.parameterUp(limit_));
  }

  PathContact& contact_;
  const PathWalk& walk_;
  double limit_;

 private:
  void dropLate() {
    int kept = 0;
    for (int i = 0; i < contact_.count; ++i) {
      if (contact_.met[i].lower <= limit_) contact_.met[kept++] = contact_.met[i];
    }
    contact_.count = kept;
  }

  bool shrinks_, overflowed_ = false;
};

/// Brings to the front, and keeps, what begins at or before `end`.
void keepUntil(PathContact& contact, double end) {
  int kept = 0;
  for (int i = 0; i < contact.count; ++i) {
    if (contact.met[i].lower <= end) contact.met[kept++] = contact.met[i];
  }
  contact.count = kept;
  const auto before = [](const Met& a, const Met& b) {
    if (a.sure != b.sure) return a.sure;
    return a.lower != b.lower ? a.lower < b.lower : a.element < b.element;
  };
  std::iter_swap(contact.met, std::min_element(contact.met, contact.met + kept, before));
}

}  // namespace

Vec3 closestOnTriangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const Vec3 bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const Vec3 cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double wc = d1 * d4 - d3 * d2, wb = d5 * d2 - d1 * d6, wa = d3 * d6 - d5 * d4;
  const double whole = wa + wb + wc;
  if (wa > 0.0 && wb > 0.0 && wc > 0.0 && whole > 0.0) return a + (wb / whole) * ab + (wc / whole) * ac;
  Vec3 best = closestOnSegment(x, a, b);
  for (const Vec3& q : {closestOnSegment(x, b, c), closestOnSegment(x, c, a)}) {
    if ((x - q).squaredNorm() < (x - best).squaredNorm()) best = q;
  }
  return best;
}

/// Finds through which triangles the path passes, and when.
class StraightPath::PointVisitor final : public Collector {
 public:
  PointVisitor(const StraightPath& path, double from, double to, PathContact& contact, const PathWalk& walk,
               double limit, bool shrinks)
      : Collector(contact, walk, limit, shrinks), path_(path), from_(from), to_(to) {}

  float visit(const WideLeaf& leaf, int lane, float, float limit) override {
    Met met = metOf(leaf, lane);
    const Vec3* vertices = path_.bvh_->vertices();
    const Seen seen(path_.frame_, vertices, met.vertex);
    const double least = seen.least(), most = seen.most();
    if (least < -seen.error && most > seen.error) return limit;
    met.sure = least > seen.error || most < -seen.error;
    met.forward = seen.turn > 0.0;

    // Where the path crosses the plane, n . (x(t) - a) = 0, with all that this may be off.
    const Vec3 &a = vertices[met.vertex[0]], &b = vertices[met.vertex[1]], &c = vertices[met.vertex[2]];
    const Vec3 e1 = b - a, e2 = c - a, n = e1.cross(e2);
    const double n_error = 8.0 * kUnit * sumOf(e1) * sumOf(e2), length = n.norm();
    const double rate = n.dot(path_.v_);
    const double slowest = std::abs(rate) - (n_error + 8.0 * kUnit * length) * path_.speed_;
    // In any case between the first and the last vertex along the path.
    const auto depth = std::minmax({seen.z[0], seen.z[1], seen.z[2]});
    const auto time = std::minmax({(depth.first - path_.frame_.error) * path_.frame_.per_rate,
                                   (depth.second + path_.frame_.error) * path_.frame_.per_rate});
    met.lower = time.first;
    met.upper = time.second;
    if (slowest > 0.0) {
      const double t0 = n.dot(a - path_.p_) / rate;
      const Vec3 arm = path_.at(t0) - a;
      const double slack = std::abs(n.dot(arm)) + n_error * arm.norm() +
                           length * (path_.error_ + 8.0 * kUnit * (arm.norm() + path_.size_));
      const double dt = slack / slowest * (1.0 + 16.0 * kUnit);
      met.lower = std::max(met.lower, t0 - dt);
      met.upper = std::min(met.upper, t0 + dt);
    } else {
      met.sure = false;
    }
    if (met.lower > met.upper || met.upper <= from_ || met.lower > to_) return limit;
    return add(met, limit);
  }

 private:
  const StraightPath& path_;
  double from_, to_;
};

/// Finds when the sphere comes within reach of each triangle.
class StraightPath::SphereVisitor final : public Collector {
 public:
  SphereVisitor(const StraightPath& path, double from, double to, PathContact& contact, const PathWalk& walk)
      : Collector(contact, walk, to, true), path_(path), from_(from), to_(to) {}

  /// The distance to a convex set is convex along the path: steps to where the plane across the closest
  /// vector is reached never pass the contact, and each is a proof of what lies before it.
  float visit(const WideLeaf& leaf, int lane, float entered, float limit) override {
    constexpr int kMostSteps = 48;
    Met met = metOf(leaf, lane);
    const Vec3* vertices = path_.bvh_->vertices();
    const Vec3 &a = vertices[met.vertex[0]], &b = vertices[met.vertex[1]], &c = vertices[met.vertex[2]];
    const double error = path_.error_ + 16.0 * kUnit * path_.size_;
    double t = std::max(from_, walk_.timeDown(entered)), rate = 0.0;
    for (int step = 0; step < kMostSteps; ++step) {
      const Vec3 x = path_.at(t), w = x - closestOnTriangle(x, a, b, c);
      const double distance = w.norm();
      if (!(distance > 0.0)) break;
      const Vec3 n = w / distance;
      rate = n.dot(path_.v_);
      const double gap = std::min({n.dot(x - a), n.dot(x - b), n.dot(x - c)}) - path_.radius_ - error;
      if (!(gap > 0.0)) break;
      if (rate >= 0.0) return limit;
      const double next = t - gap / rate;
      if (next > limit_) return limit;
      if (!(next > t)) break;
      t = next;
      if (gap < 0.5 * error) break;
    }
    met.lower = t;
    met.upper = kInfinity;
    double wait = 4.0 * error;
    for (int look = 0; look < 4 && rate < 0.0; ++look, wait *= 4.0) {
      const double later = t - wait / rate;
      const Vec3 x = path_.at(later);
      if (!(later <= to_)) break;
      if ((x - closestOnTriangle(x, a, b, c)).norm() > path_.radius_ - error) continue;
      met.sure = true;
      met.upper = later;
      break;
    }
    return add(met, limit);
  }

 private:
  const StraightPath& path_;
  double from_, to_;
};

std::optional<StraightPath> StraightPath::of(const Body& a, const Body& b, const Piece& piece,
                                             double contact_distance) {
  if (piece.tube > 0.0 || piece.end_ns <= piece.start_ns) return std::nullopt;
  const bool point_is_a = a.elementCount() == 1 && a.triangleCount() == 0;
  const Body &single = point_is_a ? a : b, &mesh = point_is_a ? b : a;
  if (single.elementCount() != 1 || single.triangleCount() != 0) return std::nullopt;
  if (mesh.triangleCount() == 0 || mesh.triangleCount() != mesh.elementCount()) return std::nullopt;
  const motion::RigidMotion &flies = point_is_a ? piece.a : piece.b, &rests = point_is_a ? piece.b : piece.a;
  const auto bends = [](const motion::RigidMotion& m) { return !m.c[2].isZero(0.0) || !m.c[3].isZero(0.0); };
  if (bends(flies) || bends(rests) || !rests.omega.isZero(0.0)) return std::nullopt;
  const Element& point = single.primitive(0);
  if (point.vertices == nullptr || point.count != 1) return std::nullopt;
  if (!flies.omega.isZero(0.0) && !point.vertices[0].isZero(0.0)) return std::nullopt;
  std::optional<StraightPath> path(std::in_place, Pair{a, b, piece, contact_distance, point_is_a});
  if (!(path->speed_ > 0.0 && path->speed_ < kInfinity)) path.reset();
  return path;
}

StraightPath::StraightPath(const Pair& pair)
    : mesh_(pair.point_is_a ? &pair.b : &pair.a),
      single_(pair.point_is_a ? &pair.a : &pair.b),
      bvh_(&mesh_->wideBvh()),
      point_is_a_(pair.point_is_a),
      line_(pair.piece.a, pair.piece.b, pair.piece.start_ns, pair.piece.end_ns),
      contact_distance_(pair.contact_distance) {
  const motion::RigidMotion &a = pair.piece.a, &b = pair.piece.b;
  const Element& point = single_->primitive(0);
  const Vec3& vertex = point.vertices[0];
  radius_ = point.radius + contact_distance_;
  to_world_ = axesOf((point_is_a_ ? b : a).q0);
  const Vec3 rate = point_is_a_ ? Vec3(-line_.rate) : line_.rate;
  Vec3 start = point_is_a_ ? Vec3(-line_.d) : line_.d;
  if (!vertex.isZero(0.0)) start += axesOf((point_is_a_ ? a : b).q0) * vertex;
  p_ = to_world_.transpose() * start;
  v_ = to_world_.transpose() * rate;

  // The budget of PairPiece for bodies that do not turn: the spin of a vertex at its own origin moves
  // nothing.
  const double length = line_.rate.norm(), reach = mesh_->reach() + single_->reach();
  speed_ = length * kUp;
  max_distance_ =
      (std::min(line_.d.norm(), (line_.d + line_.duration * line_.rate).norm()) + speed_ * line_.duration) *
      kUp;
  const double distance = max_distance_ + reach + contact_distance_;
  const double translation = kUnit * (motion::kTermRounding * line_.magnitude +
                                      motion::kLineRounding * line_.reach * (a.c[1].norm() + b.c[1].norm()));
  point_error_ = 2.0 * (translation + kTurnError * reach + mesh_->placingError() + single_->placingError()) +
                 64.0 * kUnit * (distance + speed_ * line_.duration);
  size_ = 2.0 * (max_distance_ + reach);
  error_ = 2.0 * (point_error_ + 2.0 * kTurnError * distance) + 16.0 * kUnit * size_;

  frame_.follow(p_, v_);
  // A line that is off by the error at both ends of the piece is off by more beyond them, where triangles
  // that it meets in the piece may have vertices.
  const double middle = (bvh_->centre()[frame_.kz] - frame_.origin[2]) * frame_.per_rate,
               half = bvh_->half()[frame_.kz] * std::abs(frame_.per_rate);
  const double beyond = std::max({0.0, half - middle, middle + half - line_.duration}) / line_.duration;
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

void StraightPath::firstOfPoint(double from, double to, double width, PathContact& contact,
                                Lanes lanes) const {
  const PathWalk walk(*bvh_, frame_, p_, v_, from, to, error_, 0.0);
  constexpr int kMostWalks = 4;
  double limit = to;
  for (int walks = 0; walks < kMostWalks; ++walks) {
    PointVisitor visitor(*this, from, to, contact, walk, limit, walks == 0);
    contact.tests += walkPath(*bvh_, walk, walks == 0 ? 1.0f : walk.parameterUp(limit), visitor, lanes);
    contact.kind = PathContact::Kind::kCannotTell;
    contact.lower = contact.upper = from;
    if (visitor.overflowed()) return;
    if (contact.count == 0) {
      contact.kind = PathContact::Kind::kClear;
      return;
    }
    // Whatever overlaps the earliest, and what overlaps that, is one contact.
    double lower = kInfinity, end = -kInfinity;
    for (int i = 0; i < contact.count; ++i) lower = std::min(lower, contact.met[i].lower);
    for (double last = lower; last != end;) {
      end = last;
      for (int i = 0; i < contact.count; ++i) {
        if (contact.met[i].lower <= end) last = std::max(last, contact.met[i].upper);
      }
    }
    if (end > visitor.limit() && end <= to) {  // what overlaps it has not all been seen
      limit = end;
      continue;
    }
    contact.lower = std::max(lower, from);
    if (lower < from || end > to) return;
    keepUntil(contact, end);
    const Met& shown = contact.met[0];
    if (end - lower > std::max(width, 8.0 * (shown.upper - shown.lower))) return;
    if (!shown.sure && !provesPassage(contact)) return;
    contact.upper = end;
    contact.kind = PathContact::Kind::kContact;
    return;
  }
}

/// The triangles' border, seen along the path, winds around it: it passes through one of them. Edges that two
/// of them share cancel, whatever the sign of what was computed for them.
bool StraightPath::provesPassage(const PathContact& contact) const {
  struct Edge {
    std::int32_t from, to;
    double side, error;
  };
  for (const int wound : {0, 1, -1}) {  // each turned towards the path; all as loaded; all the other way
    Edge border[3 * PathContact::kMost];
    int count = 0;
    for (int i = 0; i < contact.count; ++i) {
      const Met& met = contact.met[i];
      const Seen seen(frame_, bvh_->vertices(), met.vertex);
      const bool turned = wound == 0 ? seen.turn < 0.0 : wound < 0;
      for (int k = 0; k < 3; ++k) {
        Edge edge{met.vertex[(k + 1) % 3], met.vertex[(k + 2) % 3], seen.side[k], seen.error};
        if (turned) {
          std::swap(edge.from, edge.to);
          edge.side = -edge.side;
        }
        const auto opposite = std::find_if(
            border, border + count, [&](const Edge& e) { return e.from == edge.to && e.to == edge.from; });
        if (opposite != border + count) {
          *opposite = border[--count];
        } else {
          border[count++] = edge;
        }
      }
    }
    if (count > 0 && std::all_of(border, border + count, [](const Edge& e) { return e.side > e.error; }))
      return true;
  }
  return false;
}

void StraightPath::firstOfSphere(double from, double to, double width, PathContact& contact,
                                 Lanes lanes) const {
  const double tube = radius_ + 2.0 * error_ + 32.0 * kUnit * size_;
  const double sheared = tube *
                         std::sqrt(1.0 + frame_.shear_x * frame_.shear_x + frame_.shear_y * frame_.shear_y) *
                         (1.0 + 1e-12);
  const PathWalk walk(*bvh_, frame_, p_, v_, from, to, tube, sheared);
  SphereVisitor visitor(*this, from, to, contact, walk);
  contact.tests += walkPath(*bvh_, walk, 1.0f, visitor, lanes);
  keepUntil(contact, visitor.limit());
  if (contact.count == 0 && !visitor.overflowed()) return;
  contact.kind = PathContact::Kind::kCannotTell;
  contact.lower = contact.upper = from;
  if (visitor.overflowed() || !contact.met[0].sure) return;
  contact.lower = contact.upper = contact.met[0].upper;
  for (int i = 0; i < contact.count; ++i) {
    contact.lower = std::min(contact.lower, contact.met[i].lower);
    contact.upper = std::min(contact.upper, contact.met[i].upper);
  }
  const double own = contact.met[0].upper - contact.met[0].lower;
  if (contact.upper - contact.lower <= std::max(width, 8.0 * own)) contact.kind = PathContact::Kind::kContact;
}

}  // namespace collision_node::impact
