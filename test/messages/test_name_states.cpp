#include <gtest/gtest.h>

#include <cstring>

#include "collision_node/messages/name_states.h"
#include "test/messages/wire.h"
#include "test/support/gazebo_states.h"

namespace collision_node::messages {
namespace {

using test_support::LinkStates;
using test_support::ModelStates;

template <typename States>
States states() {
  States out;
  for (int i = 0; i < 3; ++i) {
    out.name.push_back("thing" + std::to_string(i));
    out.pose.emplace_back();
    out.pose.back().position.x = i + 1;
    out.pose.back().orientation.w = 1;
    out.twist.emplace_back();
    out.twist.back().linear.y = 10 * i;
    out.twist.back().angular.z = 100 * i;
  }
  return out;
}

scene::PoseSource named(const std::string& model, const std::string& link) {
  scene::PoseSource source;
  source.type = scene::PoseSource::Type::kTopic;
  source.model = model;
  source.link = link;
  return source;
}

template <typename Reader>
std::string faultOf(Reader&& reader) {
  try {
    reader();
  } catch (const PoseError& error) {
    return error.what();
  }
  return "accepted";
}

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << text

TEST(NameStates, aModelIsReadWithItsTwistAndAGuessedStamp) {
  const PoseReading got = readPose(Wire<ModelStates>(states<ModelStates>()).raw, named("thing2", ""), 77);
  EXPECT_TRUE(got.in_world);
  EXPECT_EQ(got.kind, StampKind::kGuessed);
  EXPECT_EQ(got.pose.stamp_ns, 77);
  EXPECT_EQ(got.pose.pose.position.x(), 3.0);
  EXPECT_TRUE(got.pose.has_twist);
  EXPECT_EQ(got.pose.linear.y(), 20.0);
  EXPECT_EQ(got.pose.angular.z(), 200.0);
}

TEST(NameStates, aLinkIsReadByItsName) {
  const PoseReading got = readPose(Wire<LinkStates>(states<LinkStates>()).raw, named("", "thing0"), 5);
  EXPECT_EQ(got.pose.pose.position.x(), 1.0);
}

TEST(NameStates, refusesWithALineThatSaysWhy) {
  const Wire<ModelStates> wire(states<ModelStates>());
  EXPECT_SAYS(faultOf([&] { readPose(wire.raw, named("", ""), 0); }), "needs `model`");
  EXPECT_SAYS(faultOf([&] { readPose(wire.raw, named("", "thing0"), 0); }), "needs `model`");
  const std::string missing = faultOf([&] { readPose(wire.raw, named("ball", ""), 0); });
  EXPECT_SAYS(missing, "'ball'");
  EXPECT_SAYS(missing, "thing0, thing1, thing2");
  RawMessage other = wire.raw;
  other.md5sum = "0";
  EXPECT_SAYS(faultOf([&] { readPose(other, named("thing0", ""), 0); }), "md5sum 0");
  auto uneven = states<ModelStates>();
  uneven.pose.pop_back();
  EXPECT_SAYS(faultOf([&] { readPose(Wire<ModelStates>(uneven).raw, named("thing0", ""), 0); }),
              "3 names and 2 poses");
}

TEST(NameStates, everyCutAndEveryClaimedLengthIsRefused) {
  for (std::uint32_t size = 0; size < Wire<ModelStates>(states<ModelStates>()).raw.size; ++size) {
    Wire<ModelStates> wire(states<ModelStates>());
    wire.raw.size = size;
    EXPECT_THROW(readPose(wire.raw, named("thing0", ""), 0), PoseError) << size;
  }
  const std::uint32_t poses_at = 4 + 3 * (4 + 6);
  for (const std::uint32_t at : {0u, 4u, poses_at, poses_at + 4 + 3 * 56}) {
    for (const std::uint32_t claimed : {4u, 100'000'000u, 0xffffffffu}) {
      Wire<ModelStates> wire(states<ModelStates>());
      std::memcpy(wire.bytes.data() + at, &claimed, 4);
      EXPECT_THROW(readPose(wire.raw, named("thing0", ""), 0), PoseError) << at << " " << claimed;
    }
  }
}

}  // namespace
}  // namespace collision_node::messages
