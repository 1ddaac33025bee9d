#include "collision_node/replay/progress.h"

#include <algorithm>
#include <cstdio>
#include <string>

namespace collision_node::replay {

namespace {

constexpr int kWidth = 40, kLine = 79;

/// "12 s", "3:05", "2:10:00".
std::string duration(double seconds) {
  const auto all = static_cast<long>(seconds + 0.5);
  char text[32];
  if (all < 60) {
    std::snprintf(text, sizeof text, "%ld s", all);
  } else if (all < 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld", all / 60, all % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", all / 3600, all / 60 % 60, all % 60);
  }
  return text;
}

}  // namespace

Progress::Progress(std::ostream& err, bool show, motion::Nanoseconds begin_ns, motion::Nanoseconds end_ns)
    : err_(err),
      show_(show && end_ns > begin_ns),
      begin_(1e-9 * static_cast<double>(begin_ns)),
      length_(1e-9 * static_cast<double>(end_ns) - begin_) {}

void Progress::look(motion::Nanoseconds received_ns) {
  const auto now = Clock::now();
  if (now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  is_drawn_ = true;
  const double done = std::clamp((1e-9 * static_cast<double>(received_ns) - begin_) / length_, 0.0, 1.0);
  const double took = std::chrono::duration<double>(now - start_).count();
  char text[96];
  std::snprintf(text, sizeof text, "] %3.0f %% %6.0f k/s", 100.0 * done,
                1e-3 * static_cast<double>(messages_) / took);
  std::string line = "[" + std::string(static_cast<std::size_t>(done * kWidth), '#');
  line.resize(1 + kWidth, ' ');
  line += text;
  if (done > 0.0) line += ", " + duration(took * (1.0 - done) / done) + " left";
  line.resize(kLine, ' ');
  err_ << '\r' << line << std::flush;
}

void Progress::finish() {
  if (is_drawn_) err_ << '\r' << std::string(kLine, ' ') << '\r' << std::flush;
  is_drawn_ = false;
}

}  // namespace collision_node::replay
