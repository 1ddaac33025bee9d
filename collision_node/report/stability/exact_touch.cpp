#include "collision_node/report/stability/exact_touch.h"

#include <cmath>
#include <limits>

namespace collision_node::report {
namespace {

template <typename T>
class FirstTouch {
 public:
  FirstTouch(const Surface<T>& a, const Surface<T>& b, const Vec<T>& d, const Vec<T>& v)
      : a_(a), b_(b), d_(d), v_(v), radius_(a.radius + b.radius) {}

  std::optional<Touch<T>> find() {
    for (const auto& p : b_.vertices) {
      for (const auto& f : a_.faces) vertexAndFace(p + d_, f, a_, false);
    }
    for (const auto& p : a_.vertices) {
      for (const auto& f : b_.faces) vertexAndFace(p - d_, f, b_, true);
    }
    for (const auto& e : a_.edges) {
      for (const auto& f : b_.edges) edges(e, f);
    }
    if (radius_ > T(0)) {
      for (const auto& p : b_.vertices) {
        for (const auto& e : a_.edges) vertexAndEdge(p + d_, e, a_, false);
        for (const auto& q : a_.vertices) vertices(p + d_, q);
      }
      for (const auto& p : a_.vertices) {
        for (const auto& e : b_.edges) vertexAndEdge(p - d_, e, b_, true);
      }
    }
    return best_;
  }

 private:
  /// A face counts when its height is above what rounding makes of none.
  static bool vanishes(const Vec<T>& cross, const Vec<T>& e, const Vec<T>& f) {
    const T small = std::numeric_limits<T>::epsilon() * T(256);
    return cross.squaredNorm() <= small * small * e.squaredNorm() * f.squaredNorm();
  }

  /// Points of the cores at `time`, in A's coordinates.
  void offer(const T& time, const Vec<T>& on_a, const Vec<T>& on_b) {
    if (best_ && time > best_->time) return;
    const Vec<T> point = radius_ > T(0) ? Vec<T>(on_a + (a_.radius / radius_) * (on_b - on_a)) : on_a;
    if (!best_ || time < best_->time) {
      best_ = Touch<T>{time, point, true};
    } else if (point != best_->point) {
      best_->one_point = false;
    }
  }

  /// `p` moves at v relative to the surface (at -v when `mirrored`: the surface is B's).
  void vertexAndFace(const Vec<T>& p, const std::array<int, 3>& face, const Surface<T>& surface,
                     bool mirrored) {
    const Vec<T>&u = surface.vertices[face[0]], &s = surface.vertices[face[1]],
          &w = surface.vertices[face[2]];
    const Vec<T> v = mirrored ? Vec<T>(-v_) : v_;
    const Vec<T> n = (s - u).cross(w - u);
    if (vanishes(n, s - u, w - u)) return;
    const T rate = n.dot(v);
    if (rate == T(0)) return;
    const T wanted = radius_ * n.norm() * T(rate < T(0) ? 1 : -1);  // the side it comes from
    const T time = (wanted - n.dot(p - u)) / rate;
    const Vec<T> foot = p + time * v - (wanted / n.squaredNorm()) * n;
    if (n.dot((s - u).cross(foot - u)) < T(0) || n.dot((w - s).cross(foot - s)) < T(0) ||
        n.dot((u - w).cross(foot - w)) < T(0)) {
      return;
    }
    give(time, p + time * v, foot, mirrored);
  }

  void edges(const std::array<int, 2>& of_a, const std::array<int, 2>& of_b) {
    const Vec<T>&p = a_.vertices[of_a[0]], &q = b_.vertices[of_b[0]];
    const Vec<T> e = a_.vertices[of_a[1]] - p, f = b_.vertices[of_b[1]] - q;
    const Vec<T> n = e.cross(f);
    if (vanishes(n, e, f)) return;
    const T rate = n.dot(v_);
    if (rate == T(0)) return;
    const T wanted = radius_ * n.norm() * T(rate < T(0) ? 1 : -1);
    const T time = (wanted - n.dot(q + d_ - p)) / rate;
    const Vec<T> w = q + d_ + time * v_ - p;
    const T square = n.squaredNorm();
    const T on_e = w.cross(f).dot(n) / square, on_f = w.cross(e).dot(n) / square;
    if (on_e < T(0) || on_e > T(1) || on_f < T(0) || on_f > T(1)) return;
    offer(time, p + on_e * e, q + d_ + time * v_ + on_f * f);
  }

  void vertexAndEdge(const Vec<T>& p, const std::array<int, 2>& edge, const Surface<T>& surface,
                     bool mirrored) {
    const Vec<T>& q = surface.vertices[edge[0]];
    const Vec<T> e = surface.vertices[edge[1]] - q;
    const T square = e.squaredNorm();
    if (square == T(0)) return;
    const Vec<T> v = mirrored ? Vec<T>(-v_) : v_;
    const Vec<T> w = p - q;
    const auto time = within(w - (w.dot(e) / square) * e, v - (v.dot(e) / square) * e);
    if (!time) return;
    const T share = (w + *time * v).dot(e) / square;
    if (share < T(0) || share > T(1)) return;
    give(*time, p + *time * v, q + share * e, mirrored);
  }

  void vertices(const Vec<T>& p, const Vec<T>& q) {
    if (const auto time = within(p - q, v_)) offer(*time, q, p + *time * v_);
  }

  /// The first time at which |w + v t| is the radius.
  std::optional<T> within(const Vec<T>& w, const Vec<T>& v) const {
    using std::sqrt;
    const T square = v.squaredNorm(), along = w.dot(v);
    if (square == T(0)) return std::nullopt;
    const Vec<T> across = w - (along / square) * v;
    const T depth = radius_ * radius_ - across.squaredNorm();
    if (depth < T(0)) return std::nullopt;
    return -along / square - sqrt(depth / square);
  }

  /// `moving` belongs to B and `foot` to A; mirrored, the other way round and in B's coordinates.
  void give(const T& time, const Vec<T>& moving, const Vec<T>& foot, bool mirrored) {
    if (mirrored) {
      const Vec<T> back = d_ + time * v_;
      offer(time, moving + back, foot + back);
    } else {
      offer(time, foot, moving);
    }
  }

  const Surface<T>&a_, &b_;
  const Vec<T> d_, v_;
  const T radius_;
  std::optional<Touch<T>> best_;
};

}  // namespace

template <typename T>
std::optional<Touch<T>> firstTouch(const Surface<T>& a, const Surface<T>& b, const Vec<T>& d,
                                   const Vec<T>& v) {
  return FirstTouch<T>(a, b, d, v).find();
}

template std::optional<Touch<double>> firstTouch(const Surface<double>&, const Surface<double>&,
                                                 const Vec<double>&, const Vec<double>&);
template std::optional<Touch<Exact>> firstTouch(const Surface<Exact>&, const Surface<Exact>&,
                                                const Vec<Exact>&, const Vec<Exact>&);

}  // namespace collision_node::report
