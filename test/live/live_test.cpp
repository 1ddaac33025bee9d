/// The demo's bag, played into the live node: the same events as offline, one by one, and all of them true.
/// The player starts paused; this test lets it go when everybody is connected, so nothing is lost at the
/// start.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

#include "collision_node/Impact.h"
#include "collision_node/IntervalStats.h"
#include "collision_node/messages/convert.h"
#include "collision_node/replay/replay.h"
#include "test/support/temp_folder.h"

namespace collision_node::test {
namespace {

const char* const kNode = "/collision_node";
constexpr double kDeadline = 90.0;  // [s] of wall time; only a failure takes that long

/// Serves callbacks until `done` or the deadline; sim time does not matter here.
bool waitFor(const std::function<bool()>& done) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kDeadline);
  while (ros::ok() && ros::WallTime::now() < end) {
    if (done()) return true;
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
  }
  return done();
}

struct Offline {
  std::vector<Impact> impacts;
  std::uint64_t accepted = 0;
  std::string plan;
};

Offline replayOffline(const std::string& scene, const std::string& bag_file) {
  const test_support::TempFolder folder;
  replay::Options options;
  options.scene = scene;
  options.bags = {bag_file};
  options.out = folder.path() + "/out.bag";
  std::ostringstream out, err;
  EXPECT_EQ(replay::run(options, out, err, false), 0) << err.str();
  Offline offline;
  rosbag::Bag bag(options.out);
  rosbag::View view(bag);
  for (const auto& m : view) {
    if (const auto impact = m.instantiate<Impact>()) offline.impacts.push_back(*impact);
    if (const auto stats = m.instantiate<IntervalStats>())
      offline.accepted = std::max<std::uint64_t>(offline.accepted, stats->accepted);
    if (const auto plan = m.instantiate<std_msgs::String>()) offline.plan = plan->data;
  }
  return offline;
}

/// NaN is not equal to itself; bytes are. The sequence number is roscpp's own.
std::vector<std::uint8_t> bytes(Impact impact) {
  impact.header.seq = 0;
  std::vector<std::uint8_t> out(ros::serialization::serializationLength(impact));
  ros::serialization::OStream stream(out.data(), static_cast<std::uint32_t>(out.size()));
  ros::serialization::serialize(stream, impact);
  return out;
}

struct Truth {
  std::string object, link, zone, kind;
  std::int64_t ns;
  double fraction_ns;
  geometry::Vec3 position;
};

std::vector<Truth> readTruth(const std::string& file) {
  std::vector<Truth> out;
  for (const auto& shot : YAML::LoadFile(file)["shots"])
    for (const auto& e : shot["events"])
      out.push_back(
          {shot["object"].as<std::string>(),
           e["link"].as<std::string>(),
           e["zone"].as<std::string>(),
           e["kind"].as<std::string>(),
           e["ns"].as<std::int64_t>(),
           e["fraction_ns"].as<double>(),
           {e["position"][0].as<double>(), e["position"][1].as<double>(), e["position"][2].as<double>()}});
  return out;
}

/// The true instant and point lie inside what the event says.
bool holds(const Impact& impact, const Truth& truth) {
  const scene::Event e = messages::fromMessage(impact);
  const bool a_is_shot = e.a.object == truth.object;
  const auto& shot = a_is_shot ? e.a : e.b;
  const auto& target = a_is_shot ? e.b : e.a;
  if (shot.object != truth.object || target.link != truth.link || target.zone != truth.zone ||
      impact::toString(e.kind) != truth.kind)
    return false;
  const double time = (static_cast<double>(truth.ns - e.interval_start_ns) + truth.fraction_ns) * 1e-9;
  // The product above rounds; half an ulp of a tenth of a second is far below the narrowest bracket's own
  // scale.
  const double rounding = 4e-17;
  return time >= e.toi_lower - rounding && time <= e.toi_upper + rounding &&
         (e.position - truth.position).norm() <= e.position_error;
}

std::uint64_t acceptedIn(const diagnostic_msgs::DiagnosticArray& array) {
  for (const auto& status : array.status)
    for (const auto& value : status.values)
      if (value.key == "accepted") return std::stoull(value.value);
  return 0;
}

std_srvs::Trigger::Response call(const std::string& service) {
  std_srvs::Trigger trigger;
  EXPECT_TRUE(ros::service::call(kNode + service, trigger)) << service << ": the node is gone";
  return trigger.response;
}

TEST(Live, equalsOfflineAndTruth) {
  const std::string demo = std::string(SOURCE_DIR) + "/config/efp_tank";
  const Offline offline = replayOffline(demo + "/scene.yaml", demo + "/efp_tank.bag");
  ASSERT_FALSE(offline.impacts.empty());
  ASSERT_GT(offline.accepted, 0u);

  ros::NodeHandle handle;
  std::vector<Impact> live;
  std::uint64_t accepted = 0;
  std::string plan;
  const auto impacts = handle.subscribe<Impact>(kNode + std::string("/impacts"), 0,
                                                [&](const Impact::ConstPtr& m) { live.push_back(*m); });
  const auto diagnostics = handle.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 0, [&](const diagnostic_msgs::DiagnosticArray::ConstPtr& m) {
        accepted = std::max(accepted, acceptedIn(*m));
      });
  const auto plans = handle.subscribe<std_msgs::String>(
      kNode + std::string("/plan"), 1, [&](const std_msgs::String::ConstPtr& m) { plan = m->data; });
  ASSERT_TRUE(
      waitFor([&] { return impacts.getNumPublishers() == 1 && diagnostics.getNumPublishers() >= 1; }));
  EXPECT_TRUE(waitFor([&] { return !plan.empty(); })) << "~plan is latched";
  EXPECT_EQ(plan, offline.plan);

  ASSERT_TRUE(waitFor([] { return ros::service::exists("/player/pause_playback", false); }));
  std_srvs::SetBool pause;
  pause.request.data = 0;
  ASSERT_TRUE(ros::service::call("/player/pause_playback", pause));

  // The dispenser's path is composed: at 30 Hz its last three poses wait `reorder` (0.1 s) for one that may
  // be earlier.
  constexpr std::uint64_t kHeldBack = 3;
  EXPECT_TRUE(waitFor([&] { return accepted >= offline.accepted - kHeldBack; }))
      << "only " << accepted << " of " << offline.accepted << " poses were accepted";
  EXPECT_EQ(accepted, offline.accepted - kHeldBack);
  const auto flushed = call("/flush");
  EXPECT_EQ(flushed.message, std::to_string(offline.impacts.size()) + " events");
  waitFor([&] { return live.size() >= offline.impacts.size(); });
  waitFor([&] { return accepted >= offline.accepted; });
  EXPECT_EQ(accepted, offline.accepted);

  ASSERT_EQ(live.size(), offline.impacts.size());
  for (std::size_t i = 0; i < live.size(); ++i)
    EXPECT_TRUE(bytes(live[i]) == bytes(offline.impacts[i])) << "event " << i << ":\n"
                                                             << live[i] << "offline:\n"
                                                             << offline.impacts[i];

  const auto truths = readTruth(demo + "/truth.json");
  ASSERT_EQ(truths.size(), live.size()) << "no true event missing, none extra";
  for (const auto& truth : truths)
    EXPECT_EQ(
        std::count_if(live.begin(), live.end(), [&](const Impact& impact) { return holds(impact, truth); }),
        1)
        << truth.object << " " << truth.kind << " " << truth.link << " at " << truth.ns;
  // The comparison can say no.
  Truth shifted = truths.front();
  shifted.ns += 1;
  EXPECT_EQ(
      std::count_if(live.begin(), live.end(), [&](const Impact& impact) { return holds(impact, shifted); }),
      0);

  // Nothing more was on its way, and the node is still alive.
  EXPECT_EQ(call("/flush").message, flushed.message);
  ros::getGlobalCallbackQueue()->callAvailable();
  EXPECT_EQ(live.size(), offline.impacts.size());
}

TEST(Live, resetAndReload) {
  EXPECT_TRUE(call("/reset").success);
  std::string scene;
  ASSERT_TRUE(ros::param::get(kNode + std::string("/scene"), scene));
  EXPECT_TRUE(call("/reload_scene").success);
  ros::param::set(kNode + std::string("/scene"), "/none.yaml");
  const auto refused = call("/reload_scene");
  EXPECT_FALSE(refused.success);
  EXPECT_NE(refused.message.find("/none.yaml"), std::string::npos) << refused.message;
  ros::param::set(kNode + std::string("/scene"), scene);
  EXPECT_TRUE(call("/flush").success) << "the old scene goes on";
}

geometry_msgs::PoseStamped ballAt(double x, double seconds) {
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "world";
  pose.header.stamp = ros::Time(100.0 + seconds);
  pose.pose.position.x = x;
  pose.pose.orientation.w = 1.0;
  return pose;
}

TEST(Live, reloadEndsTheContactsThatAreOpen) {
  const test_support::TempFolder folder;
  const std::string file =
      folder.write("ball.yaml",
                   "objects:\n  ball: {sphere: {radius: 0.1}, pose: {topic: live_test/ball}}\n"
                   "  wall: {box: {size: [1, 9, 9]}, pose: {fixed: {}}}\n");
  ros::NodeHandle handle;
  std::vector<Impact> live;
  const auto impacts = handle.subscribe<Impact>(kNode + std::string("/impacts"), 0,
                                                [&](const Impact::ConstPtr& m) { live.push_back(*m); });
  const auto ball = handle.advertise<geometry_msgs::PoseStamped>("/live_test/ball", 0);
  std::string demo;
  ASSERT_TRUE(ros::param::get(kNode + std::string("/scene"), demo));
  ros::param::set(kNode + std::string("/scene"), file);
  ASSERT_TRUE(call("/reload_scene").success);
  ASSERT_TRUE(waitFor([&] { return ball.getNumSubscribers() == 1 && impacts.getNumPublishers() == 1; }));
  for (int i = 0; i < 4; ++i) ball.publish(ballAt(1.2 - 0.4 * i, 0.1 * i));  // it ends inside the wall
  ASSERT_TRUE(waitFor([&] {
    call("/flush");
    return !live.empty();
  }));
  ros::param::set(kNode + std::string("/scene"), demo);
  EXPECT_TRUE(call("/reload_scene").success);
  ASSERT_TRUE(waitFor([&] { return live.size() >= 2; })) << "the contact was forgotten";
  EXPECT_EQ(live[0].kind, Impact::IMPACT);
  EXPECT_EQ(live[1].kind, Impact::SEPARATION);
  EXPECT_EQ(live[1].certificate, Impact::UNCERTIFIED);
  EXPECT_EQ(live[1].reason, Impact::RESET);
  EXPECT_EQ(live[1].contact_id, live[0].contact_id);
}

}  // namespace
}  // namespace collision_node::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "live_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
