/// Objects whose links move by themselves: how they are cut, what names them, who is paired with whom.
#include <algorithm>
#include <cmath>

#include "collision_node/scene/file/moving_parts.h"
#include "collision_node/scene/tracks/segment.h"
#include "test/support/scene_texts.h"

namespace collision_node::scene {
namespace {

using Names = std::vector<std::string>;
using Type = PoseSource::Type;
constexpr double kQuarter = 1.5707963267948966;

/// base - (shoulder) - upper - [flange] - gripper - (jaw, mimic) - finger, and a sensor without a shape that
/// turns.
const char* const kArm = R"(<robot name="arm">
  <link name="base"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <link name="upper"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="gripper"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="finger"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <link name="sensor"/>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><origin xyz="0 0 1"/>
    <axis xyz="0 0 2"/></joint>
  <joint name="flange" type="fixed"><parent link="upper"/><child link="gripper"/><origin xyz="2 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="jaw" type="prismatic"><parent link="gripper"/><child link="finger"/><origin xyz="0 0 0.5"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="pan" multiplier="0.5" offset="0.1"/></joint>
  <joint name="pan" type="revolute"><parent link="base"/><child link="sensor"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>)";

class MovingParts : public test_support::SceneTest {
 protected:
  MovingParts() { folder_.write("arm.urdf", kArm); }
  std::shared_ptr<const Scene> armWith(const std::string& lines, const std::string& more = "") {
    return load("objects:\n  arm:\n    urdf: arm.urdf\n" + lines +
                "  wall: {box: {size: [1, 1, 1]}, pose: {fixed: {}}}\n" + more);
  }
  std::string refusalOfArm(const std::string& lines) {
    return refusal("objects:\n  arm:\n    urdf: arm.urdf\n" + lines);
  }
  static Names labels(const Scene& scene) {
    Names out;
    for (const Object& object : scene.objects) out.push_back(object.label());
    return out;
  }
  static Names linksOf(const Object& object) {
    Names out;
    for (const Link& link : object.links) out.push_back(link.name);
    return out;
  }
  static Names pairsOf(const Scene& scene) {
    Names out;
    for (const LinkPair& pair : scene.pairs.list(scene.objects)) {
      const Object& a = scene.objects[pair.object_a];
      const Object& b = scene.objects[pair.object_b];
      out.push_back(a.name + "/" + a.links[pair.link_a].name + " " + b.name + "/" +
                    b.links[pair.link_b].name);
    }
    return out;
  }
};

TEST_F(MovingParts, fixedJointsHoldLinksTogether) {
  const auto scene = armWith(
      "    pose: {tf: r/base, links: true}\n    max_speed: 7\n"
      "    zones: {tip: {link: finger}, hand: {link: gripper}, body: {link: base}}\n");
  EXPECT_EQ(labels(*scene), (Names{"arm/base", "arm/upper", "arm/finger", "wall"}));
  const Object& base = scene->objects[0];
  const Object& upper = scene->objects[1];
  const Object& finger = scene->objects[2];
  // The sensor touches nothing: no frame of its own is asked for.
  EXPECT_EQ(linksOf(base), (Names{"base", "sensor"}));
  EXPECT_EQ(linksOf(upper), (Names{"upper", "gripper"}));
  EXPECT_EQ(linksOf(finger), (Names{"finger"}));
  EXPECT_EQ(base.source.tf_frame, "r/base");
  EXPECT_EQ(upper.source.tf_frame, "r/upper");
  EXPECT_EQ(finger.source.tf_frame, "r/finger");
  for (const Object* part : {&base, &upper, &finger}) {
    EXPECT_EQ(part->name, "arm");
    EXPECT_EQ(part->max_speed, 7.0);
    EXPECT_EQ(part->zones.size(), 1u);
    EXPECT_TRUE(part->movable_joints.empty());
  }
  EXPECT_EQ(upper.zones[0].name, "hand");
  // Placed from the frame that moves it.
  EXPECT_EQ(upper.links[0].T_o_l.position, Vec3(0, 0, 0));
  EXPECT_EQ(upper.links[1].T_o_l.position, Vec3(2, 0, 0));
  EXPECT_LT((upper.links[1].T_o_l * Vec3(1, 0, 0) - Vec3(2, 1, 0)).norm(), 1e-15);
  EXPECT_NEAR(upper.links[1].body->reach(), 2.0 + 0.05 * std::sqrt(3.0), 0.1);
}

TEST_F(MovingParts, theFramesPrefixIsThatOfTheRootOrGiven) {
  EXPECT_EQ(armWith("    pose: {tf: /base, links: true}\n")->objects[1].source.tf_frame, "upper");
  EXPECT_EQ(armWith("    pose: {tf: foot, links: true, tf_prefix: /a/b_}\n")->objects[1].source.tf_frame,
            "a/b_upper");
  EXPECT_EQ(armWith("    pose: {tf: foot, links: true, tf_prefix: /}\n")->objects[1].source.tf_frame,
            "upper");
  EXPECT_HAS(refusalOfArm("    pose: {tf: foot, links: true}\n"),
             "objects/arm/pose/tf: 'foot' does not end in the root link's name, so the other links' frames "
             "are not known; write tf: [<prefix>/]base, or add tf_prefix");
  EXPECT_HAS(refusalOfArm("    pose: {tf: mybase, links: true}\n"), "does not end in the root link's name");
  EXPECT_HAS(refusalOfArm("    pose: {tf: base, tf_prefix: a}\n"), "only meant beside links: true");
}

TEST_F(MovingParts, linksAndJointsAreRefusedWhereTheyMeanNothing) {
  EXPECT_HAS(refusalOfObject("    point: {}\n    pose: {tf: a, links: true}\n"),
             "objects/o/pose/links: only a urdf has links that move");
  EXPECT_HAS(refusalOfObject("    point: {}\n    pose: {tf: a}\n    joints: {topic: j}\n"),
             "objects/o/joints: only a urdf has links that move");
  EXPECT_HAS(refusalOfArm("    pose: {tf: base, links: true}\n    motion: hermite\n"),
             "objects/arm/motion: links that move by themselves move by slerp");
  EXPECT_HAS(refusalOfArm("    pose: {tf: base, links: true}\n    joints: {topic: j}\n"),
             "objects/arm/pose/links: links: true and joints both say how the links move");
  EXPECT_HAS(refusalOfArm("    pose: {fixed: {}}\n    joints: {}\n"), "objects/arm/joints: no topic");
  EXPECT_HAS(refusalOfArm("    pose: {fixed: {}}\n    joints: {topc: j}\n"),
             "unknown key 'topc'; nearest known: 'topic'");
  EXPECT_HAS(refusalOfArm("    joints: {topic: j}\n"), "objects/arm: no pose");
  EXPECT_HAS(refusalOfArm("    pose: {tf: base}\n    joint: {topic: j}\n"), "nearest known: 'joints'");
  EXPECT_HAS(refusalOfArm("    pose: {tf: base, link: true}\n"),
             "objects/arm/pose/link: only meant beside topic; links: true moves each link by its tf frame");
}

TEST_F(MovingParts, neighboursAreNeverPairedAndLinksOfOneObjectOnlyWhenAsked) {
  const std::string pose = "    pose: {tf: base, links: true}\n";
  const Names with_wall{"arm/base wall/wall", "arm/gripper wall/wall", "arm/upper wall/wall",
                        "arm/finger wall/wall"};
  EXPECT_EQ(pairsOf(*armWith(pose)), with_wall);
  const Names own{"arm/base arm/gripper", "arm/base arm/finger", "arm/upper arm/finger"};
  EXPECT_EQ(pairsOf(*armWith(pose, "pairs: {self: true, ignore: [[arm, wall]]}\n")), own);
  // Both parts of an object answer to its name, each link to its own.
  EXPECT_EQ(pairsOf(*armWith(pose, "pairs: {only: [[arm/finger, wall], [arm/finger, arm/base]]}\n")),
            (Names{"arm/base arm/finger", "arm/finger wall/wall"}));
  EXPECT_EQ(pairsOf(*armWith(pose, "pairs: {only: [[wall, arm]], ignore: [[arm/upper, wall]]}\n")),
            (Names{"arm/base wall/wall", "arm/gripper wall/wall", "arm/finger wall/wall"}));
  EXPECT_HAS(refusal("objects:\n  arm: {urdf: arm.urdf, pose: {tf: base, links: true}}\n"
                     "pairs: {ignore: [[arm/fingr, arm]]}\n"),
             "unknown link 'fingr' of 'arm'; nearest known: 'finger'");
}

TEST_F(MovingParts, thePlanTellsWhatMovesEachPart) {
  const std::string plan = planText(
      *armWith("    pose: {topic: arm/odom}\n    joints: {topic: joint_states}\n", "pairs: {self: true}\n"));
  EXPECT_HAS(plan, "objects (2):");
  EXPECT_HAS(plan, "  arm/base: topic arm/odom; motion slerp");
  EXPECT_HAS(plan, "  arm/upper: moved by joints shoulder of topic joint_states; motion slerp");
  EXPECT_HAS(plan, "  arm/finger: moved by joints shoulder, jaw (mimics pan) of topic joint_states;");
  EXPECT_HAS(plan, "  arm/base x arm/finger: certified: box x sphere\n");
  EXPECT_HAS(plan, "  arm x arm, 3 pairs of links: neighbours in the URDF");
  EXPECT_HAS_NOT(plan, "held at 0");
  EXPECT_HAS_NOT(plan, "one static test");
}

TEST_F(MovingParts, aJointMovesThePartBehindItAboutItsAxis) {
  const auto scene = armWith("    pose: {fixed: {}}\n    joints: {topic: joint_states}\n");
  const std::vector<PartJoint>& joints = scene->objects[2].source.joints;
  ASSERT_EQ(joints.size(), 2u);
  EXPECT_EQ(joints[0].joint.axis, Vec3(0, 0, 1)) << "made unit";
  const auto shoulder = jointPose(joints[0], 5, kQuarter, {});
  EXPECT_EQ(shoulder.stamp_ns, 5);
  EXPECT_LT((shoulder.pose * Vec3(1, 0, 0) - Vec3(0, 1, 1)).norm(), 1e-15);
  EXPECT_EQ(shoulder.turned, kQuarter);
  EXPECT_FALSE(shoulder.has_twist);
  const auto turning = jointPose(joints[0], 5, kQuarter, 3.0);
  EXPECT_TRUE(turning.has_twist);
  EXPECT_EQ(turning.angular, Vec3(0, 0, 3));
  // The jaw hangs on the gripper, which the flange holds on `upper`, turned by a quarter.
  EXPECT_EQ(joints[1].joint.driver, "pan");
  const auto jaw = jointPose(joints[1], 5, 1.0, 7.0);  // it stands at 0.5 x 1 + 0.1 along the turned x
  EXPECT_LT((jaw.pose.position - Vec3(2, 0.6, 0.5)).norm(), 1e-15);
  EXPECT_FALSE(jaw.has_twist);
  EXPECT_TRUE(std::isnan(jaw.turned));
}

/// A revolute joint counts its turns: half a turn between two poses is not the short way round. One that may
/// count from 0 again says by its rate which way it went.
// README: "a joint turns by less than half a turn between two positions, or a continuous one says its
// velocity"
TEST_F(MovingParts, aJointThatTurnsByHalfATurnIsAliased) {
  PartJoint joint;
  joint.joint.axis = Vec3::UnitZ();
  using Kind = geometry::UrdfJoint::Kind;
  const auto doubt = [&](Kind kind, double from, double to, std::optional<double> rate) {
    joint.joint.kind = kind;
    return makeSegment(MotionModel::kSlerp, jointPose(joint, 0, from, rate),
                       jointPose(joint, 1'000'000'000, to, rate))
        .doubt;
  };
  constexpr auto kNone = impact::Reason::kNone, kAlias = impact::Reason::kAlias;
  EXPECT_EQ(doubt(Kind::kRevolute, -1.5, 1.5, {}), kNone);
  EXPECT_EQ(doubt(Kind::kRevolute, -1.6, 1.6, {}), kAlias);
  EXPECT_EQ(doubt(Kind::kRevolute, -1.6, 1.6, 0.1), kAlias) << "its position does not count from 0 again";
  EXPECT_EQ(doubt(Kind::kRevolute, 0, 2 * kQuarter, {}), kAlias) << "exactly half a turn";
  EXPECT_EQ(doubt(Kind::kContinuous, 1000.0, 1003.0, {}), kNone);
  EXPECT_EQ(doubt(Kind::kContinuous, 3.1, -3.1, {}), kAlias) << "nobody can tell";
  EXPECT_EQ(doubt(Kind::kContinuous, 3.1, -3.1, 0.08), kNone) << "it counted from 0 again";
  EXPECT_EQ(doubt(Kind::kContinuous, 0.0, 6.28, 6.28), kAlias) << "a whole turn";
  EXPECT_EQ(doubt(Kind::kPrismatic, 0.0, 100.0, {}), kNone);
}

TEST_F(MovingParts, jointsThatOnePositionCannotMoveAreRefused) {
  const auto refused = [&](const std::string& type, const std::string& inside) {
    folder_.write("odd.urdf",
                  "<robot name='o'><link name='a'/><link name='b'><collision><geometry><sphere radius='1'/>"
                  "</geometry></collision></link><joint name='j' type='" +
                      type + "'><parent link='a'/><child link='b'/>" + inside + "</joint></robot>");
    const std::string o = "objects:\n  o: {urdf: odd.urdf, pose: {fixed: {}}";
    EXPECT_EQ(refusal(o + "}\n"), "accepted") << "held at 0 it does no harm";
    return refusal(o + ", joints: {topic: j}}\n");
  };
  EXPECT_HAS(refused("floating", ""), "objects/o/joints: joint 'j' is planar or floating");
  EXPECT_HAS(refused("planar", "<axis xyz='0 0 1'/>"), "joint 'j' is planar or floating");
  EXPECT_HAS(
      refused("continuous", "<axis xyz='0 0 0'/>"),
      "joint 'j' has the axis 0 0 0; it must be finite and not zero; joint states cannot move it: give "
      "pose: {tf: <root frame>, links: true}");
  EXPECT_HAS(refused("continuous", "<mimic joint='k'/>"), "joint 'j' mimics 'k', which is no movable joint");
  EXPECT_HAS(refused("continuous", "<mimic joint='j'/>"), "joint 'j' mimics itself");
  EXPECT_EQ(refused("continuous", ""), "accepted");
}

TEST_F(MovingParts, mimicsOfMimicsFollowTheJointThatMoves) {
  const auto chained = [&](const std::string& last) {
    std::string xml = "<robot name='o'><link name='l0'/>";
    for (const char* i : {"1", "2", "3"})
      xml += "<link name='l" + std::string(i) +
             "'><collision><geometry><sphere radius='1'/></geometry></collision></link>";
    const auto joint = [](const std::string& i, const std::string& mimic) {
      return "<joint name='j" + i + "' type='continuous'><parent link='l0'/><child link='l" + i + "'/>" +
             mimic + "</joint>";
    };
    xml += joint("1", "<mimic joint='j2' multiplier='2' offset='3'/>") +
           joint("2", "<mimic joint='j3' multiplier='-1' offset='5'/>") + joint("3", last) + "</robot>";
    folder_.write("chain.urdf", xml);
    return std::string("objects:\n  o: {urdf: chain.urdf, pose: {fixed: {}}, joints: {topic: j}}\n");
  };
  const auto scene = load(chained(""));
  const geometry::UrdfJoint& first = scene->objects[1].source.joints[0].joint;
  EXPECT_EQ(first.driver, "j3");
  EXPECT_EQ(first.multiplier, -2.0);
  EXPECT_EQ(first.offset, 2 * 5 + 3);
  EXPECT_HAS(refusal(chained("<mimic joint='j1'/>")), "joint 'j1' mimics a joint that mimics it in turn");
}

}  // namespace
}  // namespace collision_node::scene
