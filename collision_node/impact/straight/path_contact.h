/// What a straight path meets first: triangles, and when.
#pragma once

#include <cstdint>
#include <utility>

namespace collision_node::impact {

struct PathContact {
  enum class Kind { kClear, kContact, kCannotTell };
  static constexpr int kMost = 24;

  /// A triangle that is met, or may be, in the bracket.
  struct Met {
    std::int32_t element;
    std::int32_t vertex[3];
    double lower, upper;    ///< the part of the time on which it can be (radius > 0: begin to be) met [s]
    bool sure;              ///< it is met
    double side[3], error;  ///< radius 0: as SeenLeaf's
  };

  Kind kind = Kind::kClear;
  double lower = 0.0, upper = 0.0;  ///< [s] from the piece's start
  int count = 0;
  Met met[kMost];           ///< those of the bracket, first the one that is reported
  std::uint64_t tests = 0;  ///< nodes and leaves that were looked at

  /// Drops what begins after `end`.
  void keepUntil(double end) {
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      if (!(met[i].lower <= end)) continue;
      if (kept != i) met[kept] = met[i];
      ++kept;
    }
    count = kept;
  }

  /// Brings to the front what is surely met, or else what may be, first.
  void showEarliest() {
    const auto before = [](const Met& a, const Met& b) {
      if (a.sure != b.sure) return a.sure;
      return a.lower != b.lower ? a.lower < b.lower : a.element < b.element;
    };
    for (int i = 1; i < count; ++i) {
      if (before(met[i], met[0])) std::swap(met[i], met[0]);
    }
  }
};

}  // namespace collision_node::impact
