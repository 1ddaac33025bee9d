/// One bag of version 2.0, read chunk by chunk: what is in memory is a list of its chunks, and the chunks
/// that the reader holds. (rosbag keeps an index of all messages, some 90 bytes each.)
#pragma once

#include <ros/datatypes.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision_node/motion/stamped_pose.h"

namespace collision_node::replay {

using motion::Nanoseconds;

/// The bag breaks off here; what was read before is good.
struct DamageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Who sent messages on a topic.
struct Connection {
  std::string topic, datatype, md5sum, definition, sender;
  bool latched = false;
};

/// A stretch of the file, compressed as one, as the end of the bag describes it.
struct ChunkInfo {
  std::uint64_t position = 0;
  Nanoseconds first_ns = 0, last_ns = 0;   ///< receive times
  std::vector<std::uint32_t> connections;  ///< of its messages, ascending; indices into connections()
};

/// The messages of a chunk that were asked for, in order of receive time; of equal ones as they were written.
struct Chunk {
  struct Message {
    Nanoseconds received_ns;
    std::uint32_t connection, offset, size;  ///< offset into bytes
  };
  std::vector<std::uint8_t> bytes;
  std::vector<Message> messages;
  std::string damage;  ///< "" or why the chunk cannot be read beyond the last message
};

class BagFile {
 public:
  /// For reading only. Throws InputError, one line: absent, empty, no bag, never closed, encrypted, cut
  /// short, damaged.
  explicit BagFile(const std::string& name);
  ~BagFile();
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;

  const std::string& name() const { return name_; }
  const std::vector<Connection>& connections() const { return connections_; }
  const std::vector<ChunkInfo>& chunks() const { return chunks_; }  ///< by first_ns, then by position
  std::uint64_t messages() const { return messages_; }

  /// Fills `chunk` with the messages of each connection that were received from `from_ns` of it on and before
  /// `to_ns`. Damage is told in the chunk.
  void read(const ChunkInfo& info, const std::vector<Nanoseconds>& from_ns, Nanoseconds to_ns,
            Chunk& chunk) const;

 private:
  void readHeader();
  void readIndex(std::uint64_t position);
  void addConnection(std::uint32_t id, const char* fields, std::size_t size);
  void readBytes(const ChunkInfo& info, Chunk& chunk) const;
  void scan(const ChunkInfo& info, const std::vector<Nanoseconds>& from_ns, Nanoseconds to_ns,
            Chunk& chunk) const;
  void readAt(std::uint64_t position, std::uint64_t size, void* to) const;

  std::string name_;
  int file_ = -1;
  std::uint64_t size_ = 0, messages_ = 0;
  std::uint32_t connection_count_ = 0, chunk_count_ = 0;
  std::vector<Connection> connections_;
  std::vector<std::int64_t> index_of_;  ///< a connection's id in the file -> its place in connections_, or -1
  std::vector<ChunkInfo> chunks_;
};

}  // namespace collision_node::replay
