/// linear_features.h and the whole solver against published queries with exact truth, which lie beside the
/// checkout (../shared/data/ccd-queries) and are skipped with a message where they do not.
/// Source of the data: Wang, Ferguson, Schneider, Jiang, Attene, Panozzo, "A Large Scale Benchmark and an
/// Inclusion-Based Algorithm for Continuous Collision Detection", ACM TOG 40(5), 2021.
#include <gtest/gtest.h>

#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "test/impact/linear_query.h"
#include "test/impact/watched_pair.h"

namespace linear {
namespace {

struct Published {
  Query query;
  bool touches = false;
  std::string set, where;
};

double exactDouble(const std::string& numerator, const std::string& denominator) {
  mpq_class value{mpz_class(numerator), mpz_class(denominator)};
  value.canonicalize();
  if (mpq_class(value.get_d()) != value)
    throw std::runtime_error("no double: " + numerator + "/" + denominator);
  return value.get_d();
}

std::vector<Published> readFile(const std::filesystem::path& path) {
  std::vector<Published> out;
  std::ifstream file(path);
  Published one;
  const std::string kind = path.parent_path().filename(),
                    folder = path.parent_path().parent_path().filename();
  one.query.edges = kind == "edge-edge";
  one.set = (folder == "unit-tests" ? "hand-made " : "simulation ") + kind;
  int row = 0;
  for (std::string line; std::getline(file, line); ++row) {
    std::istringstream cells(line);
    std::array<std::string, 7> cell;
    for (std::string& c : cell) std::getline(cells, c, ',');
    LinearVertex& v = one.query.vertices[row % 4];
    Vec3& x = row % 8 < 4 ? v.start : v.end;
    for (int i = 0; i < 3; ++i) x[i] = exactDouble(cell[2 * i], cell[2 * i + 1]);
    if (row % 8 != 7) continue;
    one.touches = cell[6].at(0) == '1';
    one.where = folder + "/" + kind + "/" + path.filename().string() + ", rows to " + std::to_string(row + 1);
    out.push_back(one);
  }
  return out;
}

const std::vector<Published>& published() {
  static const std::vector<Published> all = [] {
    std::vector<Published> out;
    const std::filesystem::path root = std::filesystem::path(SOURCE_DIR) / "../shared/data/ccd-queries";
    if (!std::filesystem::exists(root)) return out;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      if (entry.path().extension() == ".csv") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
      for (Published& one : readFile(file)) out.push_back(std::move(one));
    }
    return out;
  }();
  return all;
}

class PublishedQueries : public ::testing::Test {
 protected:
  void SetUp() override {
    if (published().empty()) GTEST_SKIP() << "no ../shared/data/ccd-queries beside the checkout";
  }
};

/// Verdicts that do not depend on the machine are asserted; times are only printed.
double threadMicroseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

struct Score {
  int asked = 0, touching = 0, missed = 0, confirmed = 0, apart = 0, invented = 0, undecided = 0;
  double total_us = 0.0, worst_us = 0.0, widest = 0.0;
};

TEST_F(PublishedQueries, NoneIsMissedNoneIsInventedAndFewStayOpen) {
  std::map<std::string, Score> scores;
  for (const Published& one : published()) {
    Score& s = scores[one.set];
    LinearContact contact;
    double best_us = 1e9;  // of three: another program's turn on the processor is not ours
    for (int i = 0; i < 3; ++i) {
      const double start = threadMicroseconds();
      contact = ask(one.query);
      best_us = std::min(best_us, threadMicroseconds() - start);
    }
    ++s.asked;
    s.total_us += best_us;
    s.worst_us = std::max(s.worst_us, best_us);
    if (contact.verdict != LinearVerdict::kClear) s.widest = std::max(s.widest, contact.t_hi - contact.t_lo);
    if (one.touches) {
      ++s.touching;
      s.missed += contact.verdict == LinearVerdict::kClear;
      s.confirmed += contact.verdict == LinearVerdict::kImpact;
      EXPECT_NE(contact.verdict, LinearVerdict::kClear) << one.where;
    } else {
      ++s.apart;
      s.invented += contact.verdict == LinearVerdict::kImpact;
      s.undecided += contact.verdict == LinearVerdict::kUndecided;
      EXPECT_NE(contact.verdict, LinearVerdict::kImpact) << one.where;
    }
  }
  int open = 0, apart = 0;
  for (const auto& [set, s] : scores) {
    std::printf(
        "%s: %d asked; %d touch, %d missed, %d confirmed; %d apart, %d invented, %d undecided; "
        "widest bracket %.2g; mean %.2f us, worst %.1f us\n",
        set.c_str(), s.asked, s.touching, s.missed, s.confirmed, s.apart, s.invented, s.undecided, s.widest,
        s.total_us / s.asked, s.worst_us);
    EXPECT_LT(s.worst_us, 1000.0) << set << ": a query may cost a millisecond of this thread's time";
    open += s.undecided + s.invented;
    apart += s.apart;
  }
  EXPECT_LE(open, apart * 3 / 100);
}

TEST_F(PublishedQueries, TheExactOracleAgreesAndItsFirstTouchLiesInEveryBracket) {
  int index = 0;
  for (const Published& one : published()) {
    if (!one.touches && index++ % 16 != 0) continue;  // all that touch, a sixteenth of the others
    const auto touch = truth(one.query);
    ASSERT_EQ(touch.has_value(), one.touches) << one.where;
    if (!touch) continue;
    const LinearContact contact = ask(one.query);
    ASSERT_NE(contact.verdict, LinearVerdict::kClear) << one.where;
    EXPECT_LE(oracle::Rational(contact.t_lo), touch->high) << one.where;
    EXPECT_GE(oracle::Rational(contact.t_hi), touch->low) << one.where;
  }
}

TEST_F(PublishedQueries, ScaleDoesNotChangeTheAnswer) {
  for (const Published& one : published()) {
    const LinearContact contact = ask(one.query);
    for (const int power : {-20, 20, 40}) {
      const Query scaled =
          changed(one.query, [&](const Vec3& x, double) -> Vec3 { return x * std::ldexp(1.0, power); });
      EXPECT_TRUE(same(contact, ask(scaled))) << one.where << " times 2^" << power;
    }
  }
}

/// Offset and velocity that all vertices share cancel before anything rounds. Most published coordinates have
/// no room for them in a double: those are first moved onto a grid of 2^-44, both times.
TEST_F(PublishedQueries, ACommonDyadicDriftDoesNotChangeTheAnswer) {
  const Vec3 offset(64, -32, 16), velocity(-32, 64, 40);
  const auto drift = [&](const Vec3& x, double t) -> Vec3 { return x + offset + t * velocity; };
  int as_published = 0;
  for (const Published& one : published()) {
    bool exact = true;
    changed(one.query, [&](const Vec3& x, double t) -> Vec3 {
      const Vec3 moved = drift(x, t);
      for (int i = 0; i < 3; ++i) {
        const mpq_class sum = mpq_class(x[i]) + mpq_class(offset[i]) + mpq_class(t) * mpq_class(velocity[i]);
        exact = exact && mpq_class(moved[i]) == sum;
      }
      return moved;
    });
    Query query = one.query;
    if (!exact) {
      query = changed(query, [](const Vec3& x, double) -> Vec3 {
        return {std::nearbyint(x.x() * 0x1p44) * 0x1p-44, std::nearbyint(x.y() * 0x1p44) * 0x1p-44,
                std::nearbyint(x.z() * 0x1p44) * 0x1p-44};
      });
    }
    as_published += exact;
    EXPECT_TRUE(same(ask(query), ask(changed(query, drift)))) << one.where;
  }
  std::printf("%d of %zu drift as published, the others on a grid of 2^-44\n", as_published,
              published().size());
}

/// The velocity in one second when all `vertices` share it and it is a double.
std::optional<Vec3> sharedVelocity(const LinearVertex* vertices, int count) {
  const Vec3 velocity = vertices[0].end - vertices[0].start;
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i < 3; ++i) {
      const mpq_class way = mpq_class(vertices[k].end[i]) - mpq_class(vertices[k].start[i]);
      if (way != mpq_class(velocity[i])) return std::nullopt;
    }
  }
  return velocity;
}

/// A vertex as a point that starts at its body's origin; the others as a body whose origin is the world's. An
/// edge is a triangle with two corners in one place.
moving::PlacedShape bodyOf(const LinearVertex* vertices, int count) {
  if (count == 1) return moving::placed(collision_node::geometry::Point{});
  std::vector<Vec3> corners;
  for (int k = 0; k < count; ++k) corners.push_back(vertices[k].start);
  while (corners.size() < 3) corners.push_back(corners.back());
  return moving::mesh(corners, {{0, 1, 2}}, moving::SolidChoice::kNo);
}

TEST_F(PublishedQueries, ThoseThatOnlyTranslateGoThroughTheWholeSolver) {
  constexpr moving::Nanoseconds kSecond = 1'000'000'000;
  std::map<std::string, Score> scores;
  for (const Published& one : published()) {
    const LinearVertex* v = one.query.vertices.data();
    const int count_a = one.query.edges ? 2 : 1, count_b = 4 - count_a;
    const auto velocity_a = sharedVelocity(v, count_a), velocity_b = sharedVelocity(v + count_a, count_b);
    if (!velocity_a || !velocity_b) continue;
    moving::Watched pair({bodyOf(v, count_a)}, {bodyOf(v + count_a, count_b)});
    pair.advance(0, kSecond, moving::flight(0, kSecond, count_a == 1 ? v->start : Vec3::Zero(), *velocity_a),
                 moving::flight(0, kSecond, Vec3::Zero(), *velocity_b));
    pair.finish();
    Score& s = scores[one.set];
    ++s.asked;
    const bool said = !pair.events.empty();
    bool confirmed = false;
    for (const auto& event : pair.events) {
      confirmed = confirmed || event.certificate == moving::Certificate::kConfirmed;
    }
    if (one.touches) {
      ++s.touching;
      s.missed += !said;
      s.confirmed += confirmed;
      EXPECT_TRUE(said) << one.where;
      const auto touch = truth(one.query);
      ASSERT_TRUE(touch) << one.where;
      // Some event's bracket, or the contact it opened, holds the first touch.
      if (said) {
        EXPECT_LE(oracle::Rational(pair.events.front().toi_lower), touch->high) << one.where << '\n'
                                                                                << pair.list();
        EXPECT_GE(oracle::Rational(pair.events.front().toi_upper), touch->low) << one.where << '\n'
                                                                               << pair.list();
      }
    } else {
      ++s.apart;
      s.invented += confirmed;
      s.undecided += said && !confirmed;
      EXPECT_FALSE(confirmed) << one.where << '\n' << pair.list();
    }
  }
  for (const auto& [set, s] : scores) {
    std::printf("%s: %d asked; %d touch, %d missed, %d confirmed; %d apart, %d invented, %d possible\n",
                set.c_str(), s.asked, s.touching, s.missed, s.confirmed, s.apart, s.invented, s.undecided);
  }
}

}  // namespace
}  // namespace linear
