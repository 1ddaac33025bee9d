/// The messages of several bags as one stream, in order of receive time.
#pragma once

#include <memory>
#include <vector>

#include "collision_node/replay/bag_file.h"

namespace collision_node::replay {

/// In memory are the chunks whose times overlap, no more. Messages received at the same time come in the
/// order of the bags, then of the file.
class BagStream {
 public:
  struct Message {
    Nanoseconds received_ns = 0;
    std::size_t bag = 0;
    std::uint32_t connection = 0;  ///< of the bag
    const std::uint8_t* data = nullptr;
    std::uint32_t size = 0;
  };

  /// `from_ns[bag][connection]`: from when on its messages are wanted; before `to_ns` all of them. The bags
  /// must outlive the stream.
  BagStream(const std::vector<std::unique_ptr<BagFile>>& bags, std::vector<std::vector<Nanoseconds>> from_ns,
            Nanoseconds to_ns);

  /// The next message, valid until the next call; null at the end. Throws DamageError.
  const Message* next();

 private:
  struct Source {  // a chunk that is in memory
    std::size_t bag;
    std::size_t order;  // of the chunk in its bag
    std::size_t at;     // its next message
    std::unique_ptr<Chunk> chunk;
  };
  struct Waiting {  // a chunk that is not
    std::size_t bag, order;
  };

  bool isWanted(std::size_t bag, const ChunkInfo& info) const;
  bool isBefore(const Source& l, const Source& r) const;
  void load(const Waiting& waiting);
  void finish(Source& source);

  const std::vector<std::unique_ptr<BagFile>>& bags_;
  std::vector<std::vector<Nanoseconds>> from_ns_;
  Nanoseconds to_ns_;
  std::vector<Waiting> waiting_;  // by the times of their chunks, the earliest last
  std::vector<Source> sources_;   // few: the one in front is sought
  std::size_t current_ = 0;       // the source of the last message
  std::vector<std::unique_ptr<Chunk>> spare_;
  Message message_;
};

}  // namespace collision_node::replay
