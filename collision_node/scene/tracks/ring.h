/// A queue in one block of memory, which grows when it is full: what a track keeps is taken out at one end
/// nearly as fast as it is put in at the other.
#pragma once

#include <algorithm>
#include <boost/circular_buffer.hpp>

namespace collision_node::scene {

/// References into it last until the next push.
template <typename T>
class Ring : public boost::circular_buffer<T> {
 public:
  void push_back(const T& item) {
    constexpr std::size_t kFirst = 4;
    if (this->full()) this->set_capacity(std::max(kFirst, 2 * this->capacity()));
    boost::circular_buffer<T>::push_back(item);
  }
};

}  // namespace collision_node::scene
