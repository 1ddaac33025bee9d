#include "collision_node/report/methods.h"

#include "collision_node/report/peers.h"

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

const char kAnything[] = "all shapes and motions";

std::string power(int exponent) { return "1e" + std::to_string(exponent); }

void addOurs(std::vector<Method>& methods) {
  for (int exponent = -2; exponent >= -12; exponent -= 2) {
    impact::PairOptions options;
    options.time_precision = std::stod(power(exponent));
    methods.push_back({"ours", "ours, " + power(exponent) + " s", kAnything, "", true,
                       [options](const QuerySet& set) { return makeOurs(set, options); }});
  }
}

void addPeers(std::vector<Method>& methods) {
  const char meshes[] = "pairs of meshes on straight paths";
  methods.push_back(
      {"fcl::distance advancement", "fcl::distance advancement", meshes, "FCL", kHasFcl, makeFclAdvancement});
  methods.push_back({"FCL sampling", "FCL, 1000 samples", meshes, "FCL", kHasFcl, makeFclSampling});
  methods.push_back({"FCL advancement", "FCL advancement", "pairs of primitives on straight paths", "FCL",
                     kHasFcl, makeFclPrimitives});
  methods.push_back({"Embree ray", "Embree ray", "points on straight paths, mesh at rest", "Embree",
                     kHasEmbree, makeEmbreeRays});
  methods.push_back({"Bullet sweep", "Bullet sphere sweep", "spheres on straight paths, mesh at rest",
                     "Bullet", kHasBullet, makeBulletSweep});
}

}  // namespace

std::vector<Method> allMethods() {
  std::vector<Method> methods;
  addOurs(methods);
  addPeers(methods);
  return methods;
}

}  // namespace collision_node::report
