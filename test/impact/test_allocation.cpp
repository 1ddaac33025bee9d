/// "Allocates nothing after a workspace's and a solution's first calls of a kind, but for the shells of
/// bodies that turn by more than 7 rad in the piece" (impact/solve.h).
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "collision_node/geometry/body.h"
#include "collision_node/impact/solve.h"
#include "test/impact/any_scene.h"

namespace {
thread_local std::size_t allocations = 0;
}  // namespace

// Of the whole test program; the aligned forms (Eigen and the hierarchies) end in these or in aligned_alloc.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size != 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto a = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(a, (size + a - 1) / a * a)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace {

using namespace collision_node;

TEST(Allocation, ThereIsNoneAfterTheFirstCallsOfAKind) {
  impact::Workspace workspace;
  impact::Solution solution;
  moving::forAll(1, [&](const moving::Scene& s, const auto&) {
    const geometry::Body a(s.a), b(s.b);
    const auto solveOnce = [&] { impact::solve(a, b, s.piece, s.options, workspace, solution); };
    solveOnce();
    solveOnce();  // buffers that change places have all had their turn
    const std::size_t before = allocations;
    solveOnce();
    const double turn = std::max(s.piece.a.omega.norm(), s.piece.b.omega.norm()) * s.duration();
    EXPECT_LE(allocations - before, turn > 7.0 ? 80u : 0u);
  });
}

}  // namespace
