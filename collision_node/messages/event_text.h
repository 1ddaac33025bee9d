/// Events as text: one JSON object a line, or CSV. Field names are those of Impact.msg.
#pragma once

#include <string>

#include "collision_node/scene/engine.h"

namespace collision_node::messages {

/// One line, no newline at its end. Times are integer nanoseconds; kinds, certificates, reasons and features
/// are strings; doubles are the shortest text that reads back to the same double; NaN and infinities are
/// null.
std::string toJson(const scene::Event& event, const std::string& world_frame);

/// Column names, dotted ("position.x"), comma separated, no newline at the end.
std::string csvHeader();

/// One row in the columns of csvHeader(); NaN and infinities are empty; quoted as RFC 4180 asks.
std::string toCsv(const scene::Event& event, const std::string& world_frame);

/// The shortest decimal text that reads back to `value`; "nan", "inf", "-inf" as they are.
std::string shortest(double value);

/// A JSON string with its quotes.
std::string quoted(const std::string& text);

/// "1700000000.033333333": exact, never through a double.
std::string secondsText(motion::Nanoseconds ns);

}  // namespace collision_node::messages
