/// Two small polyhedra that move and turn, and the functions of time whose signs say whether a vertex meets a
/// face or an edge an edge; in any of the two kinds of interval.
///
/// Vertex and face: the face's plane and the three planes through its borders are fixed in its body, so each
/// is n(t).(p(t) - c(t)) - h with h a constant. Edges d1 (from x1) and d2 (from x2): with r = x2 - x1 and N =
/// d1 x d2 they are in one plane where N.r = 0, and meet there at the share u of d1 and v of d2, u N.N = (r x
/// d2).N, v N.N = (r x d1).N.
#pragma once

#include <array>
#include <set>
#include <utility>
#include <vector>

#include "test/oracle/quick_interval.h"
#include "test/oracle/stamped_motion.h"

namespace oracle {

/// Vertices in the body's frame and the triangles over them; edges follow from those. A single vertex is a
/// point.
struct Polyhedron {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<int, 3>> triangles;

  std::vector<std::pair<int, int>> edges() const {
    std::set<std::pair<int, int>> all;
    for (const auto& t : triangles) {
      for (std::size_t k = 0; k < 3; ++k) all.insert(std::minmax(t[k], t[(k + 1) % 3]));
    }
    return {all.begin(), all.end()};
  }
};

/// A vector of a turning body: still + cos cosine + sin sine, relative to the body's origin.
template <class I>
struct Arm {
  Vector<I> still, cosine, sine;
};

template <class I>
struct TurningPlane {
  Arm<I> normal;
  I offset;
};
/// The plane of a face, and those through its borders across it, positive inside.
template <class I>
struct TurningFace {
  TurningPlane<I> plane, border[3];
};
template <class I>
struct TurningEdge {
  Arm<I> from, along;
};

template <class I>
struct TurningBody {
  TurningBody(const Polyhedron& shape, const StampedMotion& motion, std::int64_t start_ns) {
    convert(motion.angleAt(start_ns), angle);
    convert(motion.rate(), rate);
    const auto arm = [&](const I3& x) {
      const I3 first = motion.orientedFirst(x);
      if (!motion.turns()) return Arm<I>{converted<I>(first), {}, {}};
      const I3 still = times(dotOf(motion.axis(), first), motion.axis());
      return Arm<I>{converted<I>(still), converted<I>(minus(first, still)),
                    converted<I>(crossOf(motion.axis(), first))};
    };
    const auto plane = [&](const I3& normal, const I3& point) {
      TurningPlane<I> p{arm(normal), {}};
      convert(dotOf(normal, point), p.offset);
      return p;
    };
    std::vector<I3> local;
    for (const auto& v : shape.vertices) {
      local.push_back(interval3(v));
      vertices.push_back(arm(local.back()));
      reach = std::max(reach, lengthOf(local.back()).hi.toDouble(MPFR_RNDU));
    }
    for (const auto& t : shape.triangles) {
      const I3 corner[3] = {local[static_cast<std::size_t>(t[0])], local[static_cast<std::size_t>(t[1])],
                            local[static_cast<std::size_t>(t[2])]};
      const I3 normal = crossOf(minus(corner[1], corner[0]), minus(corner[2], corner[0]));
      TurningFace<I> face;
      face.plane = plane(normal, corner[0]);
      for (std::size_t k = 0; k < 3; ++k)
        face.border[k] = plane(crossOf(normal, minus(corner[(k + 1) % 3], corner[k])), corner[k]);
      faces.push_back(face);
    }
    for (const auto& [i, j] : shape.edges()) {
      const I3 &from = local[static_cast<std::size_t>(i)], &to = local[static_cast<std::size_t>(j)];
      edges.push_back({arm(from), arm(minus(to, from))});
    }
  }

  I angle, rate;  ///< at the piece's start; per second
  std::vector<Arm<I>> vertices;
  std::vector<TurningFace<I>> faces;
  std::vector<TurningEdge<I>> edges;
  double reach = 0;  ///< no vertex is farther from the origin
};

/// Which two features of the bodies 0 and 1.
struct FeaturePair {
  bool edges;     ///< else a vertex and a face
  int face_body;  ///< of a vertex and a face
  std::size_t i;  ///< the face; or the edge of body 0
  std::size_t j;  ///< the vertex; or the edge of body 1
};

template <class I>
class TurningPair {
 public:
  TurningPair(const Polyhedron& shape_a, const StampedMotion& a, const Polyhedron& shape_b,
              const StampedMotion& b, std::int64_t start_ns)
      : body_{TurningBody<I>(shape_a, a, start_ns), TurningBody<I>(shape_b, b, start_ns)} {
    const auto of_a = a.positionFrom(start_ns), of_b = b.positionFrom(start_ns);
    for (std::size_t k = 0; k < 4; ++k) d_[k] = converted<I>(minus(of_b[k], of_a[k]));
  }

  std::vector<FeaturePair> allFeatures() const {
    std::vector<FeaturePair> all;
    for (int f = 0; f < 2; ++f) {
      for (std::size_t i = 0; i < body_[f].faces.size(); ++i) {
        for (std::size_t j = 0; j < body_[1 - f].vertices.size(); ++j) all.push_back({false, f, i, j});
      }
    }
    for (std::size_t i = 0; i < body_[0].edges.size(); ++i) {
      for (std::size_t j = 0; j < body_[1].edges.size(); ++j) all.push_back({true, 0, i, j});
    }
    return all;
  }

  /// What all functions need of one time or one interval of time.
  struct Instant {
    I sine[2], cosine[2];
    Vector<I> d, d_rate;  ///< from a's origin to b's, and per second
  };
  Instant at(const I& t) const {
    Instant x;
    for (int k = 0; k < 2; ++k) sineAndCosine(body_[k].angle + body_[k].rate * t, x.sine[k], x.cosine[k]);
    x.d = plus(d_[0], times(t, plus(d_[1], times(t, plus(d_[2], times(t, d_[3]))))));
    x.d_rate = plus(d_[1], times(t, plus(times(2, d_[2]), times(3 * t, d_[3]))));
    return x;
  }

  bool apartByReach(const Instant& x) const {
    const I sum = I(body_[0].reach) + I(body_[1].reach);
    return (dotOf(x.d, x.d) - sum * sum).positive();
  }

  Vector<I> vector(int body, const Arm<I>& arm, const Instant& x) const {
    return plus(arm.still, plus(times(x.cosine[body], arm.cosine), times(x.sine[body], arm.sine)));
  }
  Vector<I> vectorRate(int body, const Arm<I>& arm, const Instant& x) const {
    return times(body_[body].rate, minus(times(x.cosine[body], arm.sine), times(x.sine[body], arm.cosine)));
  }
  /// Of a vertex, from the other body's origin.
  Vector<I> vertexFrom(int other, const Arm<I>& arm, const Instant& x) const {
    const Vector<I> own = vector(1 - other, arm, x);
    return other == 0 ? plus(own, x.d) : minus(own, x.d);
  }
  Vector<I> vertexRateFrom(int other, const Arm<I>& arm, const Instant& x) const {
    const Vector<I> own = vectorRate(1 - other, arm, x);
    return other == 0 ? plus(own, x.d_rate) : minus(own, x.d_rate);
  }

  /// Height of the point p (from the plane's body's origin) over the plane, and its rate.
  I height(int body, const TurningPlane<I>& plane, const Vector<I>& p, const Instant& x) const {
    return dotOf(vector(body, plane.normal, x), p) - plane.offset;
  }
  I heightRate(int body, const TurningPlane<I>& plane, const Vector<I>& p, const Vector<I>& p_rate,
               const Instant& x) const {
    return dotOf(vectorRate(body, plane.normal, x), p) + dotOf(vector(body, plane.normal, x), p_rate);
  }

  /// Two edges at one instant, all relative to a's origin.
  struct Crossing {
    Vector<I> x1, d1, d2, r, n;
    I volume;       ///< n.r: zero where the edges are in one plane
    I u, v, whole;  ///< the shares where they cross, times n.n; n.n
  };
  Crossing crossing(const FeaturePair& f, const Instant& x) const {
    const TurningEdge<I>&e = body_[0].edges[f.i], &g = body_[1].edges[f.j];
    Crossing c;
    c.x1 = vector(0, e.from, x), c.d1 = vector(0, e.along, x);
    c.d2 = vector(1, g.along, x);
    c.r = minus(vertexFrom(0, g.from, x), c.x1);
    c.n = crossOf(c.d1, c.d2);
    c.volume = dotOf(c.n, c.r);
    c.u = dotOf(crossOf(c.r, c.d2), c.n), c.v = dotOf(crossOf(c.r, c.d1), c.n);
    c.whole = dotOf(c.n, c.n);
    return c;
  }
  I volumeRate(const FeaturePair& f, const Crossing& c, const Instant& x) const {
    const TurningEdge<I>&e = body_[0].edges[f.i], &g = body_[1].edges[f.j];
    const Vector<I> r_rate = minus(vertexRateFrom(0, g.from, x), vectorRate(0, e.from, x));
    return dotOf(plus(crossOf(vectorRate(0, e.along, x), c.d2), crossOf(c.d1, vectorRate(1, g.along, x))),
                 c.r) +
           dotOf(c.n, r_rate);
  }

  const TurningBody<I>& body(int k) const { return body_[k]; }

 private:
  TurningBody<I> body_[2];
  Vector<I> d_[4];
};

}  // namespace oracle
