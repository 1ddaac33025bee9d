#include "collision_node/geometry/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>

namespace collision_node::geometry {
namespace {

/// Half a unit in the last place of a float32, relative.
constexpr double kHalfUlp = 0x1p-24;
/// assimp parses text with an exponent in float32 steps: 2.6 half units were the worst of 45 000 numbers.
constexpr double kTextParsing = 4.0;

/// The geometry of all nodes in one frame. `rounding` goes along: the error that float32 storage may have put
/// there.
struct Collected {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
  double rounding = 0.0;  ///< [m], before the user's scale: largest error of one coordinate
};

/// An affine map in double, and a bound of the error that its float32 entries carry.
struct NodeTransform {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();
  int roundings = 0;  ///< how many inexact matrices were multiplied
};

bool isIdentity(const aiMatrix4x4& m) { return m == aiMatrix4x4(); }

NodeTransform child(const NodeTransform& parent, const aiMatrix4x4& m) {
  if (isIdentity(m)) return parent;
  Mat3 linear;
  linear << m.a1, m.a2, m.a3, m.b1, m.b2, m.b3, m.c1, m.c2, m.c3;
  NodeTransform result;
  result.linear = parent.linear * linear;
  result.offset = parent.linear * Vec3(m.a4, m.b4, m.c4) + parent.offset;
  result.roundings = parent.roundings + 1;
  return result;
}

void collectMesh(const aiMesh& mesh, const NodeTransform& to_root, Collected& out) {
  const auto first = static_cast<std::int32_t>(out.vertices.size());
  const Mat3 linear_abs = to_root.linear.cwiseAbs();
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const Vec3 stored(mesh.mVertices[i].x, mesh.mVertices[i].y, mesh.mVertices[i].z);
    out.vertices.push_back(to_root.linear * stored + to_root.offset);
    const double magnitude = (linear_abs * stored.cwiseAbs() + to_root.offset.cwiseAbs()).maxCoeff();
    out.rounding = std::max(out.rounding, (kTextParsing + to_root.roundings) * kHalfUlp * magnitude);
  }
  const bool mirrored = to_root.linear.determinant() < 0.0;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;  // points and lines; polygons have been triangulated
    std::array<std::int32_t, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = first + static_cast<std::int32_t>(face.mIndices[k]);
    if (mirrored) std::swap(corners[1], corners[2]);
    out.triangles.push_back(corners);
  }
}

void collectNode(const aiScene& scene, const aiNode& node, const NodeTransform& parent, Collected& out) {
  const NodeTransform to_root = child(parent, node.mTransformation);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) collectMesh(*scene.mMeshes[node.mMeshes[i]], to_root, out);
  for (unsigned i = 0; i < node.mNumChildren; ++i) collectNode(scene, *node.mChildren[i], to_root, out);
}

std::string oneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace

void checkMeshFile(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw LoadError(path + ": no such mesh file");
  if (!std::filesystem::is_regular_file(status))
    throw LoadError(path + ": not a file; a mesh file is needed");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw LoadError(path + ": the mesh file cannot be opened for reading; check its permissions");
  if (file.peek() == std::ifstream::traits_type::eof()) throw LoadError(path + ": the mesh file is empty");
}

TriangleMesh loadMesh(const std::string& path, const Vec3& scale, SolidChoice solid) {
  if (!scale.allFinite() || (scale.array() == 0.0).any()) {
    throw LoadError(path + ": mesh scale must be three finite numbers, none of them 0");
  }
  checkMeshFile(path);

  Assimp::Importer importer;
  // Without the first a Z_UP file comes out turned; dropping the root's transform instead would drop the unit
  // too.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  // Without the second a file with no geometry "loads" as a dummy the size of a point.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw LoadError(path + ": not a mesh that can be read (" + oneLine(importer.GetErrorString()) +
                    "); STL, OBJ and Collada files are known to work");
  }

  Collected collected;
  collectNode(*scene, *scene->mRootNode, {}, collected);
  if (collected.triangles.empty()) {
    throw LoadError(path + ": no triangle in the file; a mesh needs at least one");
  }
  for (Vec3& vertex : collected.vertices) vertex = vertex.cwiseProduct(scale);
  if (scale.prod() < 0.0) {  // mirrored: keep closed meshes facing outward
    for (auto& corners : collected.triangles) std::swap(corners[1], corners[2]);
  }
  try {
    TriangleMesh mesh =
        makeTriangleMesh(std::move(collected.vertices), std::move(collected.triangles), solid, path);
    // One coordinate's error in each of three axes, and the scale's own rounding in double.
    mesh.report.coordinate_rounding =
        std::sqrt(3.0) * collected.rounding * scale.cwiseAbs().maxCoeff() * (1.0 + 1e-9);
    return mesh;
  } catch (const std::invalid_argument& fault) {
    throw LoadError(fault.what());
  }
}

}  // namespace collision_node::geometry
