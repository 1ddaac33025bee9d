#include "collision_node/report/recorded_pieces.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>

#include "collision_node/impact/solve.h"
#include "collision_node/messages/convert.h"
#include "collision_node/messages/pose_router.h"

namespace collision_node::report {
namespace {

/// Keeps the pieces that need more than their bounds, and answers as the solver does, so that the engine goes
/// on as it would.
class Recorder : public impact::PairMethod {
 public:
  Recorder(std::unique_ptr<impact::PairMethod> method, std::vector<impact::Piece>& pieces, std::size_t& count)
      : method_(std::move(method)), pieces_(pieces), count_(count) {}

  impact::PieceOutcome advance(const impact::Piece& piece, impact::PairState& state,
                               std::vector<impact::PairEvent>& events) const override {
    const impact::PieceOutcome outcome = method_->advance(piece, state, events);
    ++count_;
    if (outcome.answer != impact::Answer::kCulled) pieces_.push_back(piece);
    return outcome;
  }
  bool knowsTubes() const override { return method_->knowsTubes(); }
  void finish(impact::PairState& state, std::vector<impact::PairEvent>& events) const override {
    method_->finish(state, events);
  }
  void interrupt(impact::PairState& state, impact::Reason reason,
                 std::vector<impact::PairEvent>& events) const override {
    method_->interrupt(state, reason, events);
  }

 private:
  std::unique_ptr<impact::PairMethod> method_;
  std::vector<impact::Piece>& pieces_;
  std::size_t& count_;
};

std::string nameOf(const scene::Object& object, const scene::Link& link) {
  return link.name == object.name ? object.name : object.name + "." + link.name;
}

/// The body again, for a set of its own. A mesh is moved to where its link has it: other libraries know no
/// placed shapes.
std::unique_ptr<geometry::Body> copyOf(const geometry::Body& body) {
  std::vector<geometry::PlacedShape> shapes = body.shapes();
  const auto* mesh = shapes.size() == 1 ? std::get_if<geometry::Mesh>(&shapes[0].shape) : nullptr;
  if (mesh != nullptr) {
    auto moved = std::make_shared<geometry::TriangleMesh>(*mesh->mesh);
    for (auto& vertex : moved->vertices) vertex = shapes[0].origin * vertex;
    shapes[0].shape = geometry::Mesh{moved};
    shapes[0].origin = geometry::Pose();
  }
  return std::make_unique<geometry::Body>(std::move(shapes));
}

/// Every message of the bags on the router's topics, in the order of receive time.
void readBags(const std::vector<std::string>& files, messages::PoseRouter& router) {
  std::vector<std::unique_ptr<rosbag::Bag>> bags;
  rosbag::View all;
  for (const std::string& file : files) {
    try {
      bags.push_back(std::make_unique<rosbag::Bag>(file, rosbag::bagmode::Read));
    } catch (const std::exception& error) {
      throw std::runtime_error(file + ": cannot be read as a bag (" + error.what() + ")");
    }
    all.addQuery(*bags.back());
  }
  std::set<std::string> held;
  for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
    held.insert(connection->topic);
    router.checkType(connection->topic, connection->datatype, connection->md5sum);
  }
  for (const std::string& topic : router.topics()) {
    if (topic != "/tf_static" && held.count(topic) == 0)
      throw std::runtime_error("no bag has the topic " + topic + ", which the scene names");
  }
  std::vector<std::uint8_t> bytes;
  for (const rosbag::MessageInstance& message : all) {
    bytes.resize(message.size());
    ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    message.write(stream);
    messages::RawMessage raw;
    raw.datatype = message.getDataType();
    raw.md5sum = message.getMD5Sum();
    raw.data = bytes.data();
    raw.size = static_cast<std::uint32_t>(bytes.size());
    // Asked anew: /tf joins the topics with the first pose in another frame.
    const auto& topics = router.topics();
    if (std::find(topics.begin(), topics.end(), message.getTopic()) == topics.end()) continue;
    router.handle(message.getTopic(), raw, messages::toNanoseconds(message.getTime()));
  }
  router.flush();
}

}  // namespace

std::vector<RecordedPair> recordPieces(const std::shared_ptr<const scene::Scene>& scene,
                                       const std::vector<std::string>& bags, std::size_t most) {
  struct Watched {
    const geometry::Body *a, *b;
    std::vector<impact::Piece> pieces;
    std::size_t count = 0;
  };
  std::vector<std::unique_ptr<Watched>> watched;
  std::map<const geometry::Body*, std::string> names;
  for (const scene::Object& object : scene->objects) {
    for (const scene::Link& link : object.links) names[link.body.get()] = nameOf(object, link);
  }
  const auto factory = [&](const geometry::Body& a, const geometry::Body& b,
                           const impact::PairOptions& options) -> std::unique_ptr<impact::PairMethod> {
    if (options.contact_distance != 0.0)
      throw std::runtime_error(scene->file + ": the methods compared know no contact_distance, " +
                               std::to_string(options.contact_distance) +
                               " m is asked for; leave it out here");
    watched.push_back(std::make_unique<Watched>());
    watched.back()->a = &a;
    watched.back()->b = &b;
    return std::make_unique<Recorder>(impact::makeCertified(a, b, options), watched.back()->pieces,
                                      watched.back()->count);
  };
  scene::Engine::Sinks sinks;
  sinks.event = [](const scene::Event&) {};
  sinks.stats = [](const scene::Stats&) {};
  scene::Engine engine(scene, factory, sinks, scene::EngineOptions());
  messages::PoseRouter router(
      scene, [](const std::string& topic) { return topic.rfind('/', 0) == 0 ? topic : "/" + topic; },
      [&engine](int object, const motion::StampedPose& pose, messages::StampKind kind) {
        messages::handToEngine(engine, object, pose, kind);
      });
  readBags(bags, router);
  engine.flush();

  std::vector<RecordedPair> pairs;
  for (const auto& from : watched) {
    RecordedPair pair;
    // The others expect the simpler body to be B.
    const bool swapped = from->a->elementCount() < from->b->elementCount();
    if (swapped) std::swap(from->a, from->b);
    pair.name = names[from->a] + " - " + names[from->b];
    pair.pieces = from->count;
    pair.costly = from->pieces.size();
    pair.set.bodies.push_back(copyOf(*from->a));
    pair.set.bodies.push_back(copyOf(*from->b));
    const std::size_t kept = std::min(most, pair.costly);
    for (std::size_t i = 0; i < kept; ++i) {
      pair.set.queries.push_back({0, 1, from->pieces[i * pair.costly / kept]});
      impact::Piece& piece = pair.set.queries.back().piece;
      if (swapped) std::swap(piece.a, piece.b);
    }
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

}  // namespace collision_node::report
