#include "collision_node/replay/bag_index.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <vector>

#include "collision_node/replay/options.h"

namespace collision_node::replay {

namespace {

constexpr std::uint64_t kFirstRecord = 13;  // after "#ROSBAG V2.0\n"
constexpr std::uint64_t kEntry = 12;        // of an index: seconds, nanoseconds, offset in the chunk
constexpr std::uint64_t kLengths = 8;       // of a record: of its header and of its data

std::uint32_t numberAt(const char* bytes) {  // as bags and x86, ARM have it: the lowest byte first
  std::uint32_t value = 0;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

class IndexCheck {
 public:
  explicit IndexCheck(const std::string& name) : name_(name), file_(open(name.c_str(), O_RDONLY)) {
    if (file_ < 0) throw InputError(name_ + ": cannot be read");
    const off_t end = lseek(file_, 0, SEEK_END);
    size_ = end < 0 ? 0 : static_cast<std::uint64_t>(end);
  }
  ~IndexCheck() { close(file_); }
  IndexCheck(const IndexCheck&) = delete;
  IndexCheck& operator=(const IndexCheck&) = delete;

  std::optional<std::int64_t> run() {
    for (std::uint64_t at = kFirstRecord; at < size_;) at = record(at);
    return damaged_from_;
  }

 private:
  /// One record; returns where the next one begins.
  std::uint64_t record(std::uint64_t at) {
    const std::uint64_t header_size = number(at, size_);
    const std::uint64_t header = at + 4, data_size_at = header + header_size;
    const std::uint64_t data = data_size_at + 4, data_size = number(data_size_at, size_);
    if (data + data_size > size_) fail(at);
    const auto fields = readHeader(header, header_size);
    const std::string op = field(fields, "op", at);
    if (op == "\x05") {
      chunk_data_ = data;
      chunk_size_ = numberAt(field(fields, "size", at, 4).data());
      plain_ = field(fields, "compression", at) == "none";
      if (plain_ && chunk_size_ > data_size) fail(at);
    } else if (op == "\x04") {
      if (numberAt(field(fields, "count", at, 4).data()) * kEntry != data_size) fail(at);
      const std::vector<char>& entries = read(data, data_size);
      for (std::uint64_t i = 0; i < data_size; i += kEntry) checkEntry(entries.data() + i, at);
    }
    return data + data_size;
  }

  void checkEntry(const char* entry, std::uint64_t at) {
    const std::uint64_t offset = numberAt(entry + 8);
    if (offset + kLengths > chunk_size_) fail(at);
    if (!plain_) return;
    const std::uint64_t end = chunk_data_ + chunk_size_, start = chunk_data_ + offset;
    const std::uint64_t data_size_at = start + 4 + number(start, end);
    if (data_size_at + 4 <= end && data_size_at + 4 + number(data_size_at, end) <= end) return;
    // The index is right, the message is not: what comes before it is good.
    const std::int64_t received = std::int64_t{numberAt(entry)} * 1'000'000'000 + numberAt(entry + 4);
    damaged_from_ = damaged_from_ ? std::min(*damaged_from_, received) : received;
  }

  using Fields = std::map<std::string, std::string>;

  Fields readHeader(std::uint64_t at, std::uint64_t size) {
    const std::string text(read(at, size).data(), size);
    Fields fields;
    for (std::uint64_t i = 0; i < size;) {
      if (i + 4 > size || numberAt(text.data() + i) > size - i - 4) fail(at);
      const std::string one = text.substr(i + 4, numberAt(text.data() + i));
      const auto equals = one.find('=');
      if (equals == std::string::npos) fail(at);
      fields[one.substr(0, equals)] = one.substr(equals + 1);
      i += 4 + one.size();
    }
    return fields;
  }

  const std::string& field(const Fields& fields, const std::string& name, std::uint64_t at,
                           std::size_t size = 1) const {
    const auto found = fields.find(name);
    if (found == fields.end() || found->second.size() < size) fail(at);
    return found->second;
  }

  std::uint32_t number(std::uint64_t at, std::uint64_t end) const {
    char bytes[4];
    if (at + 4 > end || pread(file_, bytes, 4, static_cast<off_t>(at)) != 4) fail(at);
    return numberAt(bytes);
  }

  const std::vector<char>& read(std::uint64_t at, std::uint64_t size) {
    if (at + size > size_) fail(at);
    buffer_.resize(size);
    if (pread(file_, buffer_.data(), size, static_cast<off_t>(at)) != static_cast<ssize_t>(size)) fail(at);
    return buffer_;
  }

  [[noreturn]] void fail(std::uint64_t at) const {
    throw InputError(name_ + ": its index is damaged at byte " + std::to_string(at) +
                     ": run `rosbag reindex` on a copy of it to save what is left");
  }

  std::string name_;
  int file_;
  std::uint64_t size_ = 0;
  std::vector<char> buffer_;
  std::uint64_t chunk_data_ = 0, chunk_size_ = 0;  // of the last chunk: its indexes follow it
  bool plain_ = false;                             // the last chunk is not compressed
  std::optional<std::int64_t> damaged_from_;
};

}  // namespace

std::optional<std::int64_t> checkIndex(const std::string& file) { return IndexCheck(file).run(); }

}  // namespace collision_node::replay
