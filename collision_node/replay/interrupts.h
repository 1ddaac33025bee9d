/// Ctrl-C and its kind, as a question.
#pragma once

namespace collision_node::replay {

/// From now on SIGINT and SIGTERM are only counted.
void countInterrupts();
/// How many came since.
int interrupts();

}  // namespace collision_node::replay
