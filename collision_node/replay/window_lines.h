/// The lines that say where a window of a recording was cut: the first and the last of its JSON lines.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "collision_node/motion/stamped_pose.h"
#include "collision_node/scene/scene.h"

namespace collision_node::replay {

using motion::Nanoseconds;

/// What must be the same for two windows to be of one run.
struct RunIdentity {
  std::uint64_t scene =
      0;  ///< fingerprint of all that the scene says, its geometry, the method, the namespace
  Nanoseconds begin_ns = 0, end_ns = 0;  ///< of the recording: receive times of its first and last message
  std::uint64_t messages = 0;

  bool operator==(const RunIdentity& o) const {
    return scene == o.scene && begin_ns == o.begin_ns && end_ns == o.end_ns && messages == o.messages;
  }
};

struct OpenContact {
  std::uint64_t contact_id = 0;
  std::string object_a, link_a, object_b, link_b;

  bool isSamePair(const OpenContact& o) const {
    return object_a == o.object_a && link_a == o.link_a && object_b == o.object_b && link_b == o.link_b;
  }
};

/// One end of a window. Messages received before `received_ns` are on one side of it, the others on the
/// other.
struct WindowEnd {
  bool opens = false;  ///< else it closes
  RunIdentity run;
  std::optional<Nanoseconds> received_ns;  ///< nothing: the begin or the end of the recording
  std::uint32_t epoch = 0;                 ///< as the window counts
  std::optional<Nanoseconds> stamp_ns;     ///< events up to here, in that epoch, lie before the cut
  std::uint64_t state = 0;                 ///< fingerprint of what later events depend on
  std::vector<OpenContact> contacts;       ///< open there, by pair, then in the order they opened
};

std::string toLine(const WindowEnd& end);
/// True when the line is one of these, whole or not.
bool isWindowLine(const std::string& line);
/// Throws std::runtime_error: it is not whole.
WindowEnd parseWindowLine(const std::string& line);

/// What a run with this scene, method and namespace has to be the same in.
std::uint64_t fingerprintOf(const scene::Scene& scene, impact::MethodName method,
                            const std::string& name_space);

}  // namespace collision_node::replay
