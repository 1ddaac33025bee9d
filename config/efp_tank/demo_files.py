"""Reads what the demo recorded, exactly: URDF, meshes and bag as fractions, as the package loads them."""

import math
import struct
import xml.etree.ElementTree as xml
from fractions import Fraction

from line_and_triangle import ZERO, add, scaled, sub

PACKAGE = 'package://collision_node/config/efp_tank/'


def exact(text):
    return tuple(Fraction(float(word)) for word in text.split())


def read_stl(path):
    data = path.read_bytes()
    count = struct.unpack_from('<I', data, 80)[0]
    rows = [struct.unpack_from('<9f', data, 84 + 50 * i + 12) for i in range(count)]
    return [tuple(tuple(map(Fraction, row[k:k + 3])) for k in (0, 3, 6)) for row in rows]


def read_dae(path):
    """The vertices are float32 and so is the unit: 0.001 is loaded as the nearest float32, 0.001000000047..."""
    space = '{http://www.collada.org/2005/11/COLLADASchema}'
    tree = xml.parse(path)
    unit = Fraction(struct.unpack('f', struct.pack('f', float(tree.find('.//%sunit' % space).get('meter'))))[0])
    numbers = [float(word) for word in tree.find('.//%sfloat_array' % space).text.split()]
    if [struct.unpack('f', struct.pack('f', n))[0] for n in numbers] != numbers:
        raise ValueError('%s: a coordinate is no float32, the reader would round it' % path)
    points = [scaled(tuple(map(Fraction, numbers[i:i + 3])), unit) for i in range(0, len(numbers), 3)]
    index = [int(word) for word in tree.find('.//%sp' % space).text.split()]
    return [tuple(points[k] for k in index[i:i + 3]) for i in range(0, len(index), 3)]


def box_triangles(size):
    """Twelve triangles of a box about the origin, facing out."""
    corners = [tuple(s * Fraction(1 if k >> axis & 1 else -1, 2) for axis, s in enumerate(size)) for k in range(8)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return [tuple(corners[k] for k in face) for a, b, c, d in faces for face in ((a, b, c), (a, c, d))]


class Link:
    """The collision elements of one link, in the object's frame."""

    def __init__(self, name, origin):
        self.name = name
        self.origin = origin   # of the link's frame; the demo's joints do not rotate
        self.solids = []       # (element index, triangles of a closed mesh, is it a mesh file)
        self.rods = []         # (start, end, radius): capsules that hold the cylinders; a shot must stay clear of them


def read_urdf(path):
    """Links of the demo's URDF. Rotated origins are understood for cylinders only."""
    tree = xml.parse(path).getroot()
    joints = {j.find('child').get('link'): j for j in tree.findall('joint')}

    def origin_of(name):
        if name not in joints:
            return (ZERO, ZERO, ZERO)
        place = joints[name].find('origin')
        if any(exact(place.get('rpy'))):
            raise ValueError('%s: joint to %s is rotated, this script expects rpy 0' % (path, name))
        return add(exact(place.get('xyz')), origin_of(joints[name].find('parent').get('link')))

    links = []
    for element in tree.findall('link'):
        link = Link(element.get('name'), origin_of(element.get('name')))
        for index, collision in enumerate(element.findall('collision')):
            place, shape = collision.find('origin'), collision.find('geometry')[0]
            offset = add(exact(place.get('xyz')), link.origin)
            if shape.tag == 'cylinder':
                _, pitch, _ = map(float, place.get('rpy').split())
                half = float(shape.get('length')) / 2
                reach = tuple(map(Fraction, (half * math.sin(pitch), 0.0, half * math.cos(pitch))))
                link.rods.append((sub(offset, reach), add(offset, reach), float(shape.get('radius'))))
                continue
            if any(exact(place.get('rpy'))):
                raise ValueError('%s: %s: a %s is rotated, this script expects rpy 0' % (path, link.name, shape.tag))
            if shape.tag == 'box':
                triangles = box_triangles(exact(shape.get('size')))
            else:
                file = path.parent / shape.get('filename').replace(PACKAGE, '')
                triangles = read_stl(file) if file.suffix == '.stl' else read_dae(file)
            moved = [tuple(add(corner, offset) for corner in triangle) for triangle in triangles]
            link.solids.append((index, moved, shape.tag == 'mesh'))
        links.append(link)
    return links


class Track:
    """Stamps [ns, integers] and positions [m, fractions] of one object."""

    def __init__(self):
        self.stamps, self.positions, self.orientations = [], [], set()

    def append(self, message):
        pose = message.pose.pose if hasattr(message.pose, 'pose') else message.pose
        self.stamps.append(message.header.stamp.secs * 10**9 + message.header.stamp.nsecs)
        self.positions.append(tuple(map(Fraction, (pose.position.x, pose.position.y, pose.position.z))))
        q = pose.orientation
        self.orientations.add((q.x, q.y, q.z, q.w))

    def at(self, time_ns):
        for i, (t0, t1) in enumerate(zip(self.stamps, self.stamps[1:])):
            if t0 <= time_ns <= t1:
                part = (time_ns - t0) / Fraction(t1 - t0)
                return add(self.positions[i], scaled(sub(self.positions[i + 1], self.positions[i]), part))
        raise ValueError('no pose at %s' % time_ns)


def read_tracks(bag, topics):
    """Tracks by object, from the object's pose topic."""
    tracks = {name: Track() for name in topics}
    names = {'/' + topic: name for name, topic in topics.items()}
    for topic, message, _ in bag.read_messages(topics=list(names)):
        tracks[names[topic]].append(message)
    for name, track in tracks.items():
        if track.stamps != sorted(set(track.stamps)):
            raise ValueError('%s: stamps are not in order' % name)
    return tracks


def rotation(quaternion):
    """The matrix of a quaternion that need not be unit; no square root is needed."""
    x, y, z, w = map(Fraction, quaternion)
    n = x * x + y * y + z * z + w * w
    return ((1 - 2 * (y * y + z * z) / n, 2 * (x * y - z * w) / n, 2 * (x * z + y * w) / n),
            (2 * (x * y + z * w) / n, 1 - 2 * (x * x + z * z) / n, 2 * (y * z - x * w) / n),
            (2 * (x * z - y * w) / n, 2 * (y * z + x * w) / n, 1 - 2 * (x * x + y * y) / n))
