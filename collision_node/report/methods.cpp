#include "collision_node/report/methods.h"

#include "collision_node/report/methods/own_methods.h"
#include "collision_node/report/methods/peers.h"

namespace collision_node::report {
namespace {

#ifdef COLLISION_NODE_HAS_FCL
constexpr bool kHasFcl = true;
#else
constexpr bool kHasFcl = false;
#endif
#ifdef COLLISION_NODE_HAS_EMBREE
constexpr bool kHasEmbree = true;
#else
constexpr bool kHasEmbree = false;
#endif
#ifdef COLLISION_NODE_HAS_BULLET
constexpr bool kHasBullet = true;
#else
constexpr bool kHasBullet = false;
#endif

const char kAnything[] = "anything";

void addOurs(std::vector<Method>& methods) {
  for (const char* precision : {"1e-2", "1e-4", "1e-6", "1e-8", "1e-10", "1e-12"}) {
    impact::PairOptions options;
    options.time_precision = std::stod(precision);
    methods.push_back({"ours", std::string("ours, ") + precision + " s", kAnything, "", true,
                       [options](const QuerySet& set) { return makeOurs(set, options); }});
  }
  for (const int budget : {10, 100, 1000, 10000}) {
    impact::PairOptions options;
    options.time_precision = kPrecision;
    options.node_budget = static_cast<std::uint64_t>(budget);
    methods.push_back({"ours, budget", "ours, budget " + std::to_string(budget), kAnything, "", true,
                       [options](const QuerySet& set) { return makeOurs(set, options); }});
  }
}

void addOwn(std::vector<Method>& methods) {
  methods.push_back({"paper A", "paper A", kAnything, "", true, makePaperA});
  methods.push_back({"paper A", "paper A, sampled near S", kAnything, "", true, makePaperASampled});
  methods.push_back({"paper B", "paper B", kAnything, "", true, makePaperB});
  methods.push_back({"paper B", "paper B, sampled near S", kAnything, "", true, makePaperBSampled});
  methods.push_back({"static test at stamps", "static test at stamps", kAnything, "", true, makeStamps});
  for (const int steps : {10, 100, 1000, 10000}) {
    methods.push_back({"subdivision", "subdivision " + std::to_string(steps), kAnything, "", true,
                       [steps](const QuerySet& set) { return makeSubdivision(set, steps); }});
  }
  for (const int samples : {10, 100, 1000}) {
    methods.push_back({"4D intersection", "4D intersection, " + std::to_string(samples) + " samples",
                       kAnything, "", true,
                       [samples](const QuerySet& set) { return makeSweptVolumes(set, samples); }});
  }
  methods.push_back({"line of sight", "line of sight", kAnything, "", true, makeLineOfSight});
}

void addPeers(std::vector<Method>& methods) {
  for (const int steps : {10, 100, 1000, 10000}) {
    methods.push_back({"FCL naive", "FCL naive " + std::to_string(steps), "meshes and primitives", "FCL",
                       kHasFcl, [steps](const QuerySet& set) { return makeFclSamples(set, steps); }});
  }
  for (const char* gap : {"1e-3", "1e-5", "1e-7"}) {
    methods.push_back({"fcl::distance advancement", std::string("fcl::distance advancement, ") + gap + " m",
                       "meshes and primitives", "FCL", kHasFcl,
                       [gap = std::stod(gap)](const QuerySet& set) { return makeFclAdvancement(set, gap); }});
  }
  methods.push_back({"FCL shape advancement", "FCL shape advancement", "two primitives on straight paths",
                     "FCL", kHasFcl, makeFclPrimitives});
  methods.push_back({"Bullet convex sweep", "Bullet convexSweepTest",
                     "a sphere on a straight path, a mesh or sphere that does not turn", "Bullet", kHasBullet,
                     makeBulletSweep});
  methods.push_back({"Bullet continuous", "btContinuousConvexCollision", "two primitives on straight paths",
                     "Bullet", kHasBullet, makeBulletContinuous});
  methods.push_back({"Embree ray", "Embree ray", "a point on a straight path, a mesh that does not turn",
                     "Embree", kHasEmbree, makeEmbreeRays});
}

}  // namespace

std::vector<Method> allMethods() {
  std::vector<Method> methods;
  addOurs(methods);
  addOwn(methods);
  addPeers(methods);
  return methods;
}

}  // namespace collision_node::report
