#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

#include "collision_node/messages/event_text.h"
#include "test/messages/sample_event.h"

namespace collision_node::messages {
namespace {

TEST(Json, isReadBackExactly) {
  const scene::Event e = test::sampleEvent();
  const std::string line = toJson(e, "world");
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const YAML::Node node = YAML::Load(line);  // JSON is YAML
  EXPECT_EQ(node["header"]["stamp"].as<std::int64_t>(), e.stamp_ns);
  EXPECT_EQ(node["header"]["frame_id"].as<std::string>(), "world");
  EXPECT_EQ(node["event_id"].as<std::uint64_t>(), e.event_id);
  EXPECT_EQ(node["kind"].as<std::string>(), "SEPARATION");
  EXPECT_EQ(node["certificate"].as<std::string>(), "POSSIBLE");
  EXPECT_EQ(node["reason"].as<std::string>(), "GRAZING");
  EXPECT_EQ(node["toi_upper"].as<std::string>(), "0.3333333333333333");
  EXPECT_EQ(node["position_error"].as<std::string>(), "5e-324");
  EXPECT_EQ(node["position"]["z"].as<double>(), e.position.z());
  EXPECT_EQ(node["multiple"].as<std::string>(), "true");
  EXPECT_TRUE(node["model_toi_lower"].IsNull());
  EXPECT_EQ(node["a"]["feature"].as<std::string>(), "EDGE");
  EXPECT_EQ(node["b"]["point"]["x"].as<double>(), e.b.point.x());
  EXPECT_EQ(node["b"]["pose"]["orientation"]["z"].as<double>(), e.b.pose.orientation.z());
  EXPECT_EQ(node["b"]["sample_after"].as<std::int64_t>(), e.b.sample_after_ns);
}

TEST(Json, namesAreEscaped) {
  scene::Event e = test::sampleEvent();
  e.a.object = "a\"b\\c\nd\te\x01";
  const std::string line = toJson(e, "world");
  EXPECT_NE(line.find(R"("object":"a\"b\\c\nd\te\u0001")"), std::string::npos) << line;
}

TEST(Json, infinityIsNull) {
  scene::Event e = test::sampleEvent();
  e.position_error = std::numeric_limits<double>::infinity();
  EXPECT_NE(toJson(e, "w").find("\"position_error\":null"), std::string::npos);
}

TEST(Text, shortestReadsBackTheSameDouble) {
  const unsigned seed = 20240717;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = random();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(std::strtod(shortest(value).c_str(), nullptr), value) << "seed " << seed << ", number " << i;
  }
  EXPECT_EQ(shortest(0.1), "0.1");
}

TEST(Text, secondsNeverGoThroughADouble) {
  EXPECT_EQ(secondsText(1'700'000'000'000'000'001), "1700000000.000000001");
  EXPECT_EQ(secondsText(-1), "-0.000000001");
  EXPECT_EQ(secondsText(0), "0.000000000");
}

TEST(Csv, headerAndRowHaveTheSameColumns) {
  scene::Event e = test::sampleEvent();
  const std::string header = csvHeader();
  const std::string row = toCsv(e, "world");
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_EQ(header.rfind("header.stamp,header.frame_id,epoch,event_id,", 0), 0u) << header;
  EXPECT_NE(header.find(",b.pose.orientation.w,b.sample_before,b.sample_after"), std::string::npos) << header;
  EXPECT_NE(row.find(",1999.5,,,,a,"), std::string::npos) << "NaN is an empty cell: " << row;
}

TEST(Csv, quotesWhatNeedsQuotes) {
  scene::Event e = test::sampleEvent();
  e.a.object = "one, \"two\"";
  EXPECT_NE(toCsv(e, "world").find("\"one, \"\"two\"\"\""), std::string::npos);
}

}  // namespace
}  // namespace collision_node::messages
