#include "collision_node/scene/event_queue.h"

#include <utility>

namespace collision_node::scene {

void EventQueue::take(Outbox& outbox) {
  for (Outbox::Item& item : outbox.items) {
    const Key key{instantAt(item.event.interval_start_ns, item.event.toi_lower),
                  instantAt(item.event.interval_start_ns, item.event.toi_upper), item.rank, item.event.kind,
                  arrivals_++};
    events_.emplace(key, Waiting{std::move(item.event), std::move(item.contact)});
  }
  outbox.items.clear();
}

Event EventQueue::pop() {
  const auto first = events_.begin();
  Event event = std::move(first->second.event);
  ContactNumber& contact = *first->second.contact;
  if (!contact.is_given) contact = {true, next_contact_++};
  event.contact_id = contact.value;
  event.event_id = next_event_++;
  events_.erase(first);
  return event;
}

void EventQueue::newEpoch() { next_event_ = next_contact_ = 0; }

}  // namespace collision_node::scene
