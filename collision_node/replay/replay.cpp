#include "collision_node/replay/replay.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/event_text.h"
#include "collision_node/messages/pose_router.h"
#include "collision_node/messages/resources.h"
#include "collision_node/messages/sequence_gaps.h"
#include "collision_node/replay/bag_input.h"
#include "collision_node/replay/outputs.h"
#include "collision_node/replay/progress.h"

namespace collision_node::replay {

namespace {

using Clock = std::chrono::steady_clock;

std::shared_ptr<const scene::Scene> load(const Options& options, std::ostream& err) {
  try {
    auto loaded = scene::loadScene(options.scene, messages::makeResources(options.scene));
    for (const auto& warning : loaded->warnings) err << "warning: " << warning << '\n';
    return loaded;
  } catch (const scene::SceneError& error) {
    throw InputError(error.what());
  }
}

void printSummary(std::ostream& out, std::uint64_t events, const scene::Stats& stats,
                  const std::string& silent) {
  out << events << (events == 1 ? " event" : " events");
  if (stats.has_watermark) out << "; decided up to " << messages::secondsText(stats.watermark_ns) << " s";
  out << "\nposes: " << stats.accepted << " accepted, " << stats.reordered
      << " of them reordered; dropped: " << stats.late << " late, " << stats.duplicate << " duplicate, "
      << stats.rejected << " rejected\n";
  if (!silent.empty()) out << "no pose at all, so nothing is said about:" << silent << '\n';
}

/// Everything between loaded scene and named files.
class Run {
 public:
  Run(const Options& options, std::shared_ptr<const scene::Scene> scene, std::ostream& out, std::ostream& err)
      : options_(options),
        scene_(std::move(scene)),
        out_(out),
        err_(err),
        input_(options.bags),
        heard_(scene_->objects.size(), false),
        router_(scene_, resolver(),
                [this](int object, const motion::StampedPose& pose, messages::StampKind kind) {
                  if (kind != messages::StampKind::kAlways) outputs_->poseSeen(now_ns_, pose.stamp_ns);
                  heard_[static_cast<std::size_t>(object)] = true;
                  messages::handToEngine(*engine_, object, pose, kind);
                }) {
    input_.check(router_, *scene_, resolver());
    outputs_ = std::make_unique<Outputs>(options, scene_, out);
    scene::Engine::Sinks sinks;
    sinks.event = [this](const scene::Event& event) {
      budget_met_ = budget_met_ || event.reason == impact::Reason::kBudget;
      outputs_->event(event);
    };
    sinks.stats = [this](const scene::Stats& stats) { heartbeat(withMessages(stats)); };
    engine_ = std::make_unique<scene::Engine>(scene_, options.method, sinks);
  }

  int run(const std::string& plan, bool show_progress) {
    const auto start = Clock::now();
    const Nanoseconds from_ns = input_.beginNs() + std::llround(options_.from.value_or(0.0) * 1e9);
    const Nanoseconds to_ns = options_.to ? input_.beginNs() + std::llround(*options_.to * 1e9)
                                          : std::numeric_limits<Nanoseconds>::max();
    outputs_->begin(messages::toTime(from_ns), plan);
    Progress progress(err_, show_progress, messages::toTime(input_.beginNs()),
                      messages::toTime(input_.endNs()));
    const auto summary =
        input_.forEach(router_.topics(), from_ns, to_ns, [&](const BagInput::Message& message) {
          now_ns_ = message.received_ns;
          progress.at(messages::toTime(now_ns_));
          outputs_->input(message);
          gaps_.see(message.connection.topic, message.connection.sender, message.raw);
          try {
            router_.handle(message.connection.topic, message.raw, now_ns_);
          } catch (const messages::PoseError&) {
            // Counted by the router and told at the end; the rest of the bag is good.
          }
          return true;
        });
    router_.flush();
    engine_->flush();
    progress.finish();
    checkRefusals();
    const scene::Stats last = withMessages(engine_->stats());
    budget_met_ = budget_met_ || last.budget_met > 0;
    outputs_->end();
    if (options_.jsonl != "-") printSummary(out_, outputs_->events(), last, silentObjects());
    printFaults();
    if (options_.timing)
      err_ << summary.messages << " messages in "
           << std::chrono::duration<double>(Clock::now() - start).count() << " s\n";
    if (!summary.damage.empty()) {
      err_ << summary.damage << '\n';
      return kBadInput;
    }
    return budget_met_ ? kBudgetMet : kDone;
  }

 private:
  messages::PoseRouter::ResolveTopic resolver() const {
    return [this](const std::string& topic) { return resolveTopic(options_.name_space, topic); };
  }

  std::string silentObjects() const {
    std::string out;
    for (std::size_t i = 0; i < heard_.size(); ++i)
      if (!heard_[i] && scene_->objects[i].source.type != scene::PoseSource::Type::kFixed)
        out += " " + scene_->objects[i].name;
    return out;
  }

  /// Throws InputError when all that an object was sent had to be refused: that is no recording of this
  /// scene.
  void checkRefusals() const {
    for (std::size_t i = 0; i < heard_.size(); ++i) {
      const auto found = router_.faults().find(router_.topicOf(static_cast<int>(i)));
      if (!heard_[i] && found != router_.faults().end() && found->second.refused > 0)
        throw InputError(found->second.first_refusal + "; " + std::to_string(found->second.refused) +
                         " messages there cannot be used, and no other tells where '" +
                         scene_->objects[i].name + "' is");
    }
  }

  void printFaults() const {
    for (const auto& [topic, faults] : router_.faults()) {
      if (faults.refused > 0)
        err_ << "warning: " << faults.refused << (faults.refused == 1 ? " message" : " messages") << " on "
             << topic << " refused; the first: " << faults.first_refusal << '\n';
      if (faults.rejected > 0)
        err_ << "warning: " << faults.rejected << (faults.rejected == 1 ? " pose" : " poses") << " on "
             << topic << " rejected: not finite, or no unit quaternion\n";
    }
  }

  scene::Stats withMessages(scene::Stats stats) const {
    stats.rejected += router_.refused();
    stats.lost = gaps_.lost();
    return stats;
  }

  void heartbeat(scene::Stats stats) {
    const auto now = Clock::now();
    stats.wall_time = options_.timing ? std::chrono::duration<double>(now - last_heartbeat_).count()
                                      : std::numeric_limits<double>::quiet_NaN();
    last_heartbeat_ = now;
    budget_met_ = budget_met_ || stats.budget_met > 0;
    outputs_->stats(stats);
  }

  const Options& options_;
  std::shared_ptr<const scene::Scene> scene_;
  std::ostream& out_;
  std::ostream& err_;
  BagInput input_;
  std::vector<bool> heard_;  // by object
  messages::PoseRouter router_;
  messages::SequenceGaps gaps_;
  std::unique_ptr<Outputs> outputs_;
  std::unique_ptr<scene::Engine> engine_;
  Nanoseconds now_ns_ = 0;
  Clock::time_point last_heartbeat_ = Clock::now();
  bool budget_met_ = false;
};

}  // namespace

int run(const Options& options, std::ostream& out, std::ostream& err, bool progress) {
  if (options.help) {
    out << kUsage;
    return kDone;
  }
  try {
    const auto scene = load(options, err);
    const std::string plan = scene::planText(*scene);
    if (options.plan) (options.jsonl == "-" ? err : out) << plan;
    if (options.bags.empty()) return kDone;
    return Run(options, scene, out, err).run(plan, progress);
  } catch (const InputError& error) {
    err << error.what() << '\n';
  } catch (const messages::PoseError& error) {
    err << error.what() << '\n';
  } catch (const std::invalid_argument& error) {  // the engine refuses what it cannot do for this scene
    err << options.scene << ": " << error.what() << '\n';
  } catch (const rosbag::BagException& error) {
    err << "a bag could not be read or written: " << error.what() << '\n';
  }
  return kBadInput;
}

}  // namespace collision_node::replay
