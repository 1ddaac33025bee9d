// The walks of the hard directions: their truth is held against a march that shares nothing with it, every
// mark can be given, and what docs/stability.md claims of ours is what the walk finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "collision_node/report/stability/shapes.h"
#include "collision_node/report/stability/straight_trials.h"
#include "collision_node/report/stability/turning_trials.h"
#include "collision_node/report/stability/walk.h"
#include "collision_node/report/truth/marched_truth.h"

namespace {

using namespace collision_node::report;
namespace geometry = collision_node::geometry;
using geometry::Vec3;

WalkOptions quickOfOurs() {
  WalkOptions options;
  options.quick = true;
  options.only_ours = true;
  options.count = 6;
  return options;
}

const std::vector<Walk>& quickWalks() {
  static const std::vector<Walk> walks = walkAll(quickOfOurs());
  return walks;
}

/// The table of docs/stability.md whose rows begin "| `direction` |": {direction: {column: text}}.
std::map<std::string, std::vector<std::string>> claims() {
  std::ifstream file(SOURCE_DIR "/collision_node/docs/stability.md");
  std::map<std::string, std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    std::vector<std::string> cells;
    std::stringstream stream(line.substr(2));
    for (std::string cell; std::getline(stream, cell, '|');) {
      const auto first = cell.find_first_not_of(" `"), last = cell.find_last_not_of(" `");
      cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    }
    rows[cells.front()] = cells;
  }
  return rows;
}

TEST(ExactTouch, balls_meet_when_their_centres_are_a_diameter_apart) {
  Surface<Exact> ball;
  ball.vertices = {Vec<Exact>::Zero()};
  ball.radius = Exact(1) / Exact(2);
  const auto touch = firstTouch<Exact>(ball, ball, Vec<Exact>(-3, 0, 0), Vec<Exact>(4, 0, 0));
  ASSERT_TRUE(touch.has_value());
  EXPECT_EQ(touch->time, Exact(1) / Exact(2));
  EXPECT_EQ(touch->point, Vec<Exact>(Exact(-1) / Exact(2), 0, 0));
  EXPECT_FALSE(firstTouch<Exact>(ball, ball, Vec<Exact>(-3, 0, Exact(1.0001)), Vec<Exact>(4, 0, 0)));
}

/// Truth of the generators against the march, both on the same doubles.
void expectSameTruth(const Group& group) {
  const std::vector<Truth> marched = marchedTruths(group.trials.set);
  for (std::size_t i = 0; i < marched.size(); ++i) {
    const Truth& truth = group.trials.truths[i];
    if (marched[i].verdict == Verdict::kUndecided) continue;
    ASSERT_EQ(truth.verdict, marched[i].verdict) << group.trials.name << ' ' << i;
    if (truth.verdict != Verdict::kHit) continue;
    EXPECT_NEAR(truth.toi, marched[i].toi, 1e-12 + marched[i].toi_error) << group.trials.name << ' ' << i;
    if (truth.point.allFinite() && marched[i].point.allFinite()) {
      EXPECT_LT((truth.point - marched[i].point).norm(), 1e-6) << group.trials.name << ' ' << i;
    }
  }
}

TEST(StabilityTruth, agrees_with_the_march_on_every_kind_of_trial) {
  Random random(7);
  for (const Direction& direction : allDirections(true)) {
    for (const Group& group : direction.groups(direction.values[direction.easy], 6, random)) {
      expectSameTruth(group);
    }
  }
}

TEST(Stability, every_rung_holds_contacts_and_pairs_that_stay_apart) {
  Random random(11);
  for (const Direction& direction : allDirections(true)) {
    for (const double value : direction.values) {
      std::size_t contacts = 0, apart = 0;
      for (const Group& group : direction.groups(value, 6, random)) {
        for (const Truth& truth : group.trials.truths) {
          ASSERT_NE(truth.verdict, Verdict::kUndecided);
          ++(truth.verdict == Verdict::kHit ? contacts : apart);
        }
      }
      EXPECT_GT(contacts, 0u) << direction.name << ' ' << value;
      EXPECT_GT(apart, 0u) << direction.name << ' ' << value;
    }
  }
}

TEST(Stability, no_answer_of_ours_is_wrong_at_any_rung) {
  for (const Walk& walk : quickWalks()) {
    for (std::size_t rung = 0; rung < walk.direction.values.size(); ++rung) {
      const Cell& cell = walk.cells[0][rung];
      EXPECT_EQ(cell.wrong(), 0) << walk.direction.name << ' ' << walk.direction.values[rung] << ": missed "
                                 << cell.count(Mark::kMissed) << ", false " << cell.count(Mark::kFalse)
                                 << ", late " << cell.count(Mark::kLate) << ", early "
                                 << cell.count(Mark::kEarly) << ", ball " << cell.count(Mark::kBound);
      EXPECT_GT(cell.asked(), 0) << walk.direction.name << ' ' << walk.direction.values[rung];
      EXPECT_EQ(cell.not_asked + cell.not_offered, 0);
    }
  }
}

TEST(Stability, every_direction_is_decided_as_far_as_the_page_claims) {
  auto rows = claims();
  for (const Walk& walk : quickWalks()) {
    ASSERT_EQ(rows.count(walk.direction.name), 1u) << walk.direction.name << " is not on the page";
    const auto row = rows[walk.direction.name];
    rows.erase(walk.direction.name);
    ASSERT_GE(row.size(), 4u);
    const double from = std::stod(row[2]), to = std::stod(row[3]);
    for (std::size_t rung = 0; rung < walk.direction.values.size(); ++rung) {
      const double value = walk.direction.values[rung];
      if (value < std::min(from, to) || value > std::max(from, to)) continue;
      EXPECT_EQ(walk.cells[0][rung].count(Mark::kUndecided), 0) << walk.direction.name << ' ' << value;
    }
  }
  EXPECT_TRUE(rows.empty()) << rows.begin()->first << " is claimed and not walked";
}

TEST(Stability, a_graze_has_the_bracket_that_its_curvature_owes) {
  for (const Walk& walk : quickWalks()) {
    if (walk.direction.name != "graze") continue;
    // 2 sqrt(2 budget / a): 64 u times 5 m of sizes, a = (10 m/s)^2 / 1 m.
    const double owed = 2.0 * std::sqrt(2.0 * 64.0 * 1.2e-16 * 5.0 / 100.0);
    for (const Cell& cell : walk.cells[0]) EXPECT_LE(cell.bracket, std::max(1e-9, owed));
  }
}

// ---- marks

Group oneContact() {
  Group group = makeGroup("one", geometry::Sphere{0.5}, geometry::Sphere{0.5});
  const Setting setting;
  const Flight a = flight(setting, Vec3::Zero(), Vec3::Zero(), geometry::Quat::Identity());
  const Flight b = flight(setting, Vec3(1.5, 0, 0), Vec3(0.5, 0, 0), geometry::Quat::Identity());
  const Vec<Exact> point(Exact(0.5), 0, 0);
  group.addContact(pieceOf(a, b), Exact(0.05), &point, 10.0);
  group.addApart(pieceOf(a, a), 1e-4);
  return group;
}

Answer certified(Verdict verdict, double lower, double upper) {
  Answer answer;
  answer.certified = true;
  answer.verdict = verdict;
  answer.toi_lower = lower;
  answer.toi_upper = upper;
  answer.point = Vec3(0.5, 0, 0);
  answer.position_error = 1e-9;
  return answer;
}

TEST(Mark, a_certified_answer_owes_a_bracket_and_a_ball_that_hold_the_truth) {
  const Group group = oneContact();
  const auto mark = [&](const Answer& answer, std::size_t trial = 0) {
    return markOf(answer, group, trial, Promise());
  };
  EXPECT_EQ(mark(certified(Verdict::kHit, 0.04, 0.06)), Mark::kKept);
  EXPECT_EQ(mark(certified(Verdict::kHit, 0.051, 0.06)), Mark::kLate);
  EXPECT_EQ(mark(certified(Verdict::kHit, 0.03, 0.04)), Mark::kEarly);
  EXPECT_EQ(mark(certified(Verdict::kClear, 0, 0)), Mark::kMissed);
  EXPECT_EQ(mark(certified(Verdict::kUndecided, 0.04, 0.06)), Mark::kUndecided);
  EXPECT_EQ(mark(certified(Verdict::kUndecided, 0.051, 0.06)), Mark::kLate);
  EXPECT_EQ(mark(certified(Verdict::kHit, 0.04, 0.06), 1), Mark::kFalse);
  EXPECT_EQ(mark(certified(Verdict::kClear, 0, 0), 1), Mark::kKept);
  Answer beside = certified(Verdict::kHit, 0.04, 0.06);
  beside.point.y() = 1e-8;
  EXPECT_EQ(mark(beside), Mark::kBound);
  beside.point.y() = std::nan("");
  EXPECT_EQ(mark(beside), Mark::kBound);
}

TEST(Mark, any_other_answer_owes_what_its_promise_says) {
  const Group group = oneContact();
  Promise promise;
  promise.gap = 1e-5;
  promise.late = 1e-3;
  promise.early = 1e-2;
  const auto mark = [&](Verdict verdict, double time, std::size_t trial = 0) {
    Answer answer;
    answer.verdict = verdict;
    answer.toi_lower = answer.toi_upper = time;
    return markOf(answer, group, trial, promise);
  };
  EXPECT_EQ(mark(Verdict::kHit, 0.05), Mark::kKept);
  EXPECT_EQ(mark(Verdict::kHit, 0.05009), Mark::kKept);
  EXPECT_EQ(mark(Verdict::kHit, 0.0502), Mark::kLate);
  EXPECT_EQ(mark(Verdict::kHit, 0.0489), Mark::kEarly);
  EXPECT_EQ(mark(Verdict::kClear, 0), Mark::kMissed);
  EXPECT_EQ(mark(Verdict::kUndecided, 0), Mark::kUndecided);
  EXPECT_EQ(mark(Verdict::kHit, 0.05, 1), Mark::kFalse);
  promise.gap = 1e-3;
  EXPECT_EQ(mark(Verdict::kHit, 0.05, 1), Mark::kUndecided);
}

}  // namespace
