/// What moves a random scene: streams with all the mishaps there are, and what else is done to an engine.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "test/scene/random_scene.h"

namespace collision_node::scene {

/// One call of the engine.
struct Act {
  enum class What { kPose, kFix, kClockWentBack, kFlush, kReset } what = What::kPose;
  Nanoseconds arrives_ns = 0;
  int object = 0;
  motion::StampedPose pose;
  bool guessed = false;
};

class RandomStreams {
 public:
  explicit RandomStreams(RandomScene& random) : dice_(random.dice()), random_(random) {
    const std::vector<Object>& objects = random.scene->objects;
    for (int i = 0; i < static_cast<int>(objects.size()); ++i)
      if (objects[i].source.type != PoseSource::Type::kFixed) addStream(i);
    if (dice_.chance(0.3)) playAgain();
    for (const Act::What what : {Act::What::kFlush, Act::What::kReset, Act::What::kClockWentBack})
      if (dice_.chance(0.08)) acts_.push_back({what, dice_.ms(0.0, 5000.0), 0, {}, false});
    std::stable_sort(acts_.begin(), acts_.end(),
                     [](const Act& l, const Act& r) { return l.arrives_ns < r.arrives_ns; });
    if (dice_.chance(0.3))  // as a window that begins in the middle
      acts_.erase(acts_.begin(), acts_.begin() + dice_.below(static_cast<int>(acts_.size() / 2 + 1)));
  }

  /// All, or what is done to the first `objects` of them and to the whole engine.
  void play(Rig& rig, int objects = std::numeric_limits<int>::max()) const {
    for (const Act& act : acts_) {
      if (act.object >= objects) continue;
      switch (act.what) {
        case Act::What::kPose:
          rig.engine.addPose(act.object, act.pose, act.guessed);
          break;
        case Act::What::kFix:
          rig.engine.fix(act.object, act.pose.pose);
          break;
        case Act::What::kClockWentBack:
          rig.engine.clockWentBack();
          break;
        case Act::What::kFlush:
          rig.engine.flush();
          break;
        case Act::What::kReset:
          rig.engine.reset();
          break;
      }
    }
    rig.engine.flush();
  }

 private:
  Vec3 anyPlace() { return random_.origin() + dice_.vector(0.5 * random_.side()); }

  /// A loop: the same stamps again, with or without a word of /clock.
  void playAgain() {
    const Nanoseconds later = dice_.ms(4200.0, 6000.0);
    std::vector<Act> round = acts_;
    for (Act& act : round) act.arrives_ns += later;
    if (dice_.chance(0.5)) round.push_back({Act::What::kClockWentBack, later, 0, {}, false});
    acts_.insert(acts_.end(), round.begin(), round.end());
  }

  void addStream(int object) {
    if (dice_.chance(0.08)) {  // its source says that it stands, early or late
      Act act{Act::What::kFix, dice_.ms(0.0, dice_.chance(0.5) ? 10.0 : 3000.0), object, {}, false};
      act.pose.pose = {anyPlace(), dice_.turn()};
      acts_.push_back(act);
      return;
    }
    const Object& what = random_.scene->objects[object];
    const double max_gap = random_.scene->time.max_gap, timeout = random_.scene->time.timeout;
    const double period = dice_.real(10.0, dice_.chance(0.2) ? 400.0 : 60.0);  // [ms]
    // Fast ones also fly far out of the cube: shots.
    const double speed = dice_.chance(0.2) ? 400.0 : dice_.chance(0.1) ? 2000.0 : 4.0;
    const double limit = speed > 1000.0 ? 100.0 : 0.5 * random_.side();
    // Of some, each pose shows nearly no turn, and the twist says many whole ones.
    const bool hides_turns = dice_.chance(0.1);
    const double whole_turns = 2e3 * M_PI / period * (1 + dice_.below(50));  // [rad/s]
    const double turn = hides_turns         ? dice_.anySize(1e-12, 0.1)
                        : dice_.chance(0.2) ? dice_.anySize(1.0, 1e5)
                                            : 0.3;
    const double spin = turn + (hides_turns ? whole_turns : 0.0);  // [rad/s]
    const bool often_rests = dice_.chance(0.3), guesses_stamps = dice_.chance(0.1);
    const bool has_twist = dice_.chance(what.motion == MotionModel::kSlerp ? 0.1 : 0.9);
    bool begins_again = dice_.chance(0.5 / static_cast<double>(random_.scene->objects.size()));
    const bool guesses_twists = dice_.chance(0.2), is_ahead = dice_.chance(0.05);
    const Nanoseconds delay = dice_.chance(0.3) ? dice_.ms(0.0, 0.95e3 * timeout) : 0;
    const double shuffles = dice_.chance(0.7) ? 80.0 : 300.0;  // [ms]
    Vec3 place = dice_.vector(limit), velocity = dice_.vector(speed);
    const Vec3 axis = dice_.vector(1.0).normalized();
    double angle = 0.0;
    Nanoseconds stamp = dice_.ms(0.0, 100.0);
    if (dice_.chance(0.15)) stamp += dice_.ms(0.0, 2000.0);  // joins late
    const Nanoseconds ends = dice_.chance(0.15) ? dice_.ms(500.0, 3000.0) : 4000 * kMs;
    while (stamp < ends) {
      Act act;
      act.object = object;
      act.guessed = guesses_stamps;
      act.arrives_ns = is_ahead ? 0 : stamp + delay + dice_.ms(0.0, shuffles);
      act.pose.stamp_ns = stamp;
      act.pose.comes_ahead = is_ahead;
      act.pose.pose.position = random_.origin() + place;
      act.pose.pose.orientation = geometry::Quat(Eigen::AngleAxisd(std::fmod(angle, 6.3), axis));
      act.pose.has_twist = has_twist;
      act.pose.linear = guesses_twists ? dice_.vector(10.0 * speed) : velocity;
      act.pose.angular = spin * (guesses_twists ? dice_.vector(1.0) : axis);
      acts_.push_back(act);
      if (dice_.chance(0.01)) acts_.push_back(act);  // told twice
      if (dice_.chance(0.02)) velocity = dice_.vector(speed);
      const double step = dice_.chance(0.02) ? 0.01 * period : period;
      if (!often_rests || dice_.chance(0.3)) place += velocity * (1e-3 * step);
      angle += turn * 1e-3 * step;
      for (int k = 0; k < 3; ++k)
        if (std::abs(place[k]) > limit) velocity[k] = -std::copysign(velocity[k], place[k]);
      stamp += static_cast<Nanoseconds>(1e6 * step);
      if (dice_.chance(0.02)) stamp += dice_.ms(0.5e3 * max_gap, 3e3 * max_gap);  // a hole, or silence
      if (dice_.chance(0.01)) place = dice_.vector(limit);                        // a leap
      if (begins_again && dice_.chance(0.02)) {                                   // by itself
        stamp -= dice_.ms(0.0, 3000.0);
        begins_again = false;
      }
    }
  }

  Dice& dice_;
  RandomScene& random_;
  std::vector<Act> acts_;
};

}  // namespace collision_node::scene
