/// Several threads for work whose parts have nothing to do with each other. None is started before there is
/// enough to do.
#pragma once

#include <functional>
#include <memory>

namespace collision_node::scene {

class Crew {
 public:
  /// `threads`: at most so many work, the caller among them.
  explicit Crew(int threads);
  ~Crew();

  /// work(0) ... work(count - 1); returns when all are done. `is_enough`: worth more than one thread. They
  /// are begun in this order: what takes longest goes first.
  void forEach(std::size_t count, bool is_enough, const std::function<void(std::size_t)>& work);

 private:
  struct Arena;
  int threads_;
  std::unique_ptr<Arena> arena_;  ///< made when first needed
};

}  // namespace collision_node::scene
