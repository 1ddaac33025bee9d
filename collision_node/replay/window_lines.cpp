#include "collision_node/replay/window_lines.h"

#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <stdexcept>
#include <variant>

#include "collision_node/messages/event_text.h"
#include "collision_node/scene/fingerprint.h"

namespace collision_node::replay {

namespace {

const char* const kStart = "{\"window\":";

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::string orNull(const std::optional<Nanoseconds>& value) {
  return value ? std::to_string(*value) : "null";
}

std::string sideText(const std::string& object, const std::string& link) {
  return "{\"object\":" + messages::quoted(object) + ",\"link\":" + messages::quoted(link) + "}";
}

std::uint64_t fromHex(const YAML::Node& node) { return std::stoull(node.as<std::string>(), nullptr, 16); }

std::optional<Nanoseconds> nanoseconds(const YAML::Node& node) {
  if (node.IsNull()) return std::nullopt;
  return node.as<Nanoseconds>();
}

}  // namespace

std::string toLine(const WindowEnd& end) {
  std::string out = kStart + messages::quoted(end.opens ? "opens" : "closes");
  out += ",\"scene\":" + messages::quoted(hex(end.run.scene));
  out += ",\"recording\":{\"begin\":" + std::to_string(end.run.begin_ns) +
         ",\"end\":" + std::to_string(end.run.end_ns) + ",\"messages\":" + std::to_string(end.run.messages) +
         "}";
  out += ",\"received\":" + orNull(end.received_ns);
  out += ",\"epoch\":" + std::to_string(end.epoch) + ",\"stamp\":" + orNull(end.stamp_ns);
  out += ",\"state\":" + messages::quoted(hex(end.state)) + ",\"contacts\":[";
  for (const OpenContact& contact : end.contacts) {
    if (&contact != &end.contacts.front()) out += ',';
    out += "{\"contact_id\":" + std::to_string(contact.contact_id) +
           ",\"a\":" + sideText(contact.object_a, contact.link_a) +
           ",\"b\":" + sideText(contact.object_b, contact.link_b) + "}";
  }
  return out + "]}";
}

bool isWindowLine(const std::string& line) { return line.rfind(kStart, 0) == 0; }

WindowEnd parseWindowLine(const std::string& line) {
  WindowEnd end;
  try {
    const YAML::Node root = YAML::Load(line);  // JSON is YAML
    const auto what = root["window"].as<std::string>();
    if (what != "opens" && what != "closes") throw std::runtime_error("window is '" + what + "'");
    end.opens = what == "opens";
    end.run.scene = fromHex(root["scene"]);
    const YAML::Node recording = root["recording"];
    end.run.begin_ns = recording["begin"].as<Nanoseconds>();
    end.run.end_ns = recording["end"].as<Nanoseconds>();
    end.run.messages = recording["messages"].as<std::uint64_t>();
    end.received_ns = nanoseconds(root["received"]);
    end.epoch = root["epoch"].as<std::uint32_t>();
    end.stamp_ns = nanoseconds(root["stamp"]);
    end.state = fromHex(root["state"]);
    for (const YAML::Node& contact : root["contacts"]) {
      const YAML::Node a = contact["a"], b = contact["b"];
      end.contacts.push_back({contact["contact_id"].as<std::uint64_t>(), a["object"].as<std::string>(),
                              a["link"].as<std::string>(), b["object"].as<std::string>(),
                              b["link"].as<std::string>()});
    }
  } catch (const std::exception& error) {  // of yaml-cpp or std::stoull
    throw std::runtime_error(std::string("a line about its cut is not whole (") + error.what() + ")");
  }
  return end;
}

std::uint64_t fingerprintOf(const scene::Scene& scene, impact::MethodName method,
                            const std::string& name_space) {
  scene::Fingerprint out;
  // The plan says all there is to say but the triangles. Its first line and its warnings name the file, which
  // may lie elsewhere.
  const std::string plan = scene::planText(scene);
  const std::size_t begin = plan.find('\n') + 1;
  out.add(std::string_view(plan).substr(begin, plan.rfind("\nwarnings (") - begin));
  out.add(method);
  out.add(name_space);
  for (const scene::Object& object : scene.objects)
    for (const scene::Link& link : object.links)
      for (const geometry::PlacedShape& placed : link.shapes) {
        out.add(placed.origin);
        std::visit(
            [&](const auto& shape) {
              using Shape = std::decay_t<decltype(shape)>;
              if constexpr (std::is_same_v<Shape, geometry::Mesh> ||
                            std::is_same_v<Shape, geometry::Convex>) {
                for (const auto& vertex : shape.mesh->vertices) out.add(vertex);
                for (const auto& triangle : shape.mesh->triangles)
                  for (const auto corner : triangle) out.add(corner);
              }
            },
            placed.shape);
      }
  return out.value();
}

}  // namespace collision_node::replay
