#include "collision_node/replay/bag_file.h"

#include <bzlib.h>
#include <fcntl.h>
#include <roslz4/lz4s.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "collision_node/replay/bag_record.h"
#include "collision_node/replay/options.h"

namespace collision_node::replay {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kVersionSize = 13;  // "#ROSBAG V2.0\n"
/// Ids are small in every bag; a larger one is damage, and would take room for all below it.
constexpr std::uint32_t kLargestId = 1'000'000;
constexpr std::uint64_t kLz4Ratio = 255;  // its format's limit

std::string reindex(const std::string& fault) {
  return fault + ": run `rosbag reindex` on a copy of it to save what is left";
}

}  // namespace

BagFile::BagFile(const std::string& name) : name_(name) {
  std::error_code ignored;
  if (!fs::exists(name, ignored)) throw InputError(name + ": no such bag");
  if (!fs::is_regular_file(name, ignored)) throw InputError(name + ": is not a file; a bag is expected");
  file_ = open(name.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) throw InputError(name + ": cannot be read");
  size_ = fs::file_size(name, ignored);
  try {
    readHeader();
  } catch (const DamageError& error) {
    close(file_);
    throw InputError(reindex(name + ": is cut short or damaged (" + error.what() + ")"));
  } catch (...) {
    close(file_);
    throw;
  }
}

BagFile::~BagFile() { close(file_); }

void BagFile::readAt(std::uint64_t position, std::uint64_t size, void* to) const {
  if (position > size_ || size > size_ - position) throw DamageError("the file ends too early");
  auto* bytes = static_cast<char*>(to);
  for (std::uint64_t done = 0; done < size;) {
    const ssize_t got = pread(file_, bytes + done, size - done, static_cast<off_t>(position + done));
    if (got <= 0) throw DamageError("the file cannot be read");
    done += static_cast<std::uint64_t>(got);
  }
}

void BagFile::readHeader() {
  if (size_ == 0) throw InputError(name_ + ": is empty (0 bytes); a bag is expected");
  std::string start(std::min<std::uint64_t>(size_, kVersionSize), '\0');
  readAt(0, start.size(), start.data());
  if (start.rfind("#ROSBAG", 0) != 0)
    throw InputError(name_ + ": is not a bag (does not start with #ROSBAG)");
  const std::string version = start.substr(7, start.find('\n') - 7);
  if (version != " V2.0")
    throw InputError(name_ + ": is a bag of version" + version +
                     "; V2.0 is read: `rosbag reindex` and `rosbag fix` make one of an older bag, on a copy");
  std::uint32_t header_size = 0;
  readAt(kVersionSize, 4, &header_size);
  if (header_size > size_) throw DamageError("its header is longer than the file");
  std::string fields(header_size, '\0');
  readAt(kVersionSize + 4, header_size, fields.data());
  const RecordHeader header = replay::readHeader(fields);
  if (header.op != Op::kBagHeader) throw DamageError("it has no header");
  if (!header.encryptor.empty())
    throw InputError(name_ + ": is encrypted (" + std::string(header.encryptor) +
                     "); write it again without");
  if (header.index_pos == 0)
    throw InputError(reindex(name_ + ": has no index (its recording was never closed)"));
  connection_count_ = header.connection_count;
  chunk_count_ = header.chunk_count;
  readIndex(header.index_pos);
}

/// The end of the bag: its connections, and what each chunk holds.
void BagFile::readIndex(std::uint64_t position) {
  if (position > size_) throw DamageError("the file ends before its index");
  std::string bytes(size_ - position, '\0');
  readAt(position, bytes.size(), bytes.data());
  for (Records records(bytes); !records.atEnd();) {
    const RecordHeader header = records.next();
    const std::string_view data = records.data();
    if (header.op == Op::kConnection) {
      addConnection(header.connection, data.data(), data.size());
      connections_.back().topic = header.topic;
    } else if (header.op == Op::kChunkInfo) {
      ChunkInfo info{header.chunk_pos, header.start_ns, header.end_ns, {}};
      if (data.size() != std::size_t{header.count} * 8) throw DamageError("a chunk's counts are cut short");
      for (std::size_t i = 0; i < data.size(); i += 8) {
        const auto id = numberAt<std::uint32_t>(data.data() + i);
        if (id >= index_of_.size() || index_of_[id] < 0) throw DamageError("a connection is not described");
        info.connections.push_back(static_cast<std::uint32_t>(index_of_[id]));
        messages_ += numberAt<std::uint32_t>(data.data() + i + 4);
      }
      std::sort(info.connections.begin(), info.connections.end());
      chunks_.push_back(std::move(info));
    }
  }
  if (connections_.size() != connection_count_ || chunks_.size() != chunk_count_)
    throw DamageError("its index is not whole");
  std::sort(chunks_.begin(), chunks_.end(), [](const ChunkInfo& l, const ChunkInfo& r) {
    return l.first_ns != r.first_ns ? l.first_ns < r.first_ns : l.position < r.position;
  });
}

void BagFile::addConnection(std::uint32_t id, const char* fields, std::size_t size) {
  if (id > kLargestId) throw DamageError("a connection has the number " + std::to_string(id));
  if (id >= index_of_.size()) index_of_.resize(id + 1, -1);
  index_of_[id] = static_cast<std::int64_t>(connections_.size());
  Connection connection;
  forEachField({fields, size}, [&](std::string_view name, std::string_view value) {
    if (name == "type") connection.datatype = value;
    if (name == "md5sum") connection.md5sum = value;
    if (name == "message_definition") connection.definition = value;
    if (name == "callerid") connection.sender = value;
    if (name == "latching") connection.latched = value == "1";
  });
  connections_.push_back(std::move(connection));
}

void BagFile::read(const ChunkInfo& info, const std::vector<Nanoseconds>& from_ns, Nanoseconds to_ns,
                   Chunk& chunk) const {
  chunk.messages.clear();
  chunk.damage.clear();
  try {
    readBytes(info, chunk);
    scan(info, from_ns, to_ns, chunk);
  } catch (const std::exception& error) {  // DamageError, or a length that no memory holds
    chunk.damage = error.what();
  }
  const auto earlier = [](const Chunk::Message& l, const Chunk::Message& r) {
    return l.received_ns < r.received_ns;
  };
  if (!std::is_sorted(chunk.messages.begin(), chunk.messages.end(), earlier))
    std::stable_sort(chunk.messages.begin(), chunk.messages.end(), earlier);
}

void BagFile::readBytes(const ChunkInfo& info, Chunk& chunk) const {
  std::uint32_t size = 0;
  readAt(info.position, 4, &size);
  if (size > size_) throw DamageError("a chunk's header is longer than the file");
  std::string fields(size, '\0');
  readAt(info.position + 4, size, fields.data());
  const RecordHeader header = replay::readHeader(fields);
  if (header.op != Op::kChunk) throw DamageError("a chunk is not where the index says");
  const std::uint64_t data = info.position + 4 + std::uint64_t{size} + 4;
  readAt(data - 4, 4, &size);
  if (size > size_ - data) throw DamageError("a chunk is longer than the file");
  if (header.compression == "none") {
    chunk.bytes.resize(size);
    readAt(data, size, chunk.bytes.data());
    return;
  }
  std::vector<char> packed(size);
  readAt(data, size, packed.data());
  const bool is_lz4 = header.compression == "lz4";
  if (is_lz4 && header.size > kLz4Ratio * size) throw DamageError("a chunk claims more than lz4 can hold");
  chunk.bytes.resize(header.size);
  unsigned int got = header.size;
  auto* to = reinterpret_cast<char*>(chunk.bytes.data());
  bool is_good = false;
  if (is_lz4) {
    is_good = roslz4_buffToBuffDecompress(packed.data(), size, to, &got) == ROSLZ4_OK;
  } else if (header.compression == "bz2") {
    is_good = BZ2_bzBuffToBuffDecompress(to, &got, packed.data(), size, 0, 0) == BZ_OK;
  } else {
    throw DamageError("a chunk is compressed by '" + std::string(header.compression) +
                      "'; none, lz4 and bz2 are read");
  }
  if (!is_good || got != header.size) throw DamageError("a compressed chunk is damaged");
}

void BagFile::scan(const ChunkInfo& info, const std::vector<Nanoseconds>& from_ns, Nanoseconds to_ns,
                   Chunk& chunk) const {
  const char* const bytes = reinterpret_cast<const char*>(chunk.bytes.data());
  for (Records records({bytes, chunk.bytes.size()}); !records.atEnd();) {
    const RecordHeader header = records.next();
    if (header.op != Op::kMessage) continue;
    if (header.connection >= index_of_.size() || index_of_[header.connection] < 0)
      throw DamageError("a message comes from a connection that is not described");
    if (header.time_ns < info.first_ns || header.time_ns > info.last_ns)
      throw DamageError("a message was received outside its chunk's time");
    const auto connection = static_cast<std::uint32_t>(index_of_[header.connection]);
    if (header.time_ns < from_ns[connection] || header.time_ns >= to_ns) continue;
    chunk.messages.push_back({header.time_ns, connection,
                              static_cast<std::uint32_t>(records.data().data() - bytes),
                              static_cast<std::uint32_t>(records.data().size())});
  }
}

}  // namespace collision_node::replay
