"""The true impacts of the demo in closed form, from the files alone: the bag's doubles and integer stamps, the
meshes' float32 vertices, the URDF's origins.

Shares nothing with the package's C++ code. Covers what the demo holds: a target that keeps its orientation, and shots
that are points or spheres. Between the stamps of either track everything moves straight, so a shot's centre, seen from
the target, runs along one straight line per piece. A closed mesh is a solid: its inside touches too.
"""

import json
import math
import pathlib
from fractions import Fraction

import rosbag
import yaml

from demo_files import read_tracks, read_urdf, rotation
from line_and_triangle import ZERO, add, dot, linear, near, nearest, root, scaled, sub, touching


class Line:
    """One piece: seen from the target the shot's centre runs straight from `start` by `way` in [begin, end] ns."""

    def __init__(self, begin, end, start, way):
        self.begin, self.end, self.start, self.way = begin, end, start, way

    def ns(self, t):
        return self.begin + t * (self.end - self.begin)

    def place(self, time_ns):
        return add(self.start, scaled(self.way, (time_ns - self.begin) / Fraction(self.end - self.begin)))


def relative_lines(target, shot, turn):
    begin, end = max(target.stamps[0], shot.stamps[0]), min(target.stamps[-1], shot.stamps[-1])
    cuts = sorted({t for t in target.stamps + shot.stamps if begin <= t <= end})
    back = tuple(zip(*turn))
    seen = [tuple(dot(row, sub(shot.at(t), target.at(t))) for row in back) for t in map(Fraction, cuts)]
    return [Line(t0, t1, a, sub(b, a)) for t0, t1, a, b in zip(cuts, cuts[1:], seen, seen[1:])]


def contacts(link, lines, radius):
    """Intervals of contact [(begin, end)] in ns, and the surface intervals (begin, end, element, triangle, corners)."""
    surface, spans = [], []
    for element, triangles, is_mesh in link.solids:
        crossings = []
        for index, triangle in enumerate(triangles):
            for line in lines:
                if not near(triangle, line.start, line.way, radius):
                    continue
                part = touching(triangle, line.start, line.way, radius)
                if part:
                    surface.append((line.ns(part[0]), line.ns(part[1]), element, index if is_mesh else -1, triangle))
                part = touching(triangle, line.start, line.way, ZERO)
                if part:
                    crossings.append(line.ns(part[0]))
        crossings.sort()
        if len(crossings) % 2 or len(set(crossings)) != len(crossings):
            raise ValueError('a shot meets %s exactly on an edge: aim elsewhere' % link.name)
        spans += zip(crossings[::2], crossings[1::2])  # the centre is inside between an odd crossing and the next
    spans = sorted(spans + [row[:2] for row in surface])
    merged = []
    for begin, end in spans:
        if merged and begin <= merged[-1][1]:
            merged[-1][1] = max(merged[-1][1], end)
        else:
            merged.append([begin, end])
    return merged, surface


def closest(line, distance):
    """Smallest value of `distance(point)`, convex, along the line; by golden section, in doubles."""
    lo, hi, golden = 0.0, 1.0, (math.sqrt(5.0) - 1.0) / 2.0
    start, way = tuple(map(float, line.start)), tuple(map(float, line.way))
    for _ in range(70):
        a, b = hi - golden * (hi - lo), lo + golden * (hi - lo)
        if distance(add(start, scaled(way, a))) < distance(add(start, scaled(way, b))):
            hi = b
        else:
            lo = a
    return distance(add(start, scaled(way, (lo + hi) / 2)))


def from_triangle(triangle):
    corners = tuple(tuple(map(float, corner)) for corner in triangle)
    return lambda p: math.dist(p, nearest(corners, p))


def from_rod(rod):
    a, b, radius = tuple(map(float, rod[0])), tuple(map(float, rod[1])), rod[2]
    edge = sub(b, a)
    return lambda p: math.dist(p, add(a, scaled(edge, min(max(dot(sub(p, a), edge) / dot(edge, edge), 0.0), 1.0)))) - radius


def nearby(lines):
    """The pieces that come within 8 m of the target's origin."""
    return [line for line in lines if near(((ZERO,) * 3,) * 3, line.start, line.way, Fraction(8))]


def clearance(links, lines, radius):
    """Smallest distance [m] between the target's solids and a shot that hits nothing."""
    return min(closest(line, from_triangle(triangle)) for line in nearby(lines) for link in links
               for _, triangles, _ in link.solids for triangle in triangles) - float(radius)


def rod_clearance(links, lines, radius):
    """Smallest distance [m] to the target's cylinders."""
    return min(closest(line, from_rod(rod)) for line in nearby(lines) for link in links
               for rod in link.rods) - float(radius)


def boxes_entered(links, lines):
    """Links whose axis-aligned bounding box the shot's centre goes through: what a box test would report."""
    entered = []
    for link in links:
        corners = [c for _, triangles, _ in link.solids for triangle in triangles for c in triangle]
        for a, b, r in link.rods:
            corners += [add(end, (s * Fraction(r),) * 3) for end in (a, b) for s in (-1, 1)]
        for line in lines:
            part = (ZERO, Fraction(1))
            for axis in range(3):
                low, high = min(c[axis] for c in corners), max(c[axis] for c in corners)
                part = part and linear(*part, line.start[axis] - low, line.way[axis])
                part = part and linear(*part, high - line.start[axis], -line.way[axis])
            if part and link.name not in entered:
                entered.append(link.name)
    return entered


def decimal(value, digits):
    """A fraction rounded to `digits` behind the point, as text."""
    whole = round(value * 10**digits)
    text = str(abs(whole)).rjust(digits + 1, '0')
    return ('-' if whole < 0 else '') + text[:-digits] + '.' + text[-digits:]


def zone_of(zones, link, point):
    for name, zone in sorted(zones.items()):
        inside = all(abs(p - Fraction(c)) <= Fraction(s) / 2 for p, c, s in
                     zip(point, zone['box']['position'], zone['box']['size']))
        if zone['link'] == link.name and inside:
            return name
    return ''


def event(kind, time_ns, link, rows, line, target, turn, zones):
    """One change of contact. Times are split into whole ns and a fraction with 25 digits."""
    side = 0 if kind == 'IMPACT' else 1
    rows = [row for row in rows if abs(row[side] - time_ns) < Fraction(1, 10**30)]
    spot = nearest(rows[0][4], line.place(time_ns))
    world = add(target.at(time_ns), tuple(dot(row, spot) for row in turn))
    local = sub(spot, link.origin)
    return {'kind': kind, 'link': link.name, 'zone': zone_of(zones, link, local), 'ns': math.floor(time_ns),
            'fraction_ns': decimal(time_ns - math.floor(time_ns), 25), 'position': [decimal(p, 25) for p in world],
            'point': [decimal(p, 25) for p in local], 'shape': rows[0][2], 'triangles': sorted(row[3] for row in rows)}


def shot_truth(name, scene_object, target, shot, links, zones):
    turn = rotation(next(iter(target.orientations)))
    lines = relative_lines(target, shot, turn)
    kind = next(k for k in ('point', 'sphere', 'cylinder') if k in scene_object)
    size = scene_object[kind]
    radius = Fraction(size.get('radius', 0.0))
    if kind == 'cylinder':  # its bounding sphere must miss; then so does it
        radius = root(radius * radius + (Fraction(size['length']) / 2)**2)
    events = []
    for link in links:
        spans, surface = contacts(link, lines, radius)
        for begin, end in spans:
            if any(begin <= stamp <= end for stamp in target.stamps + shot.stamps):
                raise ValueError('%s: a stamp shows its contact with %s' % (name, link.name))
            for change, time_ns in (('IMPACT', begin), ('SEPARATION', end)):
                line = next(l for l in lines if l.begin < time_ns <= l.end)
                events.append((time_ns, event(change, time_ns, link, surface, line, target, turn, zones)))
    events.sort(key=lambda row: row[0])
    if events and kind == 'cylinder':
        raise ValueError('%s: no closed form for a cylinder that hits' % name)
    rods = rod_clearance(links, lines, radius)
    if rods < 0.02:
        raise ValueError('%s: comes within %.3f m of a cylinder, no closed form for that' % (name, rods))
    speed = math.sqrt(float(dot(sub(shot.positions[1], shot.positions[0]), sub(shot.positions[1], shot.positions[0]))))
    return {'object': name, 'target': 'tank', 'shape': kind, 'radius': float(size.get('radius', 0.0)),
            'poses': len(shot.stamps), 'metres_between_first_poses': round(speed, 3),
            'bounding_boxes_entered': boxes_entered(links, lines),
            'clearance_m': None if events else round(min(rods, clearance(links, lines, radius)), 3),
            'events': [row for _, row in events]}


def write(path, folder):
    """Writes truth.json for the demo in `folder`; raises ValueError when the demo has left what is covered."""
    folder = pathlib.Path(folder)
    scene = yaml.safe_load((folder / 'scene.yaml').read_text(encoding='utf-8'))
    objects = scene['objects']
    topics = {name: value['pose']['topic'] for name, value in objects.items() if 'topic' in value['pose']}
    with rosbag.Bag(str(folder / 'efp_tank.bag')) as bag:
        tracks = read_tracks(bag, topics)
    target = tracks.pop('tank')
    if len(target.orientations) != 1:
        raise ValueError('the tank turns, this script expects a constant orientation')
    links = read_urdf(folder / 'tank.urdf')
    zones = objects['tank']['zones']
    shots = [shot_truth(name, objects[name], target, track, links, zones) for name, track in sorted(tracks.items())]
    about = ('true changes of contact of the demo, exact for the recorded doubles; time = ns + fraction_ns '
             '[ns since 1970], position in the world [m], point in the link frame [m]')
    pathlib.Path(path).write_text(json.dumps({'about': about, 'shots': shots}, indent=1) + '\n', encoding='utf-8')
