/// Four moving vertices as one question to linear_features.h and to the exact oracle.
#pragma once

#include <array>

#include "collision_node/impact/linear/linear_features.h"
#include "test/oracle/linear_contact.h"

namespace linear {

using collision_node::geometry::Vec3;
using collision_node::impact::edgeEdgeContact;
using collision_node::impact::LinearContact;
using collision_node::impact::LinearVerdict;
using collision_node::impact::LinearVertex;
using collision_node::impact::vertexFaceContact;

/// Edges: a0 a1 b0 b1; else the vertex and the triangle's three.
struct Query {
  bool edges = false;
  std::array<LinearVertex, 4> vertices;
};

inline LinearContact ask(const Query& q) {
  const auto& v = q.vertices;
  return q.edges ? edgeEdgeContact({v[0], v[1]}, {v[2], v[3]}) : vertexFaceContact(v[0], {v[1], v[2], v[3]});
}

inline std::optional<oracle::Moment> truth(const Query& q) {
  std::array<oracle::Position, 4> paths;
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < 3; ++i) {
      const oracle::Rational start(q.vertices[k].start[i]), end(q.vertices[k].end[i]);
      paths[k][i] = oracle::trimmed({start, end - start});
    }
  }
  return oracle::LinearPair(paths, q.edges).firstTouch();
}

template <typename Change>
Query changed(Query q, Change&& change) {
  for (LinearVertex& v : q.vertices) {
    v.start = change(v.start, 0.0);
    v.end = change(v.end, 1.0);
  }
  return q;
}

inline bool same(const LinearContact& x, const LinearContact& y) {
  if (x.verdict != y.verdict) return false;
  return x.verdict == LinearVerdict::kClear || (x.t_lo == y.t_lo && x.t_hi == y.t_hi);
}

}  // namespace linear
