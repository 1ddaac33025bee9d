/// The first contact of two surfaces on a straight relative path without a turn, by its closed form, in any
/// arithmetic: pairs of features, each a linear or quadratic equation. It shares nothing with the solver.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <optional>
#include <vector>

#include "collision_node/geometry/types.h"

namespace collision_node::report {

/// 50 decimal digits. Doubles enter exactly; what is rounded here is 34 digits below what is judged.
using Exact =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

template <typename T>
using Vec = Eigen::Matrix<T, 3, 1>;

template <typename T>
Vec<T> lift(const geometry::Vec3& v) {
  return {T(v.x()), T(v.y()), T(v.z())};
}

/// q v, with q made unit in this arithmetic, as the motion model has it.
template <typename T>
Vec<T> turned(const geometry::Quat& q, const Vec<T>& v) {
  const T w(q.w());
  const Vec<T> u = lift<T>(q.vec());
  const T square = w * w + u.dot(u);
  return ((w * w - u.dot(u)) * v + (T(2) * u.dot(v)) * u + (T(2) * w) * u.cross(v)) / square;
}

/// A surface of triangles, a segment or a point, grown by `radius`. Faces without an area are left out by
/// firstTouch(); their edges count.
template <typename T>
struct Surface {
  std::vector<Vec<T>> vertices;
  std::vector<std::array<int, 2>> edges;
  std::vector<std::array<int, 3>> faces;
  T radius = T(0);
};

template <typename T>
struct Touch {
  T time;
  Vec<T> point;           ///< as A's vertices are given
  bool one_point = true;  ///< no other pair of features touches elsewhere at that time
};

/// The first time in (-infinity, infinity) at which `a` and `b` + d + v t are within the sum of their radii;
/// nothing when they never are. v is not zero.
///
/// Coming from far away, the first contact lies between two closed features, and their own distance falls to
/// the sum of the radii just then. Each pair of features gives one candidate: its earliest such time at which
/// the closest points lie in the features. Every candidate is a contact, so the first one is the first
/// contact. Faces and crossed edges touch at a linear height; vertices and edges at a quadratic distance,
/// which is asked only with a radius: without one they lie in the closed faces and edges.
template <typename T>
std::optional<Touch<T>> firstTouch(const Surface<T>& a, const Surface<T>& b, const Vec<T>& d,
                                   const Vec<T>& v);

extern template std::optional<Touch<double>> firstTouch(const Surface<double>&, const Surface<double>&,
                                                        const Vec<double>&, const Vec<double>&);
extern template std::optional<Touch<Exact>> firstTouch(const Surface<Exact>&, const Surface<Exact>&,
                                                       const Vec<Exact>&, const Vec<Exact>&);

}  // namespace collision_node::report
