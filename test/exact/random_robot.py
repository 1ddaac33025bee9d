"""Random robots: URDF trees whose links are boxes, spheres and mesh files (scaled, mirrored, written as STL, OBJ or DAE), each
with an origin of its own, and poses for them. The root has poses in the world, or rides on a carrier that turns, through
tf alone or by poses in the carrier's frame.
"""

import struct

import numpy as np

from turning_parts import Part, Robot, times


def matrix_of_rpy(roll, pitch, yaw):
    """Fixed axes: first about x, then about y, then about z."""
    def about(k, angle):
        m, i, j = np.eye(3), (k + 1) % 3, (k + 2) % 3
        m[i, i] = m[j, j] = np.cos(angle)
        m[j, i] = np.sin(angle)
        m[i, j] = -m[j, i]
        return m
    return about(2, yaw) @ about(1, pitch) @ about(0, roll)


def random_hull(rng):
    """(corners n x 3, triangles m x 3) of an octahedron whose corners were moved a little: still convex."""
    size = [rng.uniform(0.1, 0.6) for _ in range(3)]
    corners = [[sign * size[k] if i == k else 0.15 * rng.uniform(-1, 1) * size[i] for i in range(3)]
               for k in range(3) for sign in (1, -1)]
    triangles = [(x, y, z) if (x + y + z) % 2 == 0 else (y, x, z) for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    return np.array(corners, dtype=np.float32).astype(float), triangles


def write_mesh(path, corners, triangles):
    if path.suffix == '.stl':
        facets = b''.join(struct.pack('<12fH', 0, 0, 0, *corners[list(t)].ravel(), 0) for t in triangles)
        path.write_bytes(b'\0' * 80 + struct.pack('<I', len(triangles)) + facets)
    elif path.suffix == '.obj':
        path.write_text(''.join('v %.9g %.9g %.9g\n' % tuple(c) for c in corners)
                        + ''.join('f %d %d %d\n' % tuple(i + 1 for i in t) for t in triangles), encoding='ascii')
    else:
        path.write_text(DAE % (3 * len(corners), ' '.join('%.9g' % x for x in corners.ravel()), len(corners),
                               len(triangles), ' '.join(str(i) for t in triangles for i in t)), encoding='ascii')


DAE = '''<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="f" count="%d">%s</float_array><technique_common>
<accessor source="#f" count="%d" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="%d"><input semantic="VERTEX" source="#v" offset="0"/><p>%s</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
'''


def random_origin(rng, reach):
    """(XML, position, rotation matrix)."""
    xyz, rpy = [rng.uniform(-reach, reach) for _ in range(3)], [rng.uniform(-3, 3) for _ in range(3)]
    text = '<origin xyz="%r %r %r" rpy="%r %r %r"/>' % tuple(xyz + rpy)
    return text, np.array(xyz), matrix_of_rpy(*rpy)


def random_part(rng, folder, name):
    """(XML of the geometry, corners, triangles, radius) in the part's frame."""
    kind = rng.choice(['box', 'sphere', 'mesh', 'mesh'])
    if kind == 'sphere':
        radius = rng.uniform(0.05, 0.5)
        return '<sphere radius="%r"/>' % radius, np.zeros((1, 3)), [], radius
    if kind == 'box':
        size = [rng.uniform(0.05, 1.2) for _ in range(3)]
        corners = np.array([[(i - 0.5) * size[0], (j - 0.5) * size[1], (k - 0.5) * size[2]]
                            for i in (0, 1) for j in (0, 1) for k in (0, 1)])
        quads = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
        return ('<box size="%r %r %r"/>' % tuple(size), corners,
                [t for q in quads for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))], 0.0)
    corners, triangles = random_hull(rng)
    path = folder / (name + rng.choice(['.stl', '.obj', '.dae']))
    write_mesh(path, corners, triangles)
    scale = [rng.choice([1.0, 0.5, 1.75, -1.0]) for _ in range(3)]
    return ('<mesh filename="file://%s" scale="%r %r %r"/>' % tuple([path] + scale), corners * scale, triangles, 0.0)


def random_robot(rng, folder, name, offset, start, seconds):
    """The robot and the path of its URDF file."""
    links, frames, xml = {}, {}, ['<robot name="%s">' % name]
    for i in range(rng.choice([1, 2, 3])):
        link, parts = 'link_%d' % i, []
        at, turn = np.zeros(3), np.eye(3)
        if i > 0:
            parent = rng.choice(sorted(frames))
            text, move, rotate = random_origin(rng, 1.0)
            at, turn = frames[parent][0] + frames[parent][1] @ move, frames[parent][1] @ rotate
            xml.append('<joint name="to_%s" type="fixed"><parent link="%s"/><child link="%s"/>%s</joint>'
                       % (link, parent, link, text))
        frames[link] = at, turn
        xml.append('<link name="%s">' % link)
        for k in range(rng.choice([1, 1, 2])):
            text, move, rotate = random_origin(rng, 0.5)
            geometry, corners, triangles, radius = random_part(rng, folder, '%s_%d_%d' % (name, i, k))
            xml.append('<collision>%s<geometry>%s</geometry></collision>' % (text, geometry))
            parts.append(Part((corners @ rotate.T + move) @ turn.T + at, triangles, radius))
        xml.append('</link>')
        links[link] = parts
    path = folder / (name + '.urdf')
    path.write_text('\n'.join(xml + ['</robot>']), encoding='ascii')
    motion = rng.choice(['slerp', 'slerp', 'slerp', 'hermite', 'spin', 'ride', 'ride', 'ride'])
    if motion == 'ride':
        sent = [('carrier', random_poses(rng, start, seconds, offset, 2.0, 0.5)),
                (rng.choice(['pose', 'transform']), random_poses(rng, start, seconds, np.zeros(3), 0.7, 0.5))]
        return Robot(links, sent), path
    poses = random_poses(rng, start, seconds, offset, 2.5, 3.0)
    if motion != 'slerp':
        poses = with_twists(rng, poses, motion)
    return Robot(links, [('pose' if motion == 'slerp' else 'odometry', poses)], motion), path


def random_poses(rng, start, seconds, offset, room, turn):
    """Poses that stay within about `room` of `offset` and turn by about `turn` (any when 3 or more) between two."""
    poses, rate = [], rng.choice([5, 10, 30])
    stamp = start + rng.randrange(2 * 10**8)
    centre = np.array([rng.uniform(-room, room) for _ in range(3)])
    velocity = np.array([rng.gauss(0, rng.choice([2, 20])) for _ in range(3)])
    q = np.array([rng.gauss(0, 1) for _ in range(4)])
    while stamp < start + seconds * 10**9:
        q = q / np.linalg.norm(q)
        poses.append((stamp, tuple(offset + centre), tuple(q)))
        step = int(1e9 / rate * rng.uniform(0.5, 1.5))
        stamp += step
        centre = centre + velocity * step * 1e-9
        velocity = np.where(np.abs(centre) > room, -np.sign(centre) * np.abs(velocity), velocity)
        change = np.array([rng.gauss(0, 1) for _ in range(4)])
        q = change if turn >= 3 else q + change / np.linalg.norm(change) * turn / 2
    return poses


def with_twists(rng, poses, motion):
    """The same positions with velocities of their own, turning about one axis; for `spin` by up to some turns a step."""
    rate = np.array([rng.gauss(0, 100 if motion == 'spin' and rng.random() < 0.5 else 3) for _ in range(3)])
    found = []
    for stamp, position, _ in poses:
        half = np.linalg.norm(rate) * (stamp - poses[0][0]) * 1e-9 / 2
        turn = times(np.append(np.sin(half) * rate / np.linalg.norm(rate), np.cos(half)), np.array(poses[0][2]))
        found.append((stamp, position, turn, np.array([rng.gauss(0, 10) for _ in range(3)]), rate))
    return found
