/// The facts of a contact on a straight path: closed forms instead of searches. Guarantee: that of
/// describeContact().
#pragma once

#include "collision_node/impact/contact_facts.h"
#include "collision_node/impact/straight_path.h"

namespace collision_node::impact {

struct StraightFacts {
  ContactFacts facts;     ///< they hold at contact.lower
  bool multiple = false;  ///< triangles elsewhere than at the reported place are met in the bracket too
};

/// `contact` is of kind kContact. Places nearer to each other than `same_place` [m] are one.
StraightFacts describeStraight(const PairPiece& piece, const StraightPath& path, const PathContact& contact,
                               double same_place);

}  // namespace collision_node::impact
