/// near_support.h against support functions in extended precision: the cone by trying normals, the disc by
/// points of both cores.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "collision_node/impact/convex/near_support.h"
#include "test/impact/moving_pair.h"

namespace collision_node::impact {
namespace {

using moving::Random;
using Real = long double;
using Real3 = Eigen::Matrix<Real, 3, 1>;

constexpr std::uint64_t kSeed = 4711;

geometry::PlacedShape shapeOf(Random& random) {
  geometry::PlacedShape out;
  out.source = "random";
  if (random.chance(0.5)) out.origin = {moving::randomVec(random, 0.5), random.orientation()};
  const auto length = [&] { return random.decade(-1, 0.3); };
  const int kind = random.below(3);
  if (kind == 0) out.shape = geometry::Box{{length(), length(), length()}};
  if (kind == 1) out.shape = geometry::Cylinder{length(), length()};
  if (kind == 2) out.shape = geometry::Capsule{length(), length()};
  return out;
}

/// A core in world axes: what the element says, in extended precision.
struct Truth {
  Real3 centre, axis[3];
  Real half[3];
  bool round;

  Truth(const PosedCore& core) : round(core.element->vertices == nullptr) {
    const Element& e = *core.element;
    centre = (core.origin.cast<Real>() + core.rotation->cast<Real>() * e.frame->centre.cast<Real>()).eval();
    for (int k = 0; k < 3; ++k) {
      axis[k] = core.rotation->cast<Real>() * e.frame->axes.col(k).cast<Real>();
      half[k] = round ? (k < 2 ? e.rim_radius : e.half_length) : e.frame->half[k];
    }
  }
  /// max u . (x - centre)
  Real reach(const Real3& u) const {
    const Real x = u.dot(axis[0]), y = u.dot(axis[1]), z = std::abs(u.dot(axis[2])) * half[2];
    if (round) return half[0] * std::sqrt(x * x + y * y) + z;
    return std::abs(x) * half[0] + std::abs(y) * half[1] + z;
  }
  /// Some point within `depth` of the support plane across `up`.
  Real3 pointNear(const Real3& up, Real depth, Random& random) const {
    Real3 x = centre;
    Real left = depth;
    const int first = random.below(3);
    for (int i = 0; i < 3; ++i) {
      const int k = (first + i) % 3;
      if (round && k < 2) continue;
      const Real slope = up.dot(axis[k]), most = 2 * half[k] * std::abs(slope);
      const Real in = random.chance(0.4) ? random.in(0, 1) : random.decade(-6, 0);
      const Real share = most > left ? in * left / most : in;
      left -= most * share;
      x += axis[k] * half[k] * (slope < 0 ? -1 : 1) * (1 - 2 * share);
    }
    if (!round) return x;
    Real3 side = up - axis[2] * up.dot(axis[2]);
    side -= axis[2] * side.dot(axis[2]);  // the axis is unit to rounding only
    const Real radial = side.norm();
    if (radial > 1e-16L)
      side /= radial;
    else
      side = axis[0];
    const Real3 other = axis[2].cross(side);
    const Real part = std::min<Real>(2, radial > 0 ? left / (half[0] * radial) : 2);  // 1 - cosine
    const Real down = part * (random.chance(0.4) ? random.in(0, 1) : random.decade(-6, 0));
    const Real sine = std::sqrt(down * (2 - down)) * random.in(-1, 1);
    return x + half[0] * ((1 - down) * side + sine * other);
  }
};

/// Two cores that about touch across n, most often with features along it.
struct Contact {
  geometry::Body a, b;
  Instant now;
  Vec3 n, near_a, near_b;
  Element ea, eb;

  explicit Contact(Random& random) : a({shapeOf(random)}), b({shapeOf(random)}) {
    ea = a.primitive(0);
    eb = b.primitive(0);
    now.ra = random.orientation().toRotationMatrix();
    now.rb = random.orientation().toRotationMatrix();
    now.d = now.d_rate = Vec3::Zero();
    const Mat3 ua = now.ra * ea.frame->axes, ub = now.rb * eb.frame->axes;
    const int kind = random.below(5), i = random.below(3), j = random.below(3);
    n = kind == 0   ? random.direction()
        : kind == 1 ? Vec3(ua.col(i))
        : kind == 2 ? Vec3(ub.col(i))
        : kind == 3 ? ua.col(i).cross(ub.col(j)).normalized()
                    : Vec3(ua.col(i).unitOrthogonal());
    if (random.chance(0.5)) n = (n + random.decade(-15, -6) * random.direction()).normalized();
    const Real3 up = n.cast<Real>();
    Cores cores(now, ea, eb);
    const Vec3 x = Truth(cores.a).pointNear(up, 1e-12L, random).cast<double>(),
               y = Truth(cores.b).pointNear(-up, 1e-12L, random).cast<double>();
    now.d = x - y + (random.chance(0.3) ? random.in(0, 0.3) : 0.0) * n;
    near_a = x + random.decade(-12, -4) * random.direction();
    near_b = y + now.d + random.decade(-12, -4) * random.direction();
  }
};

TEST(NearSupport, TheConeHoldsEveryNormalThatStillParts) {
  // "every unit n' with n' . (w - gap n) >= -moved for all differences w = b - a of the cores' points"
  int answered = 0, asked = 0;
  Real tightest = 0;
  for (int i = 0; i < 3000; ++i) {
    Random random(kSeed, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " index " + std::to_string(i));
    const Contact contact(random);
    const Cores cores(contact.now, contact.ea, contact.eb);
    const double moved = random.decade(-11, -5);
    const NearPair near(cores, contact.n);
    const bool forward = random.chance(0.3);
    ++asked;
    const auto cone = near.normalCone(moved, contact.near_a, contact.near_b, forward);
    if (!cone) continue;
    ++answered;
    const Truth a(cores.a), b(cores.b);
    const Real3 n = contact.n.cast<Real>().normalized(), e1 = n.unitOrthogonal(), e2 = n.cross(e1);
    const Real3 between = b.centre - a.centre;
    const Real gap = between.dot(n) - a.reach(n) - b.reach(n);
    ASSERT_NEAR(near.gap(), gap, 1e-14);
    Real widest = 0;
    for (int k = 0; k < 60; ++k) {
      const Real turn = random.in(0, 6.283185307179586);
      const Real3 e = std::cos(turn) * e1 + std::sin(turn) * e2;
      for (Real angle = forward ? 1.57L : 3.1415L; angle > *cone / 16; angle /= 1.02L) {
        const Real3 normal = std::cos(angle) * n + std::sin(angle) * e;
        const Real parted = between.dot(normal) - a.reach(normal) - b.reach(normal);
        if (parted - gap * std::cos(angle) < -moved) continue;
        widest = std::max(widest, angle);
        break;
      }
    }
    tightest = std::max(tightest, widest / *cone);
    ASSERT_LE(widest, *cone) << "moved " << moved;
  }
  std::printf("%d of %d cones told, true ones up to %.3Lf of them\n", answered, asked, tightest);
  EXPECT_GT(answered, asked / 3);
  EXPECT_GT(tightest, 0.9L) << "a cone that is never nearly needed would hide one that is too wide";
}

TEST(NearSupport, TheDiscHoldsWhatBothCoresMayShare) {
  // "everything within `moved_a` of A's points at most `depth` below its support plane and within `moved_b`
  // of B's"
  int answered = 0, asked = 0;
  Real widest = 0;
  for (int i = 0; i < 20000; ++i) {
    Random random(kSeed + 1, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed + 1) + " index " + std::to_string(i));
    const Contact contact(random);
    const Cores cores(contact.now, contact.ea, contact.eb);
    const double depth = random.decade(-10, -3), moved_a = depth * random.decade(-1, 0.5),
                 moved_b = depth * random.decade(-1, 0.5);
    const NearPair near(cores, contact.n);
    Vec3 place;
    double radius = 0;
    ++asked;
    if (!near.commonDisc(depth, 3.0, 3.0, moved_a, moved_b, &place, &radius)) continue;
    ++answered;
    const Truth a(cores.a), b(cores.b);
    const Real3 n = contact.n.cast<Real>().normalized();
    ASSERT_NEAR(contact.n.dot(place), double(a.centre.dot(n) + a.reach(n)), 1e-14);
    for (int k = 0; k < 100; ++k) {
      const Real3 x = a.pointNear(n, depth, random), y = b.pointNear(-n, depth, random);
      ASSERT_LE(a.centre.dot(n) + a.reach(n) - x.dot(n), depth * (1 + 1e-6L) + 1e-14L);
      Real3 across = y - x;
      across -= n * n.dot(across);
      if (across.norm() > moved_a + moved_b) continue;
      // The farthest both can share along a line away from the disc's middle.
      const Real3 shared = x + across * (moved_a / Real(moved_a + moved_b));
      Real3 off = shared - place.cast<Real>();
      off -= n * n.dot(off);
      widest = std::max(widest, off.norm() / radius);
      ASSERT_LE(off.norm(), radius * (1 + 1e-12L));
    }
  }
  std::printf("%d of %d discs told, filled up to %.3Lf\n", answered, asked, widest);
  EXPECT_GT(answered, asked / 3);
  EXPECT_GT(widest, 0.8L);
}

TEST(NearSupport, TheTurnOfTheNormalKeepsARimsShare) {
  // A cylinder's support moves round its rim by no more than the normal's lean lets it.
  for (int i = 0; i < 5000; ++i) {
    Random random(kSeed + 2, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed + 2) + " index " + std::to_string(i));
    const geometry::Body body(
        {moving::placed(geometry::Cylinder{random.decade(-1, 0), random.decade(-1, 0)})});
    Instant now;
    now.ra = now.rb = random.orientation().toRotationMatrix();
    now.d = Vec3::Zero();
    const Element e = body.primitive(0);
    const PosedCore core{&e, &now.ra, Vec3::Zero()};
    const Truth truth(core);
    const Vec3 up = random.direction();
    const double tilt = random.decade(-8, -1);
    const Vec3 lean = up.cross(random.direction()).normalized();
    const Vec3 other = (std::cos(tilt) * up + std::sin(tilt) * lean).normalized();
    const Vec3 support = core.place(core.supportLocal(other));
    const double depth = double(truth.reach(up.cast<Real>()) - up.dot(support)) * 1.000001 + 1e-15;
    const NearSupport::Cap cap = NearSupport(core, up).cap(depth, tilt);
    ASSERT_LE((support - cap.centre).norm(), cap.radius() * (1 + 1e-9) + 1e-13);
  }
}

TEST(NearSupport, FeaturesAreThoseOfTheCorners) {
  // "The vertex, edge or face that is within `depth`": counted corner by corner.
  for (int i = 0; i < 5000; ++i) {
    Random random(kSeed + 3, i);
    SCOPED_TRACE("seed " + std::to_string(kSeed + 3) + " index " + std::to_string(i));
    const Contact contact(random);
    const Cores cores(contact.now, contact.ea, contact.eb);
    if (contact.ea.vertices == nullptr) continue;
    const double depth = random.decade(-9, -1);
    const NearSupport near(cores.a, contact.n);
    int held = 0;
    for (int k = 0; k < contact.ea.count; ++k)
      held += near.top() - contact.n.dot(cores.a.place(contact.ea.vertices[k])) <= depth;
    const Feature counted = held <= 1 ? Feature::kVertex : held == 2 ? Feature::kEdge : Feature::kFace;
    ASSERT_EQ(near.feature(depth), counted) << held;
  }
}

}  // namespace
}  // namespace collision_node::impact
