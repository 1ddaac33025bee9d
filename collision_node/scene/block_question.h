/// The broad phase's questions to four boxes at a time, in floats.
///
/// Guarantee: the answer is never false for a box that meets what is asked about. Derivation: all numbers
/// are relative to the hierarchy's origin, at most `most` in size, and none is rounded more than a few times
/// by 2^-24 of that; what is asked about is made larger by 2^-20 of it.
#pragma once

#include <algorithm>
#include <cmath>

#include "collision_node/geometry/bvh.h"
#include "collision_node/scene/sweep.h"

namespace collision_node::scene {

class BlockQuestion {
 public:
  /// `reach`: no plane of the hierarchy's boxes is farther from its origin. [m]
  BlockQuestion(const BoxQuestion& question, const Vec3& origin, double reach)
      : BlockQuestion(question.box, 0.5 * (question.box.lower + question.box.upper),
                      0.5 * (question.box.lower + question.box.upper), 0.0, false, origin, reach) {}
  BlockQuestion(const LineQuestion& question, const Vec3& origin, double reach)
      : BlockQuestion(question.sweep().box, question.sweep().from, question.sweep().to,
                      question.sweep().radius, true, origin, reach) {}

  void ask(const geometry::BvhBlock& block, bool (&meets)[geometry::BvhBlock::kWidth]) const {
    constexpr int kWidth = geometry::BvhBlock::kWidth;
    float enter[kWidth], leave[kWidth];
    int outside[kWidth];
    for (int i = 0; i < kWidth; ++i) {
      enter[i] = 0.0F;
      leave[i] = 1.0F;
      outside[i] = 0;
    }
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < kWidth; ++i) {
        const float half = block.half[k][i], off = block.centre[k][i] - centre_[k];
        outside[i] |= std::abs(off) > half + half_[k];
      }
      if (!is_line_) continue;
      const float near_side = inverse_[k] < 0.0F ? 1.0F : -1.0F;
      for (int i = 0; i < kWidth; ++i) {
        const float off = block.centre[k][i] - from_[k], half = block.half[k][i] + radius_;
        enter[i] = std::max(enter[i], (off + near_side * half) * inverse_[k]);
        leave[i] = std::min(leave[i], (off - near_side * half) * inverse_[k]);
      }
    }
    for (int i = 0; i < kWidth; ++i) meets[i] = outside[i] == 0 && enter[i] <= leave[i];
  }

 private:
  BlockQuestion(const Bounds& box, const Vec3& from, const Vec3& to, double radius, bool is_line,
                const Vec3& origin, double reach)
      : is_line_(is_line) {
    const Vec3 lower = box.lower - origin, upper = box.upper - origin;
    const double most =
        std::max({reach, lower.lpNorm<Eigen::Infinity>(), upper.lpNorm<Eigen::Infinity>(), radius});
    const double more = 0x1p-20 * most;
    radius_ = static_cast<float>(radius + more);
    for (int k = 0; k < 3; ++k) {
      centre_[k] = static_cast<float>(0.5 * (lower[k] + upper[k]));
      half_[k] = static_cast<float>(0.5 * (upper[k] - lower[k]) + more);
      from_[k] = static_cast<float>(from[k] - origin[k]);
      const double way = to[k] - from[k];
      inverse_[k] = static_cast<float>(1.0 / (std::abs(way) > 1e-30 ? way : 1e-30));
    }
  }

  bool is_line_;
  float centre_[3], half_[3], from_[3], inverse_[3], radius_;
};

}  // namespace collision_node::scene
