/// Pairs at the edges of what bodies and motions can be: meshes of one point, of a line, of needles and fans
/// with triangles twice; wires, discs and plates; sizes 15 decades apart; contact distances beyond the sizes;
/// pieces of 1 ns to 1e9 s; twists and spins far beyond the path; the same motion for both.
#include <algorithm>
#include <cmath>

#include "test/impact/fuzz_case.h"
#include "test/impact/moving_pair.h"

namespace fuzz {

namespace g = collision_node::geometry;
using g::Vec3;
using moving::placed;
using moving::randomVec;
using oracle::V3;

namespace {

struct EdgeBody {
  moving::Shapes shapes;
  std::string kind;
  Vec3 aim = Vec3::Zero();  ///< a point of it
};

/// A fan around a vertex; some triangles come again, with the same or the other sense.
void addFan(Random& random, double size, std::vector<Vec3>& v, std::vector<moving::Corners>& t) {
  const int n = 6 + random.below(10);
  v.push_back(randomVec(random, 0.01 * size));
  for (int i = 0; i < n; ++i) {
    const double phi = 6.283185307179586 * i / n;
    v.push_back({size * std::cos(phi), size * std::sin(phi), 0.3 * size * random.unit()});
    t.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  for (const moving::Corners& extra : {moving::Corners{1, 2, 3}, {0, 1, 2}, {0, 2, 1}}) {
    if (random.chance(0.3)) t.push_back(extra);
  }
}

EdgeBody makeBody(Random& random, double size) {
  constexpr const char* kKinds[] = {"one point", "line",    "needles",  "wire", "disc", "plate",
                                    "sphere",    "capsule", "flat box", "fan",  "point"};
  const int kind = random.below(11);
  EdgeBody out;
  out.kind = kKinds[kind];
  std::vector<Vec3> v;
  std::vector<moving::Corners> t;
  const Vec3 p = randomVec(random, size), d = randomVec(random, size);
  const double thin = size * random.decade(-7, -2), any = size * random.decade(-6, 0);
  switch (kind) {
    case 0:
      v = {p, p, p}, t = {{0, 1, 2}};
      break;
    case 1:
      v = {p, p + d, p + 0.5 * d}, t = {{0, 1, 2}};
      break;
    case 2: {
      const double w = random.decade(-14, -3);
      v = {p, p + d, p + random.unit() * d + w * randomVec(random, size),
           p - 0.1 * random.unit() * d + w * randomVec(random, size)};
      t = {{0, 1, 2}, {0, 3, 1}};
      break;
    }
    case 3:
      out.shapes = {placed(g::Cylinder{thin, size})};
      break;
    case 4:
      out.shapes = {placed(g::Cylinder{size, thin})};
      break;
    case 5:
      out.shapes = {placed(g::Box{{size, size * random.in(0.1, 1), thin}})};
      break;
    case 6:
      out.shapes = {placed(g::Sphere{any})};
      break;
    case 7:
      out.shapes = {placed(g::Capsule{any, size * random.decade(-6, 0)})};
      break;
    case 8:
      moving::addBox(v, t, Vec3::Zero(), Vec3(size, any, size * random.decade(-9, -1)));
      break;
    case 9:
      addFan(random, size, v, t);
      break;
    default:
      out.shapes = {placed(g::Point{})};
  }
  if (!out.shapes.empty()) {
    out.aim = pointOf(random, out.shapes[0].shape);
    return out;
  }
  out.shapes = {moving::mesh(v, t)};
  const auto at = [&](std::int32_t i) { return v[static_cast<std::size_t>(i)]; };
  const moving::Corners c = t[static_cast<std::size_t>(random.below(static_cast<int>(t.size())))];
  const double s = random.chance(0.5) ? 0.0 : random.unit(), u = random.unit() * (1 - s);
  out.aim = s == 0.0 ? at(c[0]) : Vec3(at(c[0]) * (1 - s - u) + s * at(c[1]) + u * at(c[2]));
  return out;
}

}  // namespace

Case makeEdgeCase(std::uint64_t seed, int index) {
  Random random(seed ^ 0x65646765, index);
  Case out;
  out.seed = seed, out.index = index;
  const double size = random.chance(0.5) ? 1.0 : random.decade(-9, 6);
  const double other = size * (random.chance(0.6) ? random.decade(-1, 1) : random.decade(-6, 6));
  const EdgeBody a = makeBody(random, size), b = makeBody(random, std::clamp(other, 1e-9, 1e6));
  out.a = a.shapes, out.b = b.shapes;
  out.kind = a.kind + " - " + b.kind;
  double reach = static_cast<double>(oracle::makeModel(out.a).reach + oracle::makeModel(out.b).reach);
  if (reach == 0) reach = size;
  if (random.chance(0.25)) out.options.contact_distance = reach * random.decade(-9, 1.5);

  constexpr double kSpans[] = {1, 10, 1e3, 1e6, 1e8, 1e9, 1e12, 1e18};  // [ns]
  const auto span = static_cast<collision_node::motion::Nanoseconds>(kSpans[random.below(8)]);
  const double h = 1e-9 * static_cast<double>(span);
  if (random.chance(0.75)) out.options.time_precision = (random.chance(0.6) ? 1e-14 : 1e-9) * h;
  collision_node::impact::Piece& piece = out.piece;
  piece.start_ns = 1'700'000'000'000'000'000;
  piece.end_ns = piece.start_ns + span;
  const double path = reach * random.decade(-3, 3);
  for (auto* m : {&piece.a, &piece.b}) {
    m->start_ns = piece.start_ns, m->end_ns = piece.end_ns;
    m->q0 = random.orientation();
    const double turn = random.chance(0.3)   ? 0.0
                        : random.chance(0.1) ? random.decade(-18, -6)
                        : random.chance(0.7) ? random.in(0, 6)
                                             : random.decade(0, 3.5);
    m->omega = turn / h * random.direction();
    if (!random.chance(0.3)) continue;
    const double twist = path * random.decade(-2, 2);
    m->c[2] = twist / (h * h) * random.direction();
    m->c[3] = twist / (h * h * h) * random.direction();
    if (random.chance(0.5)) m->c[1] = twist / h * random.direction();
  }
  piece.b.c[1] += path / h * random.direction();
  if (random.chance(0.1)) piece.b = piece.a;
  const double pick = random.unit(), at = pick < 0.1 ? 0.0 : pick < 0.2 ? h : h * random.in(0, 1.5);
  const oracle::Frame fa = oracle::Path(piece.a, piece.start_ns, {}).at(at),
                      fb = oracle::Path(piece.b, piece.start_ns, {}).at(at);
  const double aside = random.chance(0.5) ? 0.0 : reach * random.decade(-12, 0.5);
  const V3 shift = fa.place(oracle::exact(a.aim)) - fb.place(oracle::exact(b.aim)) +
                   aside * oracle::exact(random.direction());
  piece.b.c[0] +=
      Vec3(static_cast<double>(shift.x), static_cast<double>(shift.y), static_cast<double>(shift.z));
  return out;
}

}  // namespace fuzz
