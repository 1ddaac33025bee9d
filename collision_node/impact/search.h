/// Where in time can two bodies touch? A depth-first walk over both hierarchies with time clipping.
///
/// Guarantee: a time that firstPossible() passes over, and an instant that classify() calls apart, is proved
/// free of contact between surfaces (closed meshes may hold each other: inside.h). Everything else is
/// reported, never dropped. Source of the walk and its bounds: docs/solver.md, "The node test".
#pragma once

#include <vector>

#include "collision_node/impact/contact_proof.h"
#include "collision_node/impact/gap_model.h"
#include "collision_node/impact/straight_path.h"

namespace collision_node::impact {

struct ElementPair {
  std::int32_t a = -1, b = -1;
};

/// What is proved of one instant.
enum class Proved { kApart, kContact, kNothing };

class Search {
 public:
  Search(const PairPiece& piece, std::uint64_t node_budget)
      : piece_(piece), budget_(node_budget), straight_(StraightPath::of(piece)) {}

  struct First {
    bool found = false;
    double time = 0.0;  ///< [from, time) is proved free
    ElementPair pair;   ///< what could not be proved apart there; -1 when the budget ran out
  };

  /// The first time in [from, to] that is not proved free. Steps shorter than `stop` are not refined further.
  First firstPossible(double from, double to, double stop);

  /// The pair as a straight path, if it is one; null otherwise.
  const StraightPath* straight() const { return straight_ ? &*straight_ : nullptr; }
  /// The proof, where the last firstPossible() ended with a proved contact at `time` on a straight path; else
  /// null.
  const PathContact* provedAt(double time) const;

  /// Surfaces, then solids, at one instant. kContact fills `witness`; with a horizon > 0 the witness is,
  /// among those found, the one that provably lasts longest within [t, t + horizon].
  Proved classify(double t, ContactWitness* witness, double horizon = 0.0);

  /// Pairs of elements not proved apart throughout [from, to], at most `limit`.
  std::vector<ElementPair> nearPairs(double from, double to, std::size_t limit);

  /// No point of one body can come within reach of the other at any time of the piece.
  bool outOfReach() const;

  void countTest() { ++node_tests_; }
  bool exhausted() const { return node_tests_ > budget_; }
  std::uint64_t nodeTests() const { return node_tests_; }
  std::uint64_t subdivisions() const { return subdivisions_; }
  const PairPiece& piece() const { return piece_; }

 private:
  /// Linear models of the relative motion in both bodies' frames about the middle of a time slab.
  struct Slab {
    double middle, half;
    Vec3 p0, p1, back_p0, back_p1;
    Mat3 q0, q1, extent;            ///< extent >= |Q(s)| entrywise on the slab
    double bend_a, bend_b, bend_q;  ///< |x''| <= bend_a + bend_q |y| in A's frame, bend_b in B's
    double turn;                    ///< |omega_b - omega_a|
    std::int32_t early = -1;        ///< children: early, early + 1
  };
  struct Item {
    std::int32_t a, b, slab;
    double low, high;
  };

  std::int32_t addSlab(double low, double high);
  std::int32_t childOf(std::int32_t slab, bool late);
  bool clip(Item& item) const;
  bool prepare(Item& item);
  double advance(const Element& a, const Element& b, double from, double to, double stop);
  bool longestLasting(double t, double horizon, const std::vector<ContactWitness>& found,
                      ContactWitness* witness);

  template <typename Leaf>
  void walk(double from, double to, Leaf&& leaf);

  const PairPiece& piece_;
  std::uint64_t budget_, node_tests_ = 0, subdivisions_ = 0;
  std::optional<StraightPath> straight_;
  PathContact path_contact_;
  std::vector<Slab> slabs_;
  std::vector<Item> stack_;
};

}  // namespace collision_node::impact
