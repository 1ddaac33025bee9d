#include "collision_node/replay/merge.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "collision_node/messages/event_text.h"
#include "collision_node/replay/numbering.h"
#include "collision_node/replay/options.h"
#include "collision_node/replay/pending_file.h"
#include "collision_node/replay/replay.h"
#include "collision_node/replay/window_lines.h"

namespace collision_node::replay {

namespace {

struct Window {
  std::string file;
  WindowEnd opens, closes;
};

/// The numbers in an event's line, and where they stand.
struct NumbersInLine {
  Numbers numbers;
  std::size_t begin = 0, end = 0;
};

/// An unescaped quote cannot stand inside a JSON string: this is found where the header ends, and nowhere
/// before.
constexpr std::string_view kEpoch = "},\"epoch\":", kEventId = ",\"event_id\":",
                           kContactId = ",\"contact_id\":";

std::optional<NumbersInLine> findNumbers(const std::string& line) {
  NumbersInLine out;
  std::size_t at = line.find(kEpoch);
  const auto number = [&](std::string_view name, auto& to) {
    if (at == std::string::npos || line.compare(at, name.size(), name) != 0) return false;
    const auto [end, fault] = std::from_chars(line.data() + at + name.size(), line.data() + line.size(), to);
    at = static_cast<std::size_t>(end - line.data());
    return fault == std::errc();
  };
  if (!number(kEpoch, out.numbers.epoch)) return std::nullopt;
  out.begin = line.find(kEpoch) + kEpoch.size();
  if (!number(kEventId, out.numbers.event_id) || !number(kContactId, out.numbers.contact_id))
    return std::nullopt;
  out.end = at;
  constexpr std::string_view kSeparation = ",\"kind\":\"SEPARATION\"";
  out.numbers.is_last = line.compare(at, kSeparation.size(), kSeparation) == 0;
  if (line.front() != '{' || line.back() != '}') return std::nullopt;
  return out;
}

std::string textOf(const Numbers& numbers) {
  return std::to_string(numbers.epoch) + std::string(kEventId) + std::to_string(numbers.event_id) +
         std::string(kContactId) + std::to_string(numbers.contact_id);
}

/// Reads the file once, to know where it was cut and that it is whole.
Window readEnds(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file + ": cannot be read");
  Window window{file, {}, {}};
  std::string line, last;
  std::uint64_t count = 0;
  const auto fail = [&](const std::string& fault) { throw InputError(file + ": " + fault); };
  bool has_opened = false, has_closed = false;
  while (std::getline(in, line)) {
    ++count;
    const std::string where = "line " + std::to_string(count) + ": ";
    if (in.eof()) fail(where + "is cut short; the run that wrote it did not finish");
    if (has_closed) fail(where + "nothing may follow the line that closes a window");
    if (!isWindowLine(line)) {
      if (line.empty() || !findNumbers(line)) fail(where + "is no event of replay --jsonl");
      continue;
    }
    try {
      const WindowEnd end = parseWindowLine(line);
      if (end.opens != (count == 1) && end.opens)
        fail(where + "a second window begins; give each its own file");
      has_closed = !end.opens;
      has_opened = has_opened || end.opens;
      (end.opens ? window.opens : window.closes) = end;
    } catch (const InputError&) {
      throw;
    } catch (const std::runtime_error& error) {
      fail(where + error.what());
    }
  }
  if (!has_closed)
    fail(has_opened
             ? "has no line that closes it; the run that wrote it did not finish"
             : "says nowhere where it was cut: windows are written by replay --from ... --to ... --jsonl");
  if (!has_opened) {  // a run over all of it that was interrupted
    window.opens.opens = true;
    window.opens.run = window.closes.run;
  }
  return window;
}

std::string secondsAfterBegin(const RunIdentity& run, const std::optional<Nanoseconds>& received_ns) {
  if (!received_ns) return "the end";
  return messages::secondsText(*received_ns - run.begin_ns) + " s";
}

void checkAdjoins(const Window& before, const Window& behind) {
  const std::string both = before.file + " and " + behind.file + ": ";
  const RunIdentity& l = before.closes.run;
  const RunIdentity& r = behind.opens.run;
  if (!(before.opens.run == l) || !(behind.closes.run == r) || !(l == r))
    throw InputError(both + (l.scene == r.scene ? "are windows of different recordings"
                                                : "come from different scenes, methods or namespaces"));
  const Nanoseconds ends = before.closes.received_ns.value_or(std::numeric_limits<Nanoseconds>::max());
  const Nanoseconds begins = behind.opens.received_ns.value_or(l.begin_ns);
  if (ends != begins)
    throw InputError(both +
                     (ends < begins ? "leave a hole: the first ends at " : "overlap: the first ends at ") +
                     secondsAfterBegin(l, before.closes.received_ns) + ", the second begins at " +
                     secondsAfterBegin(r, begins));
  if (before.closes.state != behind.opens.state || before.closes.stamp_ns != behind.opens.stamp_ns)
    throw InputError(both + "do not agree on the state at their cut, " +
                     secondsAfterBegin(r, behind.opens.received_ns) +
                     ": what happened long before counts there; run the second again with a longer --lead");
}

/// Numbers of the contacts open at a cut, as the window before it has them and as the one behind it has them.
std::pair<std::vector<std::uint64_t>, std::vector<std::uint64_t>> join(const Window& before,
                                                                       const Window& behind,
                                                                       const Numbering& numbering) {
  std::vector<std::uint64_t> own, known;
  const auto& l = before.closes.contacts;  // both by pair, those of one pair in the order they opened
  const auto& r = behind.opens.contacts;
  for (std::size_t i = 0; i < std::max(l.size(), r.size()); ++i) {
    if (i == l.size() || i == r.size() || !l[i].isSamePair(r[i])) {
      const OpenContact& contact = i < r.size() ? r[i] : l[i];
      throw InputError(before.file + " and " + behind.file + ": do not agree on whether " + contact.object_a +
                       "/" + contact.link_a + " and " + contact.object_b + "/" + contact.link_b +
                       " touch at their cut; run the second again with a longer --lead");
    }
    own.push_back(r[i].contact_id);
    known.push_back(numbering.contact(l[i].contact_id));
  }
  return {own, known};
}

class Merge {
 public:
  Merge(const std::vector<Window>& windows, std::ostream& out) : windows_(windows), out_(out) {}

  void run() {
    const WindowEnd& opens = windows_.front().opens;
    const WindowEnd& closes = windows_.back().closes;
    const bool is_whole = !opens.received_ns && !closes.received_ns;
    std::vector<std::uint64_t> own;
    for (const OpenContact& contact : opens.contacts) own.push_back(contact.contact_id);
    auto known = numbering_.giveFirst(own.size());
    if (!is_whole) out_ << toLine(opens) << '\n';
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      if (i > 0) std::tie(own, known) = join(windows_[i - 1], windows_[i], numbering_);
      try {
        numbering_.beginWindow(0, own, known);
        copyEvents(windows_[i].file);
        numbering_.moveTo(windows_[i].closes.epoch);
        for (const OpenContact& contact : windows_[i].closes.contacts) numbering_.contact(contact.contact_id);
      } catch (const std::out_of_range& error) {
        throw InputError(windows_[i].file + ": its numbers do not fit together (" + error.what() + ")");
      }
    }
    if (is_whole) return;
    WindowEnd end = closes;
    end.epoch = numbering_.epoch();
    for (OpenContact& contact : end.contacts) contact.contact_id = numbering_.contact(contact.contact_id);
    out_ << toLine(end) << '\n';
  }

 private:
  void copyEvents(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    Numbers expected;
    for (std::string line; std::getline(in, line);) {
      if (isWindowLine(line)) continue;
      const auto found = findNumbers(line);
      if (!found) throw InputError(file + ": has changed while it was read");
      if (found->numbers.epoch != expected.epoch) expected = {found->numbers.epoch, 0, 0, false};
      if (found->numbers.event_id != expected.event_id++)
        throw InputError(file + ": event " + std::to_string(expected.event_id - 1) + " of epoch " +
                         std::to_string(expected.epoch) + " is missing");
      out_ << std::string_view(line).substr(0, found->begin) << textOf(numbering_.next(found->numbers))
           << std::string_view(line).substr(found->end) << '\n';
    }
  }

  const std::vector<Window>& windows_;
  std::ostream& out_;
  Numbering numbering_;
};

}  // namespace

MergeOptions parseMergeOptions(const std::vector<std::string>& arguments) {
  MergeOptions out;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    if (word == "--jsonl" || word.rfind("--jsonl=", 0) == 0) {
      if (word.size() > 8) {
        out.jsonl = word.substr(8);
      } else if (++i < arguments.size()) {
        out.jsonl = arguments[i];
      } else {
        throw InputError("--jsonl needs a value; see replay --help");
      }
    } else if (word.size() > 1 && word[0] == '-') {
      throw InputError("unknown option " + word + " of replay merge; there is --jsonl FILE");
    } else {
      out.files.push_back(word);
    }
  }
  if (out.files.empty())
    throw InputError("no windows given: replay merge a.jsonl b.jsonl ... [--jsonl FILE]");
  if (out.jsonl == "/dev/stdout") out.jsonl = "-";
  return out;
}

int merge(const MergeOptions& options, std::ostream& out) {
  std::vector<Window> windows;
  for (const auto& file : options.files) windows.push_back(readEnds(file));
  std::sort(windows.begin(), windows.end(), [](const Window& l, const Window& r) {
    const auto key = [](const Window& w) {
      return std::make_pair(w.opens.received_ns.value_or(std::numeric_limits<Nanoseconds>::min()),
                            w.closes.received_ns.value_or(std::numeric_limits<Nanoseconds>::max()));
    };
    return key(l) < key(r);
  });
  for (std::size_t i = 0; i + 1 < windows.size(); ++i) checkAdjoins(windows[i], windows[i + 1]);
  std::ostream nowhere(nullptr);
  Merge(windows, nowhere).run();  // what does not fit together is found before anything is written
  if (options.jsonl == "-") {
    Merge(windows, out).run();
    out.flush();
    if (!out) throw InputError("standard output: could not be written whole");
    return kDone;
  }
  PendingFile file(options.jsonl, options.files, {});
  std::ofstream stream;
  openText(stream, file);
  Merge(windows, stream).run();
  finishText(stream, file);
  return kDone;
}

}  // namespace collision_node::replay
