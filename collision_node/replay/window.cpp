#include "collision_node/replay/window.h"

#include <algorithm>

#include "collision_node/scene/tracks/instant.h"

namespace collision_node::replay {

bool Place::isBefore(const scene::Event& event) const {
  if (event.epoch != epoch) return epoch < event.epoch;
  return !stamp_ns ||
         scene::instantAt(*stamp_ns) < scene::instantAt(event.interval_start_ns, event.toi_lower);
}

bool Place::isBefore(std::uint32_t other_epoch, Nanoseconds other_ns) const {
  if (other_epoch != epoch) return epoch < other_epoch;
  return !stamp_ns || *stamp_ns < other_ns;
}

void Window::openAt(const scene::Cut& cut) {
  begin_ = {cut.epoch, cut.newest_ns};
  begin_state_ = cut.state;
  is_open_ = true;
}

void Window::closeAt(const scene::Cut& cut) {
  end_ = {cut.epoch, cut.newest_ns};
  end_state_ = cut.state;
}

bool Window::take(scene::Event& event) {
  if (end_ && end_->isBefore(event)) return false;
  if (!is_open_ || !begin_.isBefore(event)) {
    see(event);
    return false;
  }
  begin();
  see(event);
  const Numbers numbers =
      numbering_.next({event.epoch, event.event_id, event.contact_id, !event.opens_contact});
  event.epoch = numbers.epoch;
  event.event_id = numbers.event_id;
  event.contact_id = numbers.contact_id;
  return true;
}

bool Window::take(scene::Stats& stats) const {
  if (!is_open_ || !begin_.isBefore(stats.epoch, stats.stamp_ns)) return false;
  if (end_ && end_->isBefore(stats.epoch, stats.stamp_ns)) return false;
  stats.epoch -= begin_.epoch;
  return true;
}

void Window::moveContactsTo(std::uint32_t epoch) {
  if (epoch == contacts_epoch_) return;
  contacts_epoch_ = epoch;
  contacts_.clear();
}

void Window::see(const scene::Event& event) {
  moveContactsTo(event.epoch);
  const Key key{event.a.object, event.a.link, event.b.object, event.b.link};
  if (event.opens_contact) {
    contacts_[key].push_back(event.contact_id);
  } else if (const auto open = contacts_.find(key); open != contacts_.end()) {
    auto& numbers = open->second;
    numbers.erase(std::remove(numbers.begin(), numbers.end(), event.contact_id), numbers.end());
    if (numbers.empty()) contacts_.erase(open);
  }
}

/// Calls visit(number, contact), the contact without its number.
template <typename Visit>
void Window::forEachContact(Visit&& visit) const {
  for (const auto& [key, numbers] : contacts_)
    for (const std::uint64_t number : numbers)
      visit(number, OpenContact{0, std::get<0>(key), std::get<1>(key), std::get<2>(key), std::get<3>(key)});
}

/// All events up to the begin have come.
void Window::begin() {
  if (has_begun_) return;
  has_begun_ = true;
  moveContactsTo(begin_.epoch);
  std::vector<std::uint64_t> own;
  forEachContact([&](std::uint64_t number, const OpenContact& contact) {
    own.push_back(number);
    contacts_at_begin_.push_back(contact);
  });
  const auto known = numbering_.giveFirst(own.size());
  for (std::size_t i = 0; i < known.size(); ++i) contacts_at_begin_[i].contact_id = known[i];
  numbering_.beginWindow(begin_.epoch, own, known);
}

void Window::describeBegin(WindowEnd& end) {
  begin();
  end.opens = true;
  end.epoch = 0;
  end.stamp_ns = begin_.stamp_ns;
  end.state = begin_state_;
  end.contacts = contacts_at_begin_;
}

void Window::describeEnd(WindowEnd& end) {
  begin();
  end.opens = false;
  if (end_) {
    moveContactsTo(end_->epoch);
    numbering_.moveTo(end_->epoch);
    end.stamp_ns = end_->stamp_ns;
    end.state = end_state_;
  }
  end.epoch = numbering_.epoch();
  forEachContact([&](std::uint64_t number, OpenContact contact) {
    contact.contact_id = numbering_.contact(number);
    end.contacts.push_back(contact);
  });
}

}  // namespace collision_node::replay
