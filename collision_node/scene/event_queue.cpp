#include "collision_node/scene/event_queue.h"

#include <utility>

namespace collision_node::scene {

void EventQueue::push(int pair_rank, const Event& event, std::shared_ptr<ContactNumber> contact) {
  const Key key{instantAt(event.interval_start_ns, event.toi_lower),
                instantAt(event.interval_start_ns, event.toi_upper), pair_rank, event.kind, arrivals_++};
  events_.emplace(key, Waiting{event, std::move(contact)});
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
