#!/usr/bin/python3
"""truth.json against the plain definition of touching, another way than it was computed: the distance of the shot's
centre from all triangles, a picosecond before and after each instant, in exact arithmetic.

    truth.py config/efp_tank
"""

import json
import pathlib
import sys
from fractions import Fraction

import rosbag

AROUND = Fraction(1, 1000)  # ns


def squared_distance(triangles, point):
    best = None
    for triangle in triangles:
        foot = nearest(triangle, point)
        square = dot(sub(point, foot), sub(point, foot))
        best = square if best is None or square < best else best
    return best


def inside(triangles, point):
    """Whether a ray from the point meets the closed mesh an odd number of times."""
    ray = tuple(Fraction(c) * 100 for c in (0.301, 0.517, 0.801))
    return sum(touching(triangle, point, ray, ZERO) is not None for triangle in triangles) % 2 == 1


def touches(link, point, radius):
    return any(squared_distance(triangles, point) <= radius * radius or inside(triangles, point)
               for _, triangles, _ in link.solids)


def main():
    folder = pathlib.Path(sys.argv[1])
    shots = json.loads((folder / 'truth.json').read_text(encoding='utf-8'))['shots']
    links = {link.name: link for link in read_urdf(folder / 'tank.urdf')}
    topics = {'tank': 'tank/pose', 'efp_1': 'efp_1/odom', 'efp_2': 'efp_2/pose'}
    with rosbag.Bag(str(folder / 'efp_tank.bag')) as bag:
        tracks = read_tracks(bag, topics)
    tank = tracks['tank']
    back = tuple(zip(*rotation(next(iter(tank.orientations)))))
    faults, checked = [], 0
    for shot in shots:
        for event in shot['events']:
            time_ns = event['ns'] + Fraction(event['fraction_ns'])
            found = []
            for t in (time_ns - AROUND, time_ns + AROUND):
                seen = sub(tracks[shot['object']].at(t), tank.at(t))
                found.append(touches(links[event['link']], tuple(dot(row, seen) for row in back), Fraction(shot['radius'])))
            if found != ([False, True] if event['kind'] == 'IMPACT' else [True, False]):
                faults.append('%s %s %s: touching before and after is %s' % (shot['object'], event['kind'], event['link'], found))
            checked += 1
    if checked < 8:
        faults.append('only %d instants in truth.json' % checked)
    print('\n'.join(faults) or '%d instants hold' % checked)
    return 1 if faults else 0


if __name__ == '__main__':
    sys.path.insert(0, sys.argv[1])
    from demo_files import read_tracks, read_urdf, rotation
    from line_and_triangle import ZERO, dot, nearest, sub, touching
    sys.exit(main())
