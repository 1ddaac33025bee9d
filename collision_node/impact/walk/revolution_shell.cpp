#include "collision_node/impact/walk/revolution_shell.h"

#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cmath>
#include <limits>

#include "collision_node/impact/walk/search.h"

namespace collision_node::impact {
namespace {

constexpr double kTurn = 7.0;  ///< [rad] a little over a turn: from here on the shell stands for the body
constexpr std::size_t kMostNodes = 1024;  ///< looked at for one body's extents
constexpr double kTestsPerRadian =
    16.0;                      ///< spent on the shells at most: in proportion to what they may save
constexpr int kHalvings = 10;  ///< of the time after the last possible contact

void add(Revolution& r, const Vec3& axis, const Vec3& centre, double along, double across) {
  const double z = axis.dot(centre);
  r.lowest = std::min(r.lowest, z - along);
  r.highest = std::max(r.highest, z + along);
  r.radius = std::max(r.radius, (centre - z * axis).norm() + across);
}

void add(Revolution& r, const Vec3& axis, const Element& e) {
  if (e.vertices != nullptr) {
    for (int i = 0; i < e.count; ++i) add(r, axis, e.vertices[i], e.radius, e.radius);
    return;
  }
  // Every point of a cap is within the rim's radius of its centre; between the caps lies their hull.
  const double tilt = e.axis.cross(axis).norm();
  const double along = e.rim_radius * tilt + e.radius;
  for (const double side : {-1.0, 1.0}) {
    add(r, axis, e.centre + side * e.half_length * e.axis, along, e.rim_radius + e.radius);
  }
}

void add(Revolution& r, const Vec3& axis, const Vec3& centre, const Vec3& half) {
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                      i & 4 ? half.z() : -half.z());
    add(r, axis, centre + corner, 0.0, 0.0);
  }
}

/// The body about its spin axis, grown by `slack` [m]: a cylinder along z.
const Body* shellOf(const Body& body, const Vec3& axis, double slack, std::unique_ptr<Body>& shell) {
  if (!shell) {
    geometry::PlacedShape any;
    any.shape = geometry::Cylinder{1.0, 1.0};
    any.source = "shell";
    shell = std::make_unique<Body>(std::vector<geometry::PlacedShape>{any});
  }
  const Revolution r = revolve(body, axis);
  shell->resize({r.radius + slack, (r.highest - r.lowest) + 2.0 * slack},
                Vec3(0.0, 0.0, 0.5 * (r.lowest + r.highest)));
  return shell.get();
}

}  // namespace

Revolution revolve(const Body& body, const Vec3& axis) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Revolution r{0.0, kInfinity, -kInfinity};
  // Breadth first: the boxes of the last level reached stand for everything below them.
  constexpr std::int32_t kWidth = geometry::BvhBlock::kWidth;
  const geometry::Bvh& bvh = body.bvh();
  using Level = boost::container::static_vector<std::int32_t, kMostNodes>;
  Level level = {geometry::Bvh::kRoot};
  Vec3 buffer[3];
  while (!level.empty()) {
    const bool deeper = kWidth * level.size() <= kMostNodes;
    Level next;
    for (const std::int32_t id : level) {
      const geometry::BvhNode node = bvh[id];
      if (node.leaf()) {
        add(r, axis, body.element(node.element(), buffer));
      } else if (deeper) {
        for (std::int32_t i = 0; i < kWidth; ++i) {
          if (bvh.exists(kWidth * node.link + i)) next.push_back(kWidth * node.link + i);
        }
      } else {
        add(r, axis, bvh.centre(id), bvh.half(id));
      }
    }
    level = next;
  }
  const double pad = 64.0 * kUnit * body.reach();
  return {r.radius * kUp + pad, r.lowest - pad, r.highest + pad};
}

ShellPair::ShellPair(const Body* a, const Body* b, const PairPiece& piece, std::uint64_t node_budget)
    : still_(a != nullptr ? *a : piece.a, b != nullptr ? *b : piece.b,
             piece.motion.stilled(a != nullptr, b != nullptr), piece.contact_distance, piece.tube),
      budget_(static_cast<std::uint64_t>(std::min(
          static_cast<double>(node_budget),
          kTestsPerRadian * piece.motion.duration() * (piece.motion.spinA() + piece.motion.spinB())))) {}

std::optional<ShellPair> ShellPair::of(const PairPiece& piece, std::uint64_t node_budget,
                                       ShellBodies& bodies) {
  const RelativeMotion& m = piece.motion;
  const bool far_a = m.spinA() * m.duration() > kTurn && piece.a.reach() > 0.0;
  const bool far_b = m.spinB() * m.duration() > kTurn && piece.b.reach() > 0.0;
  if (!far_a && !far_b) return std::nullopt;
  const Body *a = nullptr, *b = nullptr;
  // The axis in the object's frame is as good as the rotation it is seen through; so is where the body lies
  // in it.
  if (far_a) {
    const double slack = 2.0 * m.rotationErrorA() * piece.a.reach() + piece.a.placingError();
    a = shellOf(piece.a, m.rotationA(0.0).transpose() * m.omegaA().normalized(), slack, bodies.a);
  }
  if (far_b) {
    const double slack = 2.0 * m.rotationErrorB() * piece.b.reach() + piece.b.placingError();
    b = shellOf(piece.b, m.rotationB(0.0).transpose() * m.omegaB().normalized(), slack, bodies.b);
  }
  return ShellPair(a, b, piece, node_budget);
}

bool ShellPair::clear(double& from, double& to, double stop, std::uint64_t& node_tests,
                      Workspace& workspace) const {
  std::uint64_t left = budget_;
  const auto first = [&](double low, double high) {
    Search search(still_, left, workspace);
    const Search::First found = search.firstPossible(low, high, stop);
    node_tests += search.nodeTests();
    left -= std::min(left, search.nodeTests());
    return found;
  };
  const Search::First start = first(from, to);
  if (!start.found) return false;
  from = std::max(from, start.time);
  double open = from;
  for (int i = 0; i < kHalvings && open < to && left > 0; ++i) {
    const double middle = 0.5 * (open + to);
    if (first(middle, to).found) {
      open = middle;
    } else {
      to = middle;
    }
  }
  return true;
}

}  // namespace collision_node::impact
