/// A fast spinning body as the solid that all its turns sweep: without spin, so a near miss of a thousand
/// turns costs what one of none does.
///
/// Guarantee: outside the time that clear() leaves, the two bodies are proved farther apart than the contact
/// distance. Derivation: docs/solver.md, "The shell of revolution". Source: the element's own turn as in
/// conservative advancement (X. Zhang, M. Lee, Y. Kim 2006), taken over whole turns.
#pragma once

#include <memory>
#include <optional>

#include "collision_node/impact/pair_piece.h"
#include "collision_node/impact/workspace.h"

namespace collision_node::impact {

/// Extents about an axis through the object's origin, all points of the body inside. [m]
struct Revolution {
  double radius = 0.0;
  double lowest = 0.0, highest = 0.0;  ///< along the axis
};

/// `axis`: unit, object's frame. Looks at no more than some hundred nodes; boxes stand for what lies below.
Revolution revolve(const Body& body, const Vec3& axis);

/// Two cylinders that any shells are made of; null until a body turns far.
struct ShellBodies {
  std::unique_ptr<Body> a, b;
};

/// The pair with every body that turns far replaced by its shell.
class ShellPair {
 public:
  /// None when neither body turns by more than about a turn in the piece. `bodies` become its shells.
  static std::optional<ShellPair> of(const PairPiece& piece, std::uint64_t node_budget, ShellBodies& bodies);

  /// Narrows [from, to] to what is not proved clear; false when nothing is left. Adds to `node_tests`.
  /// `workspace` is not that of the search which asks.
  bool clear(double& from, double& to, double stop, std::uint64_t& node_tests, Workspace& workspace) const;

 private:
  /// A shell that is null stands for the body itself.
  ShellPair(const Body* a, const Body* b, const PairPiece& piece, std::uint64_t node_budget);

  PairPiece still_;
  std::uint64_t budget_;  ///< node tests; what they leave open is searched anyway
};

}  // namespace collision_node::impact
