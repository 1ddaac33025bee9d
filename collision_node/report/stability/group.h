/// Trials of a walk: queries of one kind whose answer is known in closed form.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collision_node/report/stability/exact_touch.h"
#include "collision_node/report/trial.h"

namespace collision_node::report {

struct Group {
  Trials trials;                ///< two bodies; `name` tells the kind
  std::vector<double> nearest;  ///< [m] how near a pair comes that stays apart, an upper bound; else NaN
  std::vector<double>
      closing;  ///< [m/s] about how fast the last of the gap closes before a contact; else NaN

  /// `point`: world, at `toi`; null where it is not one point. What the conversion to double rounds is in the
  /// truth's errors.
  void addContact(const impact::Piece& piece, const Exact& toi, const Vec<Exact>* point,
                  double closing_speed);
  void addApart(const impact::Piece& piece, double nearest_gap);
};

Group makeGroup(const std::string& name, geometry::Shape a, geometry::Shape b);

double toDouble(const Exact& x);

/// The surface of a body's only shape (point, sphere, box or mesh) turned by `q`, in the axes of its object.
template <typename T>
Surface<T> surfaceOf(const geometry::Body& body, const geometry::Quat& q);

extern template Surface<double> surfaceOf(const geometry::Body&, const geometry::Quat&);
extern template Surface<Exact> surfaceOf(const geometry::Body&, const geometry::Quat&);

}  // namespace collision_node::report
