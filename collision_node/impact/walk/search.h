/// Where in time can two bodies touch? A walk over both hierarchies, nearest in time first, with time
/// clipping.
///
/// Guarantee: a time that firstPossible() passes over, and an instant that classify() calls apart, is proved
/// free of contact between surfaces (closed meshes may hold each other: inside.h). Everything else is
/// reported, never dropped, as long as exhausted() is false. Source of the walk and its bounds:
/// docs/solver.md, "The node test".
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "collision_node/impact/convex/contact_view.h"
#include "collision_node/impact/convex/pair_steps.h"
#include "collision_node/impact/proof/contact_proof.h"
#include "collision_node/impact/proof/inside.h"
#include "collision_node/impact/straight/straight_path.h"
#include "collision_node/impact/walk/agenda.h"
#include "collision_node/impact/walk/node_test.h"
#include "collision_node/impact/walk/revolution_shell.h"
#include "collision_node/impact/workspace.h"

namespace collision_node::impact {

struct ElementPair {
  std::int32_t a = -1, b = -1;
};

/// More are never asked for.
using NearPairs = boost::container::static_vector<ElementPair, 64>;

/// What is proved of one instant.
enum class Proved { kApart, kContact, kNothing };

class Search {
 public:
  /// `straight` is the pair as a path, where it is one.
  Search(const PairPiece& piece, std::uint64_t node_budget, Workspace& workspace,
         std::optional<StraightPath> straight = std::nullopt);

  struct First {
    bool found = false;
    double time = 0.0;  ///< [from, time) is proved free
    ElementPair pair;   ///< what could not be proved apart there; -1 when the budget ran out
  };

  /// The first time in [from, to] that is not proved free, for a bracket that is to be about `width` wide:
  /// what parts the pair for less than a tenth of that does not part it. With a window, nearPairs() of times
  /// in [first.time, first.time + window) needs no walk of its own.
  First firstPossible(double from, double to, double width, double window = 0.0);

  /// The pair as a straight path, if it is one; null otherwise.
  const StraightPath* straight() const { return straight_ ? &*straight_ : nullptr; }
  /// The proof, where the last firstPossible() ended with a proved contact at `time` on a straight path; else
  /// null.
  const PathContact* provedAt(double time) const;

  /// What parted the pair until the last firstPossible() stopped, where that was at `time` or less than its
  /// window before; else null.
  const Parting* partingAt(double time, ElementPair pair) const;

  /// About the closest points of the pair by which it stopped, at a time behind; else none.
  Closest closestAt(double time, ElementPair pair) const;

  /// Surfaces, then solids, at one instant. kContact fills `witness`; with a horizon > 0 the witness is,
  /// among those found, the one that provably lasts longest within [t, t + horizon].
  Proved classify(double t, ContactWitness* witness, double horizon = 0.0);

  /// Where classify() has just said kNothing at `t`: is a point of what is too narrow to be proved to touch a
  /// surface proved to be inside a solid? Then `witness` is filled. Such proofs do not last.
  bool holdsHidden(double t, ContactWitness* witness);

  /// What classify() says, for the surfaces of one pair of elements, which need no walk.
  Proved classifyPair(double t, ElementPair pair, ContactWitness* witness);

  /// Of the last firstPossible(): about how fast the gap closes at its end, along the axis that parted the
  /// pair last; 0 where none did. [m/s]
  double closingSpeed(const First& last);

  /// Pairs of elements not proved apart throughout [from, to], at most `limit` (<= 64), without `known`.
  /// These are not all where there are `limit` of them, or when exhausted() is true.
  NearPairs nearPairs(double from, double to, std::size_t limit, ElementPair known = {});

  /// Are all pairs of elements proved apart throughout [from, to]?
  bool provesApart(double from, double to) { return nearPairs(from, to, 1).empty() && !exhausted(); }

  /// The part of the piece's time outside of which no point of one body can come within reach of the other.
  const Span& withinReach() const { return reach_; }

  /// The piece's instant; those near to the last one cost little.
  const Instant& at(double t);

  void countTests(std::uint64_t count) { node_tests_ += count; }
  bool exhausted() const { return node_tests_ > budget_ || slabs_.areMany(); }
  std::uint64_t nodeTests() const { return node_tests_; }
  std::uint64_t subdivisions() const { return slabs_.subdivisions(); }
  const PairPiece& piece() const { return piece_; }

 private:
  using Item = Agenda::Item;

  /// What is to be done with an item.
  struct Todo {
    enum Kind { kElements, kHalve, kTest } kind;
    int parent;            ///< kTest: whose children are tested with the other's node, 0 for A's
    std::int32_t link[2];  ///< BvhNode::link
  };

  /// A pair that is proved apart before `time`.
  struct Near {
    ElementPair pair;
    double time;
    Parting parting;  ///< invalid axis: none
  };

  Span reachOf(const PairPiece& piece) const;
  Todo todo(Item& item);
  void pushChildren(const Item& item, const Todo& todo, unsigned lanes, const Span spans[], double until);
  Proved classifyElements(const Instant& now, const Element& a, const Element& b, const Closest& start,
                          ContactWitness& witness) const;
  /// Of what classify() found: what lasts longest.
  bool longestLasting(double t, double horizon, ContactWitness* witness);

  /// `by_time`: what begins sooner is looked at first.
  template <typename Leaf>
  void walk(double from, double to, bool by_time, Leaf&& leaf);

  const PairPiece& piece_;
  const geometry::Bvh* const tree_[2];  ///< A's and B's
  const Span reach_;
  const NodeTest test_;
  std::uint64_t budget_, node_tests_ = 0;
  std::optional<ShellPair> shells_;  ///< none when nothing turns far
  Workspace* workspace_of_shells_;
  std::optional<StraightPath> straight_;
  PathContact path_contact_;
  TimeSlabs slabs_;
  Agenda& agenda_;
  /// Every pair of elements that is not proved apart throughout [near_from_, near_all_to_] is among these,
  /// and of those that are not up to near_to_ some.
  std::vector<Near>& near_;
  std::vector<ContactWitness>& found_;  ///< by classify()
  double near_from_ = std::numeric_limits<double>::infinity(), near_all_to_ = 0.0, near_to_ = 0.0;
  double stopped_at_ = std::numeric_limits<double>::infinity();  ///< the last firstPossible()
  ElementPair stopped_by_;             ///< and which pair it could not part any longer
  Closest stopped_closest_;            ///< their closest points, about
  Vec3 stopped_along_ = Vec3::Zero();  ///< what parted them last, from A to B; zero: nothing did
  HiddenPoints hidden_;                ///< of the last classify()
  Instant computed_, near_it_;         ///< of at(): the last one as a whole, and the last one near to that
  bool has_computed_ = false;

  friend struct Workspace::Buffers;
};

/// What the walks keep between calls: capacity only.
struct Workspace::Buffers {
  std::vector<Slab> slabs;
  Agenda agenda;
  std::vector<Search::Near> near;
  std::vector<ContactWitness> found;
  ViewBuffers views;
  ShellBodies shell_bodies;                        ///< of one search at a time
  std::unique_ptr<Workspace> of_shells, of_flush;  ///< null until a body turns far, or slides flush

  Workspace& forShells() { return made(of_shells); }
  Workspace& forFlush() { return made(of_flush); }

 private:
  static Workspace& made(std::unique_ptr<Workspace>& workspace) {
    if (!workspace) workspace = std::make_unique<Workspace>();
    return *workspace;
  }
};

}  // namespace collision_node::impact
