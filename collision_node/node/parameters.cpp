#include "collision_node/node/parameters.h"

#include <algorithm>
#include <cctype>

#include "collision_node/messages/event_text.h"

namespace collision_node::node {

namespace {

const std::vector<std::string> kKnown = {"scene",
                                         "method",
                                         "plan",
                                         "override",
                                         "queue",
                                         "markers/min_size",
                                         "markers/lifetime",
                                         "markers/max_events"};

bool isPlainText(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '/' || c == '.' || c == '+' || c == '-';
  }) && text != "-";
}

std::string yamlText(const XmlRpc::XmlRpcValue& value, const std::string& path) {
  // The accessors of XmlRpcValue are not const.
  XmlRpc::XmlRpcValue v(value);
  switch (v.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return static_cast<bool>(v) ? "true" : "false";
    case XmlRpc::XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int>(v));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return messages::shortest(static_cast<double>(v));
    case XmlRpc::XmlRpcValue::TypeString: {
      const std::string text = static_cast<std::string>(v);
      return isPlainText(text) ? text : messages::quoted(text);
    }
    case XmlRpc::XmlRpcValue::TypeArray: {
      std::string out = "[";
      for (int i = 0; i < v.size(); ++i) out += (i == 0 ? "" : ", ") + yamlText(v[i], path);
      return out + "]";
    }
    case XmlRpc::XmlRpcValue::TypeStruct: {
      std::string out = "{";
      for (auto& member : v)
        out += (out == "{" ? "" : ", ") + member.first + ": " + yamlText(member.second, path);
      return out + "}";
    }
    default:
      throw ParameterError("~override/" + path + ": a value of this type cannot stand in a scene");
  }
}

void flattenInto(const XmlRpc::XmlRpcValue& tree, const std::string& path, scene::Overrides& out) {
  XmlRpc::XmlRpcValue v(tree);
  if (v.getType() != XmlRpc::XmlRpcValue::TypeStruct) {
    out[path] = yamlText(v, path);
    return;
  }
  for (auto& member : v)
    flattenInto(member.second, path.empty() ? member.first : path + "/" + member.first, out);
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row.back();
}

std::vector<std::string> unknownParameters(const ros::NodeHandle& handle) {
  std::vector<std::string> all, out;
  if (!handle.getParamNames(all)) return out;
  const std::string prefix = handle.getNamespace() + "/";
  for (const auto& name : all) {
    if (name.rfind(prefix, 0) != 0) continue;
    const std::string key = name.substr(prefix.size());
    if (key.rfind("override/", 0) == 0 || std::count(kKnown.begin(), kKnown.end(), key) > 0) continue;
    const auto nearest = std::min_element(kKnown.begin(), kKnown.end(), [&](const auto& a, const auto& b) {
      return editDistance(key, a) < editDistance(key, b);
    });
    out.push_back("parameter ~" + key + " is read by nobody; nearest known: ~" + *nearest);
  }
  return out;
}

template <typename T>
void readPositive(const ros::NodeHandle& handle, const std::string& name, T& value, bool zero_too) {
  if (!handle.hasParam(name)) return;
  double number = 0.0;
  if (!handle.getParam(name, number)) throw ParameterError("~" + name + ": must be a number");
  if (!(number >= 0.0) || (number == 0.0 && !zero_too))
    throw ParameterError("~" + name + ": " + messages::shortest(number) + " must be " +
                         (zero_too ? ">= 0" : "> 0"));
  value = static_cast<T>(number);
}

}  // namespace

scene::Overrides flatten(const XmlRpc::XmlRpcValue& tree) {
  scene::Overrides out;
  flattenInto(tree, "", out);
  return out;
}

Parameters readParameters(const ros::NodeHandle& handle) {
  Parameters out;
  if (!handle.getParam("scene", out.scene) || out.scene.empty())
    throw ParameterError(
        "~scene is not set: give the scene file, e.g. <param name=\"scene\" value=\"/path/scene.yaml\"/>");
  XmlRpc::XmlRpcValue tree;
  if (handle.getParam("override", tree)) {
    if (tree.getType() != XmlRpc::XmlRpcValue::TypeStruct)
      throw ParameterError("~override: must hold keys of the scene, e.g. ~override/precision/time");
    out.overrides = flatten(tree);
  }
  std::string method;
  if (handle.getParam("method", method)) {
    try {
      out.method = impact::parseMethod(method);
    } catch (const std::invalid_argument& error) {
      throw ParameterError(std::string("~method: ") + error.what());
    }
  }
  std::string plan;
  if (handle.hasParam("plan") && (!handle.getParam("plan", plan) || (plan != "full" && plan != "lean")))
    throw ParameterError("~plan: must be lean (only what may matter is solved) or full (every pair, slowly)");
  out.everything = plan == "full";
  readPositive(handle, "markers/min_size", out.markers.min_size, false);
  readPositive(handle, "markers/lifetime", out.markers.lifetime, true);
  readPositive(handle, "markers/max_events", out.markers.max_events, false);
  int queue = 0;
  if (handle.getParam("queue", queue)) {
    if (queue < 1) throw ParameterError("~queue: " + std::to_string(queue) + " must be >= 1");
    out.queue = static_cast<std::uint32_t>(queue);
  } else if (handle.hasParam("queue")) {
    throw ParameterError("~queue: must be a whole number");
  }
  out.warnings = unknownParameters(handle);
  return out;
}

}  // namespace collision_node::node
