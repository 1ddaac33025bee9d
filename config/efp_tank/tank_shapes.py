"""The tank of the demo: closed triangle meshes, their files, and the URDF that places them.

Axes: x forward, y left, z up, origin on the ground under the tank's middle; metres unless a name says mm.
"""

import math
import struct


def prism(profile, half_widths, slices):
    """A closed mesh: a convex outline in the x-z plane, spread over y in [-half_width, half_width] of each corner."""
    count = len(profile)
    rows = [[(x, w * (2.0 * j / slices - 1.0), z) for (x, z), w in zip(profile, half_widths)]
            for j in range(slices + 1)]
    triangles = []
    for low, high in zip(rows, rows[1:]):
        for i in range(count):
            k = (i + 1) % count
            triangles += [(low[i], high[i], high[k]), (low[i], high[k], low[k])]
    for i in range(1, count - 1):
        triangles += [(rows[0][0], rows[0][i], rows[0][i + 1]), (rows[-1][0], rows[-1][i + 1], rows[-1][i])]
    return outward(triangles)


def frustum(base, top, height):
    """A closed mesh: two outlines with equally many corners, joined by sloped sides."""
    low = [(x, y, 0) for x, y in base]
    high = [(x, y, height) for x, y in top]
    triangles = []
    for i in range(len(low)):
        k = (i + 1) % len(low)
        triangles += [(low[i], low[k], high[k]), (low[i], high[k], high[i])]
    for i in range(1, len(low) - 1):
        triangles += [(low[0], low[i + 1], low[i]), (high[0], high[i], high[i + 1])]
    return outward(triangles)


def outward(triangles):
    """The same triangles, all facing out: the enclosed volume comes out positive."""
    volume = sum(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
                 + a[2] * (b[0] * c[1] - b[1] * c[0]) for a, b, c in triangles)
    return triangles if volume > 0 else [(a, c, b) for a, b, c in triangles]


def hull():
    """Sloped glacis in front (x 1.7 to 3.0), belly narrower than the deck; 6.5 x 2.2 x 1.1 m."""
    profile = [(-3.1, 0.42), (-3.5, 0.88), (-3.42, 1.33), (-1.15, 1.49), (1.7, 1.45), (3.0, 0.62), (2.55, 0.40)]
    return prism(profile, [0.98, 1.10, 1.06, 1.06, 1.06, 1.02, 0.98], 6)


def track():
    """One track about its own middle: a belt with round ends, 5.8 x 0.55 x 0.95 m, drawn round y = 0."""
    radius, reach, steps = 0.475, 2.425, 12
    ends = [(+1, -0.5), (-1, 0.5)]
    profile = []
    for sign, start in ends:
        for i in range(steps + 1):
            angle = math.pi * (start + i / steps)
            profile.append((sign * reach + radius * math.cos(angle), radius * math.sin(angle)))
    return prism(profile, [0.275] * len(profile), 1)


def turret_mm():
    """Sloped sides all round, whole millimetres: every coordinate is exact in any reader's float."""
    base = [(1500, 480), (880, 1010), (-1040, 990), (-1620, 610), (-1620, -610), (-1040, -990), (880, -1010), (1500, -480)]
    top = [(1010, 300), (610, 720), (-980, 730), (-1410, 460), (-1410, -460), (-980, -730), (610, -720), (1010, -300)]
    return frustum(base, top, 790)


def write_stl(path, triangles):
    """Binary STL, float32, with true normals (rviz draws the stored ones)."""
    with open(path, 'wb') as out:
        out.write(b'collision_node demo'.ljust(80, b' '))
        out.write(struct.pack('<I', len(triangles)))
        for a, b, c in triangles:
            u, v = [[q - p for p, q in zip(a, other)] for other in (b, c)]
            n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            length = math.sqrt(sum(x * x for x in n))
            out.write(struct.pack('<12fH', *[x / length for x in n], *a, *b, *c, 0))


DAE = """<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>
    <created>2024-01-01T00:00:00</created>
    <modified>2024-01-01T00:00:00</modified>
    <unit name="millimeter" meter="0.001"/>
    <up_axis>Z_UP</up_axis>
  </asset>
  <library_geometries>
    <geometry id="turret" name="turret">
      <mesh>
        <source id="positions">
          <float_array id="positions-array" count="{values}">{positions}</float_array>
          <technique_common>
            <accessor source="#positions-array" count="{vertices}" stride="3">
              <param name="X" type="float"/>
              <param name="Y" type="float"/>
              <param name="Z" type="float"/>
            </accessor>
          </technique_common>
        </source>
        <vertices id="vertices">
          <input semantic="POSITION" source="#positions"/>
        </vertices>
        <triangles count="{triangles}">
          <input semantic="VERTEX" source="#vertices" offset="0"/>
          <p>{indices}</p>
        </triangles>
      </mesh>
    </geometry>
  </library_geometries>
  <library_visual_scenes>
    <visual_scene id="scene">
      <node id="node"><instance_geometry url="#turret"/></node>
    </visual_scene>
  </library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
"""


def write_dae(path, triangles):
    """Collada in whole millimetres; the file says <unit meter="0.001">."""
    vertices = sorted({corner for triangle in triangles for corner in triangle})
    index = {corner: i for i, corner in enumerate(vertices)}
    with open(path, 'w', encoding='utf-8') as out:
        out.write(DAE.format(
            values=3 * len(vertices), vertices=len(vertices), triangles=len(triangles),
            positions=' '.join('%d %d %d' % corner for corner in vertices),
            indices=' '.join(str(index[corner]) for triangle in triangles for corner in triangle)))


# link: (parent, joint type, joint origin, colour, [(geometry, origin xyz, origin rpy), ...])
MESH = '<mesh filename="package://collision_node/config/efp_tank/meshes/%s"/>'
LINKS = {
    'hull': (None, None, None, 'olive', [(MESH % 'hull.stl', '0 0 0', '0 0 0')]),
    'track_left': ('hull', 'fixed', '-0.3 1.45 0.475', 'steel', [(MESH % 'track.stl', '0 0 0', '0 0 0')]),
    'track_right': ('hull', 'fixed', '-0.3 -1.45 0.475', 'steel', [(MESH % 'track.stl', '0 0 0', '0 0 0')]),
    'turret': ('hull', 'revolute', '-0.3 0 1.46', 'olive',
               [(MESH % 'turret.dae', '0 0 0', '0 0 0'),
                ('<box size="0.72 0.66 0.2"/>', '-0.42 0.33 0.88', '0 0 0')]),
    'barrel': ('turret', 'fixed', '1.28 0 0.45', 'steel',
               [('<cylinder radius="0.06" length="2.6"/>', '1.3 0 0', '0 1.5707963267948966 0'),
                ('<cylinder radius="0.1" length="0.3"/>', '2.55 0 0', '0 1.5707963267948966 0')]),
    'stowage': ('turret', 'fixed', '-1.78 0 0.31', 'steel', [('<box size="0.42 1.3 0.36"/>', '0 0 0', '0 0 0')]),
}
COLOURS = {'olive': '0.36 0.40 0.22 1', 'steel': '0.30 0.31 0.33 1'}


def write_urdf(path):
    """The tank as URDF: root link hull, the turret on a revolute joint, everything else fixed."""
    lines = ['<?xml version="1.0"?>', '<!-- Written by make_demo.py. -->', '<robot name="tank">']
    lines += ['  <material name="%s"><color rgba="%s"/></material>' % item for item in COLOURS.items()]
    for name, (parent, joint, origin, colour, elements) in LINKS.items():
        lines.append('  <link name="%s">' % name)
        for geometry, xyz, rpy in elements:
            body = '<origin xyz="%s" rpy="%s"/><geometry>%s</geometry>' % (xyz, rpy, geometry)
            lines.append('    <collision>%s</collision>' % body)
            lines.append('    <visual>%s<material name="%s"/></visual>' % (body, colour))
        lines.append('  </link>')
        if parent:
            lines.append('  <joint name="%s_joint" type="%s">' % (name, joint))
            lines.append('    <parent link="%s"/><child link="%s"/>' % (parent, name))
            lines.append('    <origin xyz="%s" rpy="0 0 0"/>' % origin)
            if joint == 'revolute':
                lines.append('    <axis xyz="0 0 1"/>')
                lines.append('    <limit lower="-3.1" upper="3.1" effort="1" velocity="1"/>')
            lines.append('  </joint>')
    lines.append('</robot>')
    with open(path, 'w', encoding='utf-8') as out:
        out.write('\n'.join(lines) + '\n')


def write_tank(folder):
    """Writes meshes/hull.stl, meshes/track.stl, meshes/turret.dae and tank.urdf into `folder`."""
    (folder / 'meshes').mkdir(parents=True, exist_ok=True)
    write_stl(folder / 'meshes' / 'hull.stl', hull())
    write_stl(folder / 'meshes' / 'track.stl', track())
    write_dae(folder / 'meshes' / 'turret.dae', turret_mm())
    write_urdf(folder / 'tank.urdf')
