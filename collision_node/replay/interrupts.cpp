#include "collision_node/replay/interrupts.h"

#include <csignal>

namespace collision_node::replay {

namespace {

volatile std::sig_atomic_t count = 0;

void note(int) { count = count + 1; }

}  // namespace

void countInterrupts() {
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

int interrupts() { return count; }

}  // namespace collision_node::replay
