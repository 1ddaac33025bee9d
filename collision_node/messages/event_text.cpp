#include "collision_node/messages/event_text.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <type_traits>

namespace collision_node::messages {

namespace {

using geometry::Quat;
using geometry::Vec3;

/// The one list of fields. A writer sees them in order: open/close for nesting, value for leaves.
template <typename Writer>
class Fields {
 public:
  explicit Fields(Writer& writer) : w_(writer) {}

  void event(const scene::Event& e, const std::string& world_frame) {
    w_.open("header");
    w_.value("stamp", e.stamp_ns);
    w_.value("frame_id", world_frame);
    w_.close();
    w_.value("epoch", e.epoch);
    w_.value("event_id", e.event_id);
    w_.value("contact_id", e.contact_id);
    w_.value("kind", std::string(impact::toString(e.kind)));
    w_.value("certificate", std::string(impact::toString(e.certificate)));
    w_.value("reason", std::string(impact::toString(e.reason)));
    w_.value("interval_start", e.interval_start_ns);
    w_.value("interval_end", e.interval_end_ns);
    w_.value("toi_lower", e.toi_lower);
    w_.value("toi_upper", e.toi_upper);
    vector("position", e.position);
    w_.value("position_error", e.position_error);
    w_.value("multiple", e.multiple);
    vector("normal", e.normal);
    w_.value("normal_error", e.normal_error);
    vector("relative_velocity", e.relative_velocity);
    w_.value("closing_speed", e.closing_speed);
    w_.value("model_toi_lower", e.model_toi_lower);
    w_.value("model_toi_upper", e.model_toi_upper);
    w_.value("model_position_error", e.model_position_error);
    side("a", e.a);
    side("b", e.b);
  }

 private:
  void vector(const char* name, const Vec3& v) {
    w_.open(name);
    w_.value("x", v.x());
    w_.value("y", v.y());
    w_.value("z", v.z());
    w_.close();
  }

  void side(const char* name, const scene::EventSide& s) {
    w_.open(name);
    w_.value("object", s.object);
    w_.value("link", s.link);
    w_.value("zone", s.zone);
    w_.value("zone_certain", s.zone_certain);
    w_.value("shape", s.shape);
    w_.value("feature", std::string(impact::toString(s.feature)));
    w_.value("triangle", s.triangle);
    vector("point", s.point);
    w_.open("pose");
    vector("position", s.pose.position);
    w_.open("orientation");
    const Quat& q = s.pose.orientation;
    w_.value("x", q.x());
    w_.value("y", q.y());
    w_.value("z", q.z());
    w_.value("w", q.w());
    w_.close();
    w_.close();
    w_.value("sample_before", s.sample_before_ns);
    w_.value("sample_after", s.sample_after_ns);
    w_.close();
  }

  Writer& w_;
};

template <typename T>
std::string number(T value) {
  if constexpr (std::is_same_v<T, bool>) {
    return value ? "true" : "false";
  } else {
    char buffer[64];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value);
    return {buffer, end.ptr};
  }
}

class JsonWriter {
 public:
  void open(const char* name) {
    key(name);
    text_ += '{';
    first_ = true;
  }
  void close() {
    text_ += '}';
    first_ = false;
  }
  void value(const char* name, const std::string& v) {
    key(name);
    text_ += quoted(v);
  }
  void value(const char* name, double v) {
    key(name);
    text_ += std::isfinite(v) ? number(v) : "null";
  }
  template <typename T>
  std::enable_if_t<std::is_integral_v<T>> value(const char* name, T v) {
    key(name);
    text_ += number(v);
  }
  std::string line() const { return "{" + text_ + "}"; }

 private:
  void key(const char* name) {
    if (!first_) text_ += ',';
    first_ = false;
    text_ += quoted(name) + ":";
  }
  std::string text_;
  bool first_ = true;
};

/// Names or values, as `header` says.
class CsvWriter {
 public:
  explicit CsvWriter(bool header) : header_(header) {}
  void open(const char* name) { prefix_ += std::string(name) + "."; }
  void close() {
    prefix_.pop_back();
    prefix_.erase(prefix_.find_last_of('.') == std::string::npos ? 0 : prefix_.find_last_of('.') + 1);
  }
  void value(const char* name, const std::string& v) { cell(name, escaped(v)); }
  void value(const char* name, double v) { cell(name, std::isfinite(v) ? number(v) : ""); }
  template <typename T>
  std::enable_if_t<std::is_integral_v<T>> value(const char* name, T v) {
    cell(name, number(v));
  }
  const std::string& line() const { return text_; }

 private:
  void cell(const char* name, const std::string& v) {
    if (!first_) text_ += ',';
    first_ = false;
    text_ += header_ ? prefix_ + name : v;
  }
  static std::string escaped(const std::string& v) {
    if (v.find_first_of(",\"\r\n") == std::string::npos) return v;
    std::string out = "\"";
    for (const char c : v) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
  }
  bool header_;
  bool first_ = true;
  std::string prefix_, text_;
};

}  // namespace

std::string shortest(double value) { return number(value); }

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    switch (c) {
      case '"':
        out += "\\\"";
        break;
      case '\\':
        out += "\\\\";
        break;
      case '\n':
        out += "\\n";
        break;
      case '\r':
        out += "\\r";
        break;
      case '\t':
        out += "\\t";
        break;
      default:
        if (static_cast<unsigned char>(c) < 0x20) {
          char buffer[8];
          std::snprintf(buffer, sizeof buffer, "\\u%04x",
                        static_cast<unsigned>(static_cast<unsigned char>(c)));
          out += buffer;
        } else {
          out += c;
        }
    }
  }
  return out + "\"";
}

std::string secondsText(motion::Nanoseconds ns) {
  const bool negative = ns < 0;
  const auto magnitude = negative ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%s%llu.%09llu", negative ? "-" : "",
                static_cast<unsigned long long>(magnitude / 1'000'000'000u),
                static_cast<unsigned long long>(magnitude % 1'000'000'000u));
  return buffer;
}

std::string toJson(const scene::Event& event, const std::string& world_frame) {
  JsonWriter writer;
  Fields<JsonWriter>(writer).event(event, world_frame);
  return writer.line();
}

std::string csvHeader() {
  CsvWriter writer(true);
  scene::Event any{};
  Fields<CsvWriter>(writer).event(any, "");
  return writer.line();
}

std::string toCsv(const scene::Event& event, const std::string& world_frame) {
  CsvWriter writer(false);
  Fields<CsvWriter>(writer).event(event, world_frame);
  return writer.line();
}

}  // namespace collision_node::messages
