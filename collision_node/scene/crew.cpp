#include "collision_node/scene/crew.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <thread>

namespace collision_node::scene {

struct Crew::Arena {
  explicit Arena(int threads)
      : arena(std::min(threads, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())))) {}
  tbb::task_arena arena;
};

Crew::Crew(int threads) : threads_(std::max(1, threads)) {}
Crew::~Crew() = default;

void Crew::forEach(std::size_t count, bool is_enough, const std::function<void(std::size_t)>& work) {
  if (threads_ == 1 || !is_enough || count < 2) {
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  if (!arena_) arena_ = std::make_unique<Arena>(threads_);
  // One by one: what a pair costs differs a thousandfold.
  arena_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1), [&](const auto& range) { work(range.begin()); },
        tbb::simple_partitioner());
  });
}

}  // namespace collision_node::scene
