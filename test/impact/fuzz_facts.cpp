#include "test/impact/fuzz_facts.h"

#include <cstdarg>
#include <cstdio>

namespace fuzz {

namespace impact = collision_node::impact;
namespace motion = collision_node::motion;
using impact::PairEvent;
using oracle::Pair;
using oracle::Real;
using oracle::V3;

std::string text(const char* format, ...) {
  char buffer[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

namespace {

class FactCheck {
 public:
  FactCheck(const Case& c, const Pair& pair, const Truth& truth, std::vector<std::string>& complaints)
      : case_(c), pair_(pair), truth_(truth), complaints_(complaints) {}

  Facts where(const PairEvent& e) {
    Facts done;

    const impact::Piece& piece = case_.piece;
    const V3 origin = oracle::exact(piece.a.c[0]);
    const V3 position = oracle::exact(e.position) - origin;
    const Real width = e.toi_upper - e.toi_lower;
    if (!(e.position_error >= 0 && std::isfinite(e.position_error)))
      complain("position_error %.6g", e.position_error);
    if (truth_.point_known && !e.multiple) {
      done.point = true;
      const Real off = norm(position - truth_.point);
      // The oracle's own point is as good as its bracket and the spread of its witnesses.
      // Where it comes from a minimum along a cylinder, that is as flat as the body is large: its place is
      // known to the square root of 80 bits' rounding.
      const Real flat = pair_.hasTwoCylinders() ? 1e-6L : pair_.hasCylinder() ? 4e-10L : 0;
      const Real own =
          truth_.point_spread + 100 * pair_.touchDistance() + flat * pair_.size() + 1e-13L * pair_.smaller();
      // While two round bodies overlap by speed times bracket, they do so over the square root of that. The
      // ball is in the world, where both move meanwhile. At a distance flat sides face each other almost as
      // long as they are.
      const Real open_for = std::max(width, truth_.width);
      const Real overlap = pair_.maxSpeed() * open_for;
      const Real carried = norm(pair_.pathA().at(e.toi_lower).velocity) * open_for;
      const Real largest = 1e-6L + 1e-4L * pair_.size() + 100 * overlap +
                           3 * std::sqrt(pair_.size() * overlap) + 10 * carried + 1e-14L * norm(origin) +
                           (case_.options.contact_distance > 0 ? 0.05L * pair_.size() : 0);
      if (truth_.point_sharp && e.position_error > largest)
        complain("position_error %.6g m of a sharp contact, size %.6Lg m", e.position_error, pair_.size());
      if (off > e.position_error + own)
        complain("contact point off by %.6Lg m, position_error %.6g m", off, e.position_error);
    }
    if (!e.multiple) {
      done.normal = true;
      const Real off = angleBetween(oracle::exact(e.normal), truth_.normal);
      if (!(std::abs(norm(oracle::exact(e.normal)) - 1) < 1e-9L))
        complain("normal of length %.9Lg", norm(oracle::exact(e.normal)));
      if (!(off <= e.normal_error + truth_.normal_spread))
        complain("normal off by %.6Lg rad, normal_error %.6g", off, e.normal_error);
    }
    const oracle::Frame fa = pair_.pathA().at(e.toi_lower), fb = pair_.pathB().at(e.toi_lower);
    const V3 velocity = fb.velocityAt(position) - fa.velocityAt(position);
    const Real spin = pair_.pathA().spin() + pair_.pathB().spin();
    const Real tolerance =
        1e-6L * pair_.maxSpeed() + 2 * spin * e.position_error + 2 * pair_.maxAcceleration() * width;
    const Real off = norm(oracle::exact(e.relative_velocity) - velocity);
    if (!(off <= tolerance)) complain("relative_velocity off by %.6Lg m/s of %.6Lg m/s", off, norm(velocity));
    if (!(std::abs(e.closing_speed + dot(oracle::exact(e.relative_velocity), oracle::exact(e.normal))) <=
          1e-9L * pair_.maxSpeed())) {
      complain("closing_speed %.9g is not -(relative_velocity . normal)", e.closing_speed);
    }
    side("a", e.a, fa, piece.a, e, origin);
    side("b", e.b, fb, piece.b, e, origin);
    return done;
  }

 private:
  template <class... Arguments>
  void complain(const char* format, Arguments... arguments) {
    complaints_.push_back(text(format, arguments...));
  }

  void side(const char* name, const impact::Side& s, const oracle::Frame& frame, const motion::RigidMotion& m,
            const PairEvent& e, const V3& origin) {
    const Real travel = norm(oracle::exact(m.c[1])) * motion::secondsBetween(m.start_ns, m.end_ns);
    const Real world = norm(origin) + travel + pair_.scale();
    const V3 pose = oracle::exact(s.pose.position) - origin;
    if (!(norm(pose - frame.position) <= 1e-12L * pair_.scale() + 1e-15L * world)) {
      complain("side %s: pose off by %.6Lg m", name, norm(pose - frame.position));
    }
    const V3 point = frame.place(oracle::exact(s.point));
    const Real off = norm(point - (oracle::exact(e.position) - origin));
    const Real allowed = 2 * e.position_error + pair_.maxSpeed() * (e.toi_upper - e.toi_lower) +
                         1e-9L * pair_.scale() + 1e-15L * world;
    if (!(off <= allowed))
      complain("side %s: witness %.6Lg m from the position, ball %.6g m", name, off, e.position_error);
    if (s.sample_before_ns != m.start_ns || s.sample_after_ns != m.end_ns)
      complain("side %s: not its own two stamps", name);
  }

  const Case& case_;
  const Pair& pair_;
  const Truth& truth_;
  std::vector<std::string>& complaints_;
};

}  // namespace

Facts checkFacts(const Case& c, const Pair& pair, const Truth& truth, const PairEvent& e,
                 std::vector<std::string>& complaints) {
  return FactCheck(c, pair, truth, complaints).where(e);
}

}  // namespace fuzz
