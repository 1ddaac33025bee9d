#include "collision_node/report/scenes/scenes.h"

namespace collision_node::report {

std::vector<SceneMaker> allScenes() {
  return {
      {200, 30, [](std::size_t count) { return tankShots(count, 0.0); }},
      {200, 30, [](std::size_t count) { return tankShots(count, 0.05); }},
      {100, 10, [](std::size_t count) { return tumbling(1000, count); }},
      {60, 5, [](std::size_t count) { return tumbling(10000, count); }},
      {30, 2, [](std::size_t count) { return tumbling(100000, count); }},
      {100, 20, spinningBlade},
      {100, 30, grazingSpheres},
      {100, 30, grazingTip},
      {100, 30, sliding},
      {40, 4, deepOverlap},
      {100, 10, ballistic},
      {60, 8, largeOffset},
      {40, 4, highSpin},
      {1128, 200, swarm},
  };
}

}  // namespace collision_node::report
