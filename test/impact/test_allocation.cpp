/// "Allocates nothing after a workspace's and a solution's first calls of a kind" (impact/solve.h).
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
    EXPECT_EQ(allocations - before, 0u);
  });
}

TEST(Allocation, ThereIsNoneForTheShellsOfBodiesThatTurnFar) {
  // Both turn a hundred times, about axes of their own in each piece, and meet in every other one.
  const geometry::Body mesh({moving::torus(1.0, 0.2, 20, 12)});
  const geometry::Body blade({moving::placed(geometry::Box{{2, 0.2, 0.1}})});
  impact::Workspace workspace;
  impact::Solution solution;
  int met = 0;
  for (int i = 0; i < 12; ++i) {
    fuzz::Random random(71, i);
    const double spin = 2e4;
    const impact::Piece piece{
        0, moving::kFrame, moving::flight(0, moving::kFrame, {0, 0, 0}, {0, 0, 0}, spin * random.direction()),
        moving::flight(0, moving::kFrame, {-30, i % 2 == 0 ? 3.0 : 0.7, 0}, {2000, 0, 0},
                       spin * random.direction())};
    const auto solveOnce = [&] { impact::solve(mesh, blade, piece, {}, workspace, solution); };
    solveOnce();
    solveOnce();
    const std::size_t before = allocations;
    solveOnce();
    EXPECT_EQ(allocations - before, 0u) << i;
    met += !solution.events.empty();
  }
  EXPECT_GE(met, 6);
}

}  // namespace
