/// The layout of the messages is frozen: another md5 would make recorded bags unreadable.
#include <gtest/gtest.h>

#include "collision_node/Impact.h"
#include "collision_node/ImpactSide.h"
#include "collision_node/IntervalStats.h"

namespace {

template <typename Message>
std::string md5() {
  return ros::message_traits::md5sum<Message>();
}

TEST(Md5, isFrozen) {
  EXPECT_EQ(md5<collision_node::ImpactSide>(), "cfbd20cccd97b4e48e760a4e294a2d4b");
  EXPECT_EQ(md5<collision_node::Impact>(), "96ea47da61f0ca26cd280a261e227dab");
  EXPECT_EQ(md5<collision_node::IntervalStats>(), "1e8cb6a89a7aa12ef04cde2d38f95dfa");
}

TEST(Md5, constantsAreThoseOfTheCore) {
  using collision_node::Impact;
  using collision_node::ImpactSide;
  EXPECT_EQ(Impact::SEPARATION, 1);
  EXPECT_EQ(Impact::INITIAL_OVERLAP, 2);
  EXPECT_EQ(Impact::POSSIBLE, 1);
  EXPECT_EQ(Impact::UNCERTIFIED, 2);
  EXPECT_EQ(Impact::GAP, 4);
  EXPECT_EQ(Impact::METHOD, 9);
  EXPECT_EQ(ImpactSide::VERTEX, 1);
  EXPECT_EQ(ImpactSide::SMOOTH, 4);
}

}  // namespace
