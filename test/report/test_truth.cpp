// The report's truth: the march agrees with closed forms, and what they say is what the doubles say.
#include <gtest/gtest.h>

#include "collision_node/report/scenes/scenes.h"
#include "collision_node/report/truth/marched_truth.h"

namespace {

using namespace collision_node::report;

/// Each truth within what both say they may be off.
void agree(const Trials& closed, const std::vector<Truth>& marched) {
  std::size_t hits = 0, judged = 0;
  for (std::size_t i = 0; i < marched.size(); ++i) {
    const Truth &c = closed.truths[i], &m = marched[i];
    if (m.verdict == Verdict::kUndecided) continue;  // so near that its steps ran out
    ++judged;
    ASSERT_EQ(c.verdict, m.verdict) << closed.name << " " << i;
    if (c.verdict != Verdict::kHit) continue;
    ++hits;
    EXPECT_NEAR(c.toi, m.toi, c.toi_error + m.toi_error) << closed.name << " " << i;
    const double off = (c.point - m.point).norm();
    EXPECT_FALSE(off > c.point_error + m.point_error) << closed.name << " " << i << ": off by " << off;
  }
  EXPECT_GT(hits, marched.size() / 8) << closed.name;
  EXPECT_LT(hits, judged) << closed.name;
}

TEST(MarchedTruth, agrees_with_the_closed_forms_also_where_they_graze) {
  for (const Trials& closed : {grazingSpheres(60), grazingTip(30)})
    agree(closed, marchedTruths(closed.set, 30000));
}

TEST(MarchedTruth, knows_what_starts_inside_and_what_never_meets) {
  const Trials deep = deepOverlap(2);
  for (const Truth& truth : deep.truths) {
    EXPECT_EQ(truth.verdict, Verdict::kHit);
    EXPECT_EQ(truth.toi, 0.0);
  }
}

TEST(MarchedTruth, says_so_when_its_steps_run_out) {
  const QuerySet set = tumblingMeshes(1000, 1);
  EXPECT_EQ(marchedTruths(set, 100)[0].verdict, Verdict::kUndecided);
  EXPECT_EQ(marchedTruths(set)[0].verdict, Verdict::kHit);
}

}  // namespace
