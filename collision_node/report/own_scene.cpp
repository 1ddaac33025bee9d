#include <stdexcept>

#include "collision_node/report/modes.h"

namespace collision_node::report {

int runOwnScene(const Options&, std::ostream&) { throw std::runtime_error("not yet available"); }

}  // namespace collision_node::report
