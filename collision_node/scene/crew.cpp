#include "collision_node/scene/crew.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
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
  // One by one, as what a part costs differs a thousandfold, and from the first to the last.
  std::atomic<std::size_t> next{0};
  arena_->arena.execute([&] {
    tbb::parallel_for(0, threads_, [&](int) {
      for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) work(i);
    });
  });
}

}  // namespace collision_node::scene
