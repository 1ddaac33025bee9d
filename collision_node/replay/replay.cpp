#include "collision_node/replay/replay.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "collision_node/messages/convert.h"
#include "collision_node/messages/event_text.h"
#include "collision_node/messages/resources.h"
#include "collision_node/replay/bag_input.h"
#include "collision_node/replay/interrupts.h"
#include "collision_node/replay/outputs.h"
#include "collision_node/replay/progress.h"
#include "collision_node/replay/session.h"
#include "collision_node/replay/window.h"
#include "collision_node/replay/window_lines.h"
#include "collision_node/scene/needs.h"

namespace collision_node::replay {

namespace {

using Clock = std::chrono::steady_clock;

constexpr Nanoseconds kEver = std::numeric_limits<Nanoseconds>::min();
constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();
const char* const kTf = "/tf";
const char* const kTfStatic = "/tf_static";

bool isTf(const std::string& topic) { return topic == kTf || topic == kTfStatic; }

/// Ctrl-C, and there is nothing to keep.
struct Interrupted {};

std::shared_ptr<const scene::Scene> load(const Options& options, std::ostream& err) {
  try {
    auto loaded = scene::loadScene(options.scene, messages::makeResources(options.scene));
    for (const auto& warning : loaded->warnings) err << "warning: " << warning << '\n';
    return loaded;
  } catch (const scene::SceneError& error) {
    throw InputError(error.what());
  }
}

void printSummary(std::ostream& out, std::uint64_t events, std::optional<Nanoseconds> decided_ns,
                  const scene::Stats& stats, const std::string& silent) {
  out << events << (events == 1 ? " event" : " events");
  if (decided_ns) out << "; decided up to " << messages::secondsText(*decided_ns) << " s";
  out << "\nposes: " << stats.accepted << " accepted, " << stats.reordered
      << " of them reordered; dropped: " << stats.late << " late, " << stats.duplicate << " duplicate, "
      << stats.rejected << " rejected\n";
  if (!silent.empty()) out << "no pose at all, so nothing is said about:" << silent << '\n';
}

/// Everything between loaded scene and named files.
class Run {
 public:
  Run(const Options& options, std::shared_ptr<const scene::Scene> scene, std::ostream& out, std::ostream& err)
      : options_(options), scene_(std::move(scene)), out_(out), err_(err), input_(options.bags) {
    from_ns_ = at(options.from.value_or(0.0));
    if (options.to) to_ns_ = at(*options.to);
  }

  int run(const std::string& plan, bool show_progress) {
    const auto start = Clock::now();
    startSession();
    if (from_ns_ > input_.endNs())
      throw InputError("--from " + std::to_string(*options_.from) + ": the recording ends " +
                       messages::secondsText(input_.endNs() - input_.beginNs()) +
                       " s after its first message");
    outputs_ = std::make_unique<Outputs>(options_, scene_, out_);
    outputs_->begin(messages::toTime(from_ns_), plan);
    Nanoseconds lead = firstLead();
    for (bool is_first = true;; is_first = false, lead = longer(lead)) {
      if (!is_first) startSession();
      Progress progress(err_, show_progress, std::max(lead, input_.beginNs()),
                        std::min(to_ns_, input_.endNs()));
      if (readFrom(lead, progress)) break;
    }
    return finish(start);
  }

 private:
  Nanoseconds at(double seconds) const { return input_.beginNs() + std::llround(seconds * 1e9); }
  bool isWindow() const { return options_.from || options_.to; }
  bool startsAtBegin() const { return from_ns_ <= input_.beginNs(); }

  void startSession() {
    window_ = Window();
    Session::Sinks sinks;
    sinks.pose_seen = [this](Nanoseconds received_ns, Nanoseconds stamp_ns) {
      outputs_->poseSeen(received_ns, stamp_ns);
    };
    sinks.engine.event = [this](const scene::Event& event) { take(event); };
    sinks.engine.stats = [this](const scene::Stats& stats) { heartbeat(session_->withMessages(stats)); };
    session_ = std::make_unique<Session>(options_, scene_, input_, sinks);
  }

  /// Where a window's session begins, so that it knows at the cut what one run over all of it knows there.
  Nanoseconds firstLead() const {
    if (startsAtBegin()) return kEver;
    Nanoseconds lead = from_ns_ - std::max(2 * memoryOf(scene_->time),
                                           static_cast<Nanoseconds>(std::llround(options_.lead * 1e9)));
    for (const auto& topic : session_->router().topics())
      if (const auto last = input_.lastBefore(topic, from_ns_); last && !isTf(topic))
        lead = std::min(lead, *last - memoryOf(scene_->time));
    return lead <= input_.beginNs() ? kEver : lead;
  }
  Nanoseconds longer(Nanoseconds lead) const {
    const Nanoseconds twice = from_ns_ - 2 * (from_ns_ - lead);
    return twice <= input_.beginNs() ? kEver : twice;
  }

  /// False when the lead is too short.
  bool readFrom(Nanoseconds lead, Progress& progress) {
    bool is_too_short = false, is_decided = false;
    const auto open = [&] {
      const scene::Cut cut = session_->cut();
      is_too_short = lead != kEver && !session_->knowsAllAt(cut);
      if (is_too_short) return false;
      window_.openAt(cut);
      before_ = session_->stats();
      return true;
    };
    summary_ =
        input_.forEach(session_->router().topics(), lead, kNever, [&](const BagInput::Message& message) {
          if (!window_.isOpen() && message.received_ns >= from_ns_ && !open()) return false;
          if (interrupts() > 0) interrupt(message.received_ns);
          if (!window_.end() && message.received_ns >= to_ns_) close();
          if (window_.end()) {
            is_decided = session_->engine().hasPublished(window_.end()->epoch, window_.end()->stamp_ns);
            if (is_decided) return false;
          } else if (window_.isOpen() || message.connection.topic == kTfStatic) {
            outputs_->input(message);
          }
          progress.at(message.received_ns);
          session_->feed(message);
          return true;
        });
    progress.finish();
    if (is_too_short || (!window_.isOpen() && !open())) return false;
    if (!window_.end() && to_ns_ <= input_.endNs()) close();
    if (!is_decided) session_->flush();
    if (!window_.end()) inside_ = session_->stats();
    return true;
  }

  void close() {
    window_.closeAt(session_->cut());
    inside_ = session_->stats();
  }

  /// Ctrl-C ends the window here; a second one gives up.
  void interrupt(Nanoseconds received_ns) {
    if (!window_.isOpen() || interrupts() > 1) throw Interrupted();
    if (window_.end()) return;
    is_interrupted_ = true;
    to_ns_ = received_ns;
  }

  void take(const scene::Event& original) {
    scene::Event event = original;
    if (!window_.take(event)) return;
    writeBegin();
    budget_met_ = budget_met_ || event.reason == impact::Reason::kBudget;
    outputs_->event(event, original.epoch);
  }

  void heartbeat(scene::Stats stats) {
    const auto now = Clock::now();
    stats.wall_time = options_.timing ? std::chrono::duration<double>(now - last_heartbeat_).count()
                                      : std::numeric_limits<double>::quiet_NaN();
    last_heartbeat_ = now;
    const std::uint32_t own_epoch = stats.epoch;
    if (window_.take(stats)) outputs_->stats(inWindow(stats), own_epoch);
  }

  /// The poses and the costs of the window alone.
  scene::Stats inWindow(scene::Stats stats) const {
    stats.accepted -= before_.accepted;
    stats.reordered -= before_.reordered;
    stats.late -= before_.late;
    stats.duplicate -= before_.duplicate;
    stats.rejected -= before_.rejected;
    stats.lost -= before_.lost;
    stats.holes -= before_.holes;
    stats.node_tests -= before_.node_tests;
    stats.subdivisions -= before_.subdivisions;
    stats.budget_met -= before_.budget_met;
    return stats;
  }

  WindowEnd windowEnd() const {
    WindowEnd end;
    end.run = {fingerprintOf(*scene_, options_.method, options_.name_space), input_.beginNs(), input_.endNs(),
               input_.messages()};
    return end;
  }

  void writeBegin() {
    if (has_written_begin_ || !isWindow()) return;
    has_written_begin_ = true;
    WindowEnd end = windowEnd();
    if (!startsAtBegin()) end.received_ns = from_ns_;
    window_.describeBegin(end);
    outputs_->jsonLine(toLine(end));
  }

  void writeEnd() {
    WindowEnd end = windowEnd();
    if (window_.end()) end.received_ns = to_ns_;
    window_.describeEnd(end);
    outputs_->jsonLine(toLine(end));
  }

  int finish(const Clock::time_point& start) {
    const scene::Stats stats = inWindow(inside_);
    budget_met_ = budget_met_ || stats.budget_met > 0;
    checkRefusals();
    writeBegin();
    if (summary_.damage.empty() && (isWindow() || is_interrupted_)) writeEnd();
    if (options_.jsonl != "-")
      printSummary(out_, outputs_->events(), decidedUpTo(stats), stats, silentObjects());
    outputs_->end();
    printFaults();
    if (options_.timing)
      err_ << summary_.messages << " messages in "
           << std::chrono::duration<double>(Clock::now() - start).count() << " s\n";
    if (!summary_.damage.empty()) {
      err_ << summary_.damage << '\n';
      return kBadInput;
    }
    if (is_interrupted_) {
      err_ << "interrupted: what the messages before " << messages::secondsText(to_ns_ - input_.beginNs())
           << " s say is decided and written; `--from " << messages::secondsText(to_ns_ - input_.beginNs())
           << "` goes on there, and `replay merge` joins the two\n";
      return kInterrupted;
    }
    return budget_met_ ? kBudgetMet : kDone;
  }

  std::optional<Nanoseconds> decidedUpTo(const scene::Stats& stats) const {
    if (window_.end()) return window_.end()->stamp_ns;
    if (!stats.has_watermark) return std::nullopt;
    return stats.watermark_ns;
  }

  std::string silentObjects() const {
    std::string out;
    const std::vector<scene::Need> needs = scene::needsOf(*scene_);
    for (std::size_t i = 0; i < needs.size(); ++i)
      if (session_->heard()[i] == 0 && needs[i] == scene::Need::kWatched &&
          scene_->objects[i].source.type != scene::PoseSource::Type::kFixed)
        out += " " + scene_->objects[i].label();
    return out;
  }

  /// It, or a part that hangs on it, has sent a pose.
  bool isHeard(std::size_t object) const {
    const std::vector<scene::Object>& objects = scene_->objects;
    for (std::size_t i = object; i < objects.size() && objects[i].name == objects[object].name; ++i)
      if (session_->heard()[i] != 0) return true;
    return false;
  }

  /// Throws InputError when all that an object was sent had to be refused: that is no recording of this
  /// scene.
  void checkRefusals() const {
    const auto& faults = session_->router().faults();
    for (std::size_t i = 0; i < scene_->objects.size(); ++i) {
      const auto found = faults.find(session_->router().topicOf(static_cast<int>(i)));
      if (!isHeard(i) && found != faults.end() && found->second.refused > 0)
        throw InputError(found->second.first_refusal + "; " + std::to_string(found->second.refused) +
                         " messages there cannot be used, and no other tells where '" +
                         scene_->objects[i].label() + "' is");
    }
  }

  void printFaults() const {
    for (const auto& line : session_->router().missingJoints())
      err_ << "warning: no position of " << line << '\n';
    for (const auto& [topic, faults] : session_->router().faults()) {
      if (faults.refused > 0)
        err_ << "warning: " << faults.refused << (faults.refused == 1 ? " message" : " messages") << " on "
             << topic << " refused; the first: " << faults.first_refusal << '\n';
      if (faults.rejected > 0)
        err_ << "warning: " << faults.rejected << (faults.rejected == 1 ? " pose" : " poses") << " on "
             << topic << " rejected: not finite, beyond 1e15 m, or no unit quaternion\n";
      if (faults.unstamped > 1)
        err_ << "warning: " << faults.unstamped << " poses on " << topic
             << " have the stamp 0, and of one stamp only the first counts: its publisher must fill in "
                "header.stamp, the instant when the object was there\n";
      if (faults.twistless > 0)
        err_ << "warning: " << faults.twistless << (faults.twistless == 1 ? " pose" : " poses") << " on "
             << topic
             << " without the twist that motion: hermite and spin are made from (Odometry has one): taken as "
                "slerp, UNCERTIFIED, ALIAS\n";
    }
  }

  const Options& options_;
  std::shared_ptr<const scene::Scene> scene_;
  std::ostream& out_;
  std::ostream& err_;
  BagInput input_;
  Nanoseconds from_ns_ = 0, to_ns_ = kNever;  ///< receive times
  std::unique_ptr<Outputs> outputs_;
  std::unique_ptr<Session> session_;
  Window window_;
  BagInput::Summary summary_;
  scene::Stats before_, inside_;  ///< at the window's begin and end
  Clock::time_point last_heartbeat_ = Clock::now();
  bool budget_met_ = false, is_interrupted_ = false, has_written_begin_ = false;
};

}  // namespace

int run(const Options& options, std::ostream& out, std::ostream& err, bool progress) {
  if (options.help) {
    out << kUsage;
    return kDone;
  }
  try {
    const auto scene = load(options, err);
    const std::string plan = options.plan || !options.out.empty() ? scene::planText(*scene) : "";
    if (options.plan) (options.jsonl == "-" ? err : out) << plan;
    if (options.bags.empty()) return kDone;
    return Run(options, scene, out, err).run(plan, progress);
  } catch (const Interrupted&) {
    err << "interrupted; nothing is written\n";
    return kInterrupted;
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
