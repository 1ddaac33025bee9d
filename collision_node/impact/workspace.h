/// Working memory of the solver, owned by the caller: one per thread. Only capacity survives a call, no
/// result depends on what a workspace was used for before.
#pragma once

#include <memory>

namespace collision_node::impact {

class Workspace {
 public:
  Workspace();
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

  struct Buffers;  ///< walk/search.h; for the solver's files only
  Buffers& buffers() { return *buffers_; }

 private:
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace collision_node::impact
