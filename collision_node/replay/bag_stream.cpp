#include "collision_node/replay/bag_stream.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace collision_node::replay {

BagStream::BagStream(const std::vector<std::unique_ptr<BagFile>>& bags,
                     std::vector<std::vector<Nanoseconds>> from_ns, Nanoseconds to_ns)
    : bags_(bags), from_ns_(std::move(from_ns)), to_ns_(to_ns) {
  for (std::size_t bag = 0; bag < bags_.size(); ++bag)
    for (std::size_t order = 0; order < bags_[bag]->chunks().size(); ++order)
      if (isWanted(bag, bags_[bag]->chunks()[order])) waiting_.push_back({bag, order});
  const auto key = [this](const Waiting& waiting) {
    return std::make_tuple(bags_[waiting.bag]->chunks()[waiting.order].first_ns, waiting.bag, waiting.order);
  };
  std::sort(waiting_.begin(), waiting_.end(),
            [&](const Waiting& l, const Waiting& r) { return key(r) < key(l); });
}

bool BagStream::isWanted(std::size_t bag, const ChunkInfo& info) const {
  return info.first_ns < to_ns_ &&
         std::any_of(info.connections.begin(), info.connections.end(),
                     [&](std::uint32_t connection) { return from_ns_[bag][connection] <= info.last_ns; });
}

bool BagStream::isBefore(const Source& l, const Source& r) const {
  return std::make_tuple(l.chunk->messages[l.at].received_ns, l.bag, l.order) <
         std::make_tuple(r.chunk->messages[r.at].received_ns, r.bag, r.order);
}

void BagStream::load(const Waiting& waiting) {
  Source source{waiting.bag, waiting.order, 0, nullptr};
  if (spare_.empty()) {
    source.chunk = std::make_unique<Chunk>();
  } else {
    source.chunk = std::move(spare_.back());
    spare_.pop_back();
  }
  const BagFile& bag = *bags_[waiting.bag];
  bag.read(bag.chunks()[waiting.order], from_ns_[waiting.bag], to_ns_, *source.chunk);
  if (source.chunk->messages.empty()) {
    finish(source);
  } else {
    sources_.push_back(std::move(source));
  }
}

/// All messages of the chunk are out.
void BagStream::finish(Source& source) {
  if (!source.chunk->damage.empty())
    throw DamageError(bags_[source.bag]->name() + ": " + source.chunk->damage);
  spare_.push_back(std::move(source.chunk));
}

const BagStream::Message* BagStream::next() {
  if (!sources_.empty() && current_ < sources_.size()) {
    Source& last = sources_[current_];
    if (++last.at == last.chunk->messages.size()) {
      finish(last);
      sources_.erase(sources_.begin() + static_cast<std::ptrdiff_t>(current_));
    }
  }
  const auto front = [this] {
    return std::min_element(sources_.begin(), sources_.end(),
                            [this](const Source& l, const Source& r) { return isBefore(l, r); });
  };
  auto first = front();
  while (!waiting_.empty()) {
    const Waiting next = waiting_.back();
    const Nanoseconds begins = bags_[next.bag]->chunks()[next.order].first_ns;
    if (first != sources_.end() && first->chunk->messages[first->at].received_ns < begins) break;
    waiting_.pop_back();
    load(next);
    first = front();
  }
  if (first == sources_.end()) return nullptr;
  current_ = static_cast<std::size_t>(first - sources_.begin());
  const Chunk::Message& message = first->chunk->messages[first->at];
  message_ = {message.received_ns, first->bag, message.connection,
              first->chunk->bytes.data() + message.offset, message.size};
  return &message_;
}

}  // namespace collision_node::replay
