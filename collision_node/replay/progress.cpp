#include "collision_node/replay/progress.h"

#include <algorithm>
#include <string>

namespace collision_node::replay {

namespace {
constexpr int kWidth = 50;
}

Progress::Progress(std::ostream& err, bool show, const ros::Time& begin, const ros::Time& end)
    : err_(err), show_(show), begin_(begin.toSec()), length_(end.toSec() - begin_) {}

void Progress::at(const ros::Time& now) {
  if (!show_ || !(length_ > 0.0)) return;
  const int per_cent = std::clamp(static_cast<int>(100.0 * (now.toSec() - begin_) / length_), 0, 100);
  if (per_cent == shown_) return;
  shown_ = per_cent;
  const auto done = static_cast<std::size_t>(per_cent * kWidth / 100);
  err_ << "\r[" << std::string(done, '#') << std::string(kWidth - done, ' ') << "] " << per_cent << " %"
       << std::flush;
}

void Progress::finish() {
  if (shown_ >= 0) err_ << '\r' << std::string(kWidth + 10, ' ') << '\r' << std::flush;
}

}  // namespace collision_node::replay
