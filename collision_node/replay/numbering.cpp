#include "collision_node/replay/numbering.h"

#include <stdexcept>
#include <string>

namespace collision_node::replay {

void Numbering::beginWindow(std::uint32_t epoch, const std::vector<std::uint64_t>& own,
                            const std::vector<std::uint64_t>& known) {
  own_epoch_ = epoch;
  contacts_.clear();
  for (std::size_t i = 0; i < own.size(); ++i) contacts_[own[i]] = known[i];
}

std::vector<std::uint64_t> Numbering::giveFirst(std::size_t count) {
  std::vector<std::uint64_t> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(next_contact_++);
  return out;
}

void Numbering::moveTo(std::uint32_t epoch) {
  if (epoch == own_epoch_) return;
  if (epoch < own_epoch_)
    throw std::out_of_range("epoch " + std::to_string(epoch) + " comes after " + std::to_string(own_epoch_));
  epoch_ += epoch - own_epoch_;
  own_epoch_ = epoch;
  next_event_ = next_contact_ = 0;
  contacts_.clear();
}

Numbers Numbering::next(const Numbers& own) {
  moveTo(own.epoch);
  const auto [contact, is_new] = contacts_.emplace(own.contact_id, next_contact_);
  if (is_new) ++next_contact_;
  const Numbers out{epoch_, next_event_++, contact->second, own.is_last};
  if (own.is_last) contacts_.erase(contact);
  return out;
}

}  // namespace collision_node::replay
