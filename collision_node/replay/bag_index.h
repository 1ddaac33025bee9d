/// The index of a bag, held against the bag: rosbag follows it without looking.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace collision_node::replay {

/// Reads the records of a bag of version 2.0, but no compressed data. Throws InputError, one line, when the
/// index is damaged: a record or an entry that points beyond its chunk or the file. Returns the earliest
/// receive time [ns] of a message in an uncompressed chunk whose own length points beyond the chunk; nothing
/// when there is none. Cost: two small reads per message of uncompressed chunks.
std::optional<std::int64_t> checkIndex(const std::string& file);

}  // namespace collision_node::replay
