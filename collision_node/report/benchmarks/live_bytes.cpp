// Counts what this program allocates: every container of ours goes through operator new.
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "collision_node/report/benchmarks/other_rows.h"

namespace {

std::atomic<std::size_t> live{0};

void* counted(void* block) {
  if (block == nullptr) throw std::bad_alloc();
  live += malloc_usable_size(block);
  return block;
}

void release(void* block) {
  if (block != nullptr) live -= malloc_usable_size(block);
  std::free(block);
}

}  // namespace

void* operator new(std::size_t size) { return counted(std::malloc(size ? size : 1)); }
void* operator new(std::size_t size, std::align_val_t align) {
  const auto to = static_cast<std::size_t>(align);
  return counted(std::aligned_alloc(to, (size + to - 1) / to * to));
}
void operator delete(void* block) noexcept { release(block); }
void operator delete(void* block, std::size_t) noexcept { release(block); }
void operator delete(void* block, std::align_val_t) noexcept { release(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { release(block); }

namespace collision_node::report {
std::size_t liveBytes() { return live; }
}  // namespace collision_node::report
