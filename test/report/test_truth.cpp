#include <gtest/gtest.h>
#include "collision_node/report/truth/marched_truth.h"
#include <chrono>
using namespace collision_node::report;
TEST(Truth, scratch) {
  const char* n[] = {"1k","10k","100k"};
  for (int i=0;i<3;++i) {
    int tri[] = {1000,10000,100000};
    QuerySet set = tumblingMeshes(tri[i], 10);
    auto t0=std::chrono::steady_clock::now();
    auto truths = marchedTruths(set);
    double s=std::chrono::duration<double>(std::chrono::steady_clock::now()-t0).count();
    printf("%s: %g s\n", n[i], s);
    auto ours = makeOurs(set);
    for (int q=0;q<10;++q){ auto a=ours->answer(set.queries[q]); auto&t=truths[q];
      printf("  %d %d  %.17g err %.3g  lo %.3g hi %.3g  point err %.3g off %.3g ball %.3g\n", int(t.verdict), int(a.verdict), t.toi, t.toi_error, a.toi_lower-t.toi, a.toi_upper-t.toi, t.point_error, (a.point-t.point).norm(), a.position_error);}
  }
}
