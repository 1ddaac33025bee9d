#include "collision_node/report/scenes/scenes.h"

namespace collision_node::report {

std::vector<SceneMaker> allScenes() {
  return {
      {500, 30, [](std::size_t count) { return tankShots(count, 0.0); }},
      {500, 30, [](std::size_t count) { return tankShots(count, 0.05); }},
      {200, 10, [](std::size_t count) { return tumbling(1000, count); }},
      {100, 5, [](std::size_t count) { return tumbling(10000, count); }},
      {40, 2, [](std::size_t count) { return tumbling(100000, count); }},
      {200, 20, spinningBlade},
      {200, 30, grazingSpheres},
      {200, 30, grazingTip},
      {200, 30, sliding},
      {40, 4, deepOverlap},
      {200, 10, ballistic},
      {100, 8, largeOffset},
      {40, 4, highSpin},
      {1128, 1128, swarm},
  };
}

}  // namespace collision_node::report
