#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>

#include "collision_node/geometry/mesh_file.h"
#include "test/support/mesh_texts.h"
#include "test/support/temp_folder.h"

namespace collision_node::geometry {
namespace {

using test_support::boxObj;
using test_support::tetrahedronStl;
using test_support::triangleCollada;

class MeshFile : public ::testing::Test {
 protected:
  TriangleMesh load(const std::string& name, const std::string& text, const Vec3& scale = Vec3::Ones(),
                    SolidChoice solid = SolidChoice::kAuto) {
    return loadMesh(folder_.write(name, text), scale, solid);
  }

  std::string refusal(const std::string& name, const std::string& text,
                      SolidChoice solid = SolidChoice::kAuto) {
    try {
      load(name, text, Vec3::Ones(), solid);
    } catch (const LoadError& error) {
      return error.what();
    }
    return "accepted";
  }

  test_support::TempFolder folder_;
};

#define EXPECT_HAS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "no \"" << (part) << "\" in:\n" << (text)

/// Six times the signed volume of a closed mesh: positive when it faces outward.
double signedVolume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    sum += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
  }
  return sum;
}

TEST_F(MeshFile, TextStlIsWeldedAndClosed) {
  const TriangleMesh mesh = load("t.stl", tetrahedronStl());
  EXPECT_EQ(mesh.report.vertices, 4u);
  EXPECT_EQ(mesh.report.triangles, 4u);
  EXPECT_TRUE(mesh.solid);
  EXPECT_GT(signedVolume(mesh), 0.0);
}

TEST_F(MeshFile, QuadsOfAnObjBecomeTriangles) {
  const TriangleMesh mesh = load("box.obj", boxObj(1, 2, 3));
  EXPECT_EQ(mesh.report.vertices, 8u);
  EXPECT_EQ(mesh.report.triangles, 12u);
  EXPECT_TRUE(mesh.solid);
  EXPECT_EQ(mesh.report.upper, Vec3(1, 2, 3));
  EXPECT_DOUBLE_EQ(signedVolume(mesh), 36.0);
}

TEST_F(MeshFile, ScaleAppliesInDoubleAndMirroringKeepsTheMeshOutward) {
  const TriangleMesh mesh = load("box.obj", boxObj(1, 2, 3), Vec3(-0.1, 1, 2));
  EXPECT_TRUE(mesh.solid);
  EXPECT_EQ(mesh.report.lower, Vec3(-0.1, 0, 0));
  EXPECT_EQ(mesh.report.upper, Vec3(0, 2, 6));
  EXPECT_NEAR(signedVolume(mesh), 6 * 0.1 * 2 * 6, 1e-12);
  EXPECT_GT(signedVolume(load("box.obj", boxObj(1, 2, 3), Vec3(-1, -1, 1))), 0.0);
  EXPECT_GT(signedVolume(load("box.obj", boxObj(1, 2, 3), Vec3(-1, -1, -1))), 0.0);
}

TEST_F(MeshFile, OpenMeshIsASurfaceAndNoSolid) {
  const TriangleMesh mesh = load("open.obj", boxObj(1, 1, 1, false));
  EXPECT_FALSE(mesh.solid);
  EXPECT_EQ(mesh.report.open_edges, 4u);
  EXPECT_HAS(refusal("open.obj", boxObj(1, 1, 1, false), SolidChoice::kYes),
             "open.obj: solid: yes, but the mesh is not closed: 4 open edges");
}

TEST_F(MeshFile, ColladaKeepsItsAxesAndAppliesItsUnitAndNodes) {
  for (const char* up : {"Z_UP", "Y_UP"}) {
    const TriangleMesh mesh = load("t.dae", triangleCollada(up, "0.001"));
    ASSERT_EQ(mesh.triangles.size(), 1u) << up;
    const double tolerance = mesh.report.coordinate_rounding;
    EXPECT_LT(tolerance, 4e-6) << up;
    EXPECT_LT((mesh.report.lower - Vec3(0.1, 0, 0)).norm(), tolerance) << up;
    EXPECT_LT((mesh.report.upper - Vec3(1.1, 2, 3)).norm(), tolerance) << up;
  }
  EXPECT_EQ(load("t.dae", triangleCollada("Z_UP", "1")).report.upper, Vec3(1100, 2000, 3000));
}

TEST_F(MeshFile, MirroringNodeTurnsTheTriangle) {
  const TriangleMesh plain = load("t.dae", triangleCollada("Z_UP", "1", ""));
  const TriangleMesh mirrored = load("t.dae", triangleCollada("Z_UP", "1", "<scale>1 1 -1</scale>"));
  EXPECT_EQ(mirrored.report.lower.z(), -3000.0);
  const auto normal = [](const TriangleMesh& m) {
    const auto& t = m.triangles[0];
    return (m.vertices[t[1]] - m.vertices[t[0]]).cross(m.vertices[t[2]] - m.vertices[t[0]]).eval();
  };
  // A mirror image of an outward normal: the plain one with z turned.
  EXPECT_EQ(normal(mirrored), normal(plain).cwiseProduct(Vec3(1, 1, -1)));
}

TEST_F(MeshFile, CoordinateRoundingBoundsWhatTheReaderLost) {
  const unsigned seed = 99;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1), exponent(-6, 6);
  for (int i = 0; i < 200; ++i) {
    std::string text;
    std::vector<Vec3> truth;
    for (int k = 0; k < 3; ++k) {
      text += "v";
      Vec3 v;
      for (int axis = 0; axis < 3; ++axis) {
        char number[64];
        std::snprintf(number, sizeof number, i % 2 ? "%.9f" : "%.12e",
                      uniform(random) * std::pow(10, exponent(random)));
        v[axis] = std::strtod(number, nullptr);
        text += std::string(" ") + number;
      }
      truth.push_back(v);
      text += "\n";
    }
    const TriangleMesh mesh = load("r.obj", text + "f 1 2 3\n", Vec3(2, -3, 0.5));
    ASSERT_GT(mesh.report.coordinate_rounding, 0.0);
    for (const Vec3& v : mesh.vertices) {
      double nearest = HUGE_VAL;
      for (const Vec3& t : truth) nearest = std::min(nearest, (t.cwiseProduct(Vec3(2, -3, 0.5)) - v).norm());
      EXPECT_LE(nearest, mesh.report.coordinate_rounding) << "mesh " << i;
    }
  }
}

TEST_F(MeshFile, limit_AFileOfFarCoordinatesKeepsSevenDigits) {
  // A metre wide, a kilometre away: the reader's float32 moves its corners by up to 31 micrometres, and says
  // so.
  const std::string far = "v 1000.00001 0 0\nv 1001.00001 0 0\nv 1000.00001 1 0\nf 1 2 3\n";
  const TriangleMesh mesh = load("far.obj", far);
  double moved = 0.0;
  for (const Vec3& v : mesh.vertices)
    moved = std::max(moved, std::min(std::abs(v.x() - 1000.00001), std::abs(v.x() - 1001.00001)));
  EXPECT_GT(moved, 5e-6);
  EXPECT_LE(moved, mesh.report.coordinate_rounding);
  EXPECT_LT(mesh.report.coordinate_rounding, 5e-4);
}

TEST_F(MeshFile, BadFilesGetOneClearLine) {
  const std::string absent = [&] {
    try {
      loadMesh(folder_.path() + "/absent.stl", Vec3::Ones(), SolidChoice::kAuto);
    } catch (const LoadError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  }();
  EXPECT_HAS(absent, "/absent.stl: no such mesh file");
  EXPECT_HAS(refusal("empty.stl", ""), "/empty.stl: the mesh file is empty");
  EXPECT_HAS(refusal("noise.stl", "this is no mesh\n"), "/noise.stl: ");
  EXPECT_HAS(refusal("odd.xyz123", "1 2 3"), "/odd.xyz123: not a mesh that can be read");
  EXPECT_HAS(refusal("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), "not finite");
  EXPECT_HAS(refusal("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"), "no triangle");
  const std::string hollow =
      "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
      "version=\"1.4.1\"><asset><up_axis>Z_UP</up_axis></asset><library_visual_scenes>"
      "<visual_scene id=\"s\"><node id=\"n\"/></visual_scene></library_visual_scenes>"
      "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
  EXPECT_HAS(refusal("hollow.dae", hollow), "/hollow.dae: ");
  EXPECT_THROW(loadMesh(folder_.path(), Vec3::Ones(), SolidChoice::kAuto), LoadError);
  EXPECT_THROW(load("t.stl", tetrahedronStl(), Vec3(1, 0, 1)), LoadError);
}

}  // namespace
}  // namespace collision_node::geometry
