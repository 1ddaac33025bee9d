/// Mesh files as text, for tests.
#pragma once

#include <string>

namespace test_support {

/// A closed box from 0 to (x, y, z), outward, as OBJ with quads. Without `top` it is open.
inline std::string boxObj(double x, double y, double z, bool top = true) {
  std::string text;
  for (int i = 0; i < 8; ++i) {
    text += "v " + std::to_string(i & 1 ? x : 0.0) + " " + std::to_string(i & 2 ? y : 0.0) + " " +
            std::to_string(i & 4 ? z : 0.0) + "\n";
  }
  text += "f 1 3 4 2\nf 1 2 6 5\nf 2 4 8 6\nf 4 3 7 8\nf 3 1 5 7\n";
  if (top) text += "f 5 6 8 7\n";
  return text;
}

/// The tetrahedron (0,0,0) (1,0,0) (0,1,0) (0,0,1), outward, as text STL: every corner is written three
/// times.
inline std::string tetrahedronStl() {
  const char* corners[4] = {"0 0 0", "1 0 0", "0 1 0", "0 0 1"};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string text = "solid tetrahedron\n";
  for (const auto& face : faces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : face) text += std::string("vertex ") + corners[corner] + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid tetrahedron\n";
}

/// One triangle (0,0,0) (1000,0,0) (0,2000,3000) under a node moved by (100, 0, 0), as Collada.
inline std::string triangleCollada(const std::string& up_axis, const std::string& unit_meter,
                                   const std::string& node_transform = "<translate>100 0 0</translate>") {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="u" meter=")" +
         unit_meter + R"("/><up_axis>)" + up_axis + R"(</up_axis></asset>
  <library_geometries><geometry id="g" name="g"><mesh>
    <source id="p"><float_array id="pa" count="9">0 0 0 1000 0 0 0 2000 3000</float_array>
      <technique_common><accessor source="#pa" count="3" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s"><node id="n">)" +
         node_transform + R"(<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)";
}

}  // namespace test_support
