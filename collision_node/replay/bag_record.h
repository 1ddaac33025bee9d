/// Records of a bag (version 2.0): a header of fields and data, each with its length in front.
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

#include "collision_node/replay/bag_file.h"

namespace collision_node::replay {

enum class Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

/// Bags are little-endian, as are all machines ROS 1 runs on.
template <typename Number>
Number numberAt(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Calls visit(name, value) for each field. Throws DamageError.
template <typename Visit>
void forEachField(std::string_view fields, Visit&& visit) {
  while (!fields.empty()) {
    if (fields.size() < 4) throw DamageError("a field is cut short");
    const std::uint32_t size = numberAt<std::uint32_t>(fields.data());
    if (size > fields.size() - 4) throw DamageError("a field is longer than its header");
    const std::string_view field = fields.substr(4, size);
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) throw DamageError("a field has no name");
    visit(field.substr(0, equals), field.substr(equals + 1));
    fields.remove_prefix(4 + size);
  }
}

/// What stands in the headers of all kinds of records.
struct RecordHeader {
  Op op{};
  std::uint64_t index_pos = 0, chunk_pos = 0;
  std::uint32_t connection = 0, connection_count = 0, chunk_count = 0, size = 0, count = 0;
  Nanoseconds time_ns = 0, start_ns = 0, end_ns = 0;
  std::string_view compression, topic, encryptor;
};

inline Nanoseconds timeAt(const char* bytes) {
  return Nanoseconds{numberAt<std::uint32_t>(bytes)} * 1'000'000'000 + numberAt<std::uint32_t>(bytes + 4);
}

/// Throws DamageError.
inline RecordHeader readHeader(std::string_view fields) {
  RecordHeader out;
  forEachField(fields, [&](std::string_view name, std::string_view value) {
    const auto number = [&](auto& to) {
      if (value.size() != sizeof to) throw DamageError("a field has the wrong length");
      to = numberAt<std::decay_t<decltype(to)>>(value.data());
    };
    const auto time = [&](Nanoseconds& to) {
      if (value.size() != 8) throw DamageError("a time has the wrong length");
      to = timeAt(value.data());
    };
    if (name == "op") return number(out.op);
    if (name == "conn") return number(out.connection);
    if (name == "time") return time(out.time_ns);
    if (name == "size") return number(out.size);
    if (name == "compression") out.compression = value;
    if (name == "topic") out.topic = value;
    if (name == "encryptor") out.encryptor = value;
    if (name == "index_pos") return number(out.index_pos);
    if (name == "chunk_pos") return number(out.chunk_pos);
    if (name == "conn_count") return number(out.connection_count);
    if (name == "chunk_count") return number(out.chunk_count);
    if (name == "count") return number(out.count);
    if (name == "start_time") return time(out.start_ns);
    if (name == "end_time") return time(out.end_ns);
  });
  return out;
}

/// Walks over records that lie one behind the other in memory.
class Records {
 public:
  explicit Records(std::string_view bytes) : bytes_(bytes) {}
  bool atEnd() const { return at_ == bytes_.size(); }
  /// Reads one record's header; its data are in data(). Throws DamageError.
  RecordHeader next() {
    const std::string_view header = part("a record's header is longer than what holds it");
    const RecordHeader out = readHeader(header);
    data_ = part(out.op == Op::kMessage ? "a message is longer than its chunk"
                                        : "a record is longer than what holds it");
    return out;
  }
  std::string_view data() const { return data_; }

 private:
  std::string_view part(const char* fault) {
    if (bytes_.size() - at_ < 4) throw DamageError(fault);
    const std::uint32_t size = numberAt<std::uint32_t>(bytes_.data() + at_);
    if (size > bytes_.size() - at_ - 4) throw DamageError(fault);
    const std::string_view out = bytes_.substr(at_ + 4, size);
    at_ += 4 + std::size_t{size};
    return out;
  }

  std::string_view bytes_, data_;
  std::size_t at_ = 0;
};

}  // namespace collision_node::replay
