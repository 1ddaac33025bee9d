/// Which pairs of links are watched, without a list of all of them: ten thousand objects make fifty million
/// pairs.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace collision_node::scene {

struct Object;

/// A pair of links that is watched. Side a is of the object with the smaller index, and within one object the
/// smaller in byte order.
struct LinkPair {
  int object_a = -1, link_a = -1;  ///< indices into Scene::objects and Object::links
  int object_b = -1, link_b = -1;
  double contact_distance = 0.0;  ///< [m]
};

/// A pair of links that the scene could watch; `against` says why it does not, "" when it does.
struct PairVerdict {
  LinkPair pair;
  std::string against;
};

/// One rule for all pairs of links of two objects with different indices, and the pairs of objects that
/// differ from it. Objects are in byte order of their names; only links with shapes make pairs.
class PairRules {
 public:
  /// Every link with shapes against those of every other object, at `contact_distance`.
  explicit PairRules(double contact_distance = 0.0) : contact_distance_(contact_distance) {}
  /// Nothing but these.
  PairRules(std::initializer_list<LinkPair> watched);

  /// From now on: what is not set is not watched, for this reason.
  void watchNothingElse(const std::string& reason) { reason_against_rest_ = reason; }
  /// The verdicts on all pairs of links of objects a <= b, which then do not follow the rule.
  void set(int a, int b, std::vector<PairVerdict> verdicts) { set_[{a, b}] = std::move(verdicts); }

  /// All watched pairs of links of objects a <= b, in byte order of their names.
  std::vector<LinkPair> between(const std::vector<Object>& objects, int a, int b) const;
  /// How many those are; constant time for what follows the rule.
  std::uint64_t countBetween(const std::vector<Object>& objects, int a, int b) const;
  std::uint64_t count(const std::vector<Object>& objects) const;
  /// In how many watched pairs each link is, by object and link; without a list of them.
  std::vector<std::vector<std::uint64_t>> countByLink(const std::vector<Object>& objects) const;
  /// All watched pairs, in byte order: for small scenes and explicit lists.
  std::vector<LinkPair> list(const std::vector<Object>& objects) const;

  /// Pairs that are not set are watched.
  bool watchesRest() const { return reason_against_rest_.empty(); }
  const std::string& reasonAgainstRest() const { return reason_against_rest_; }
  const std::map<std::pair<int, int>, std::vector<PairVerdict>>& exceptions() const { return set_; }
  /// At least half of each contact distance at which this object may touch, by object. [m]
  std::vector<double> halfDistances(std::size_t objects) const;

 private:
  double contact_distance_ = 0.0;
  std::string reason_against_rest_;
  std::map<std::pair<int, int>, std::vector<PairVerdict>> set_;
};

/// Links of an object that can touch something, in byte order of their names.
std::vector<int> linksWithShapes(const Object& object);

}  // namespace collision_node::scene
