#!/usr/bin/python3
"""Random robots of convex parts, turning on pose streams of their own rates, against an answer of its own (turning_parts.py):
every change of contact of two links must be in a bracket of the replay's, its ball must touch both, along its normal they must
meet, and nothing else may be there.

    robots.py path/to/replay FIRST_SEED COUNT

Prints the seed of each fault. An event of a contact too short for the answer is held to the distance at its own instant.
"""

import itertools
import sys

import numpy as np
import rosbag
import rospy
from geometry_msgs.msg import PoseStamped, TransformStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

import seeds
from random_robot import random_robot
from turning_parts import Part, changes, link_gap, matrix_of, parted, pieces

TIME_SLACK = 2e-11  # [s], of the answer's own rounding
LENGTH_SLACK = 1e-8  # [m], of the same at offsets of 5e5 m


def fill(fields, values):
    for name, number in zip('xyzw', values):
        setattr(fields, name, number)


def message_of(what, name, stamp, position, turn, linear=None, angular=None):
    """(topic, message)."""
    message = {'pose': PoseStamped, 'odometry': Odometry}.get(what, TransformStamped)()
    message.header.stamp = rospy.Time(stamp // 10**9, stamp % 10**9)
    if what in ('pose', 'odometry'):
        pose = message.pose if what == 'pose' else message.pose.pose
        fill(pose.position, position)
        fill(pose.orientation, turn)
        if what == 'odometry':
            to_child = matrix_of(turn).T
            fill(message.twist.twist.linear, to_child @ linear)
            fill(message.twist.twist.angular, to_child @ angular)
        return '/' + name, message
    message.child_frame_id = name if what == 'transform' else 'carrier_of_' + name
    fill(message.transform.translation, position)
    fill(message.transform.rotation, turn)
    return '/tf', message


def write_bag(path, rng, robots):
    arrivals = []
    for name, robot in robots.items():
        for i, (what, poses) in enumerate(robot.sent):
            for stamp, position, turn, *twist in poses:
                if rng.random() < 0.5:
                    turn = tuple(-x for x in turn)  # the same orientation
                topic, message = message_of(what, name, stamp, position, turn, *twist)
                message.header.frame_id = 'world' if i == 0 else 'carrier_of_' + name
                arrivals.append((stamp + rng.randrange(5 * 10**7), topic, len(arrivals),
                                 TFMessage([message]) if topic == '/tf' else message))
    with rosbag.Bag(str(path), 'w') as bag:
        for received, topic, _, message in sorted(arrivals, key=lambda arrival: arrival[:3]):
            bag.write(topic, message, rospy.Time(received // 10**9, received % 10**9))


def vector(fields):
    return np.array([fields[k] for k in 'xyz'])


def poses_at(a, b, event, seconds, origin):
    """Of both robots, so many seconds after the event's interval_start."""
    begin = max(x for x, _ in pieces(a, b) if x <= event['interval_start'])
    s = (event['interval_start'] - begin) * 1e-9 + seconds
    return a.piece(begin, origin).at(s), b.piece(begin, origin).at(s)


def contact_faults(a, b, event, origin):
    """What is wrong with the ball and the normal of an event, at the middle of its bracket."""
    poses = poses_at(a, b, event, (event['toi_lower'] + event['toi_upper']) / 2, origin)
    position, normal = vector(event['position']) - origin, vector(event['normal'])
    parts_a, parts_b = a.links[event['a']['link']], b.links[event['b']['link']]
    faults, still = [], (np.zeros(3), np.eye(3))
    for name, parts, (at, turn) in ((event['a']['object'], parts_a, poses[0]), (event['b']['object'], parts_b, poses[1])):
        point = Part(((position - at) @ turn)[None], [])
        off = min(parted(part, point, still, still)[0] for part in parts)
        if off > event['position_error'] + LENGTH_SLACK:
            faults.append('%g m beside %s' % (off, name))
    along = [((q.corners @ poses[1][1].T + poses[1][0]) @ normal).min() - q.radius
             - ((p.corners @ poses[0][1].T + poses[0][0]) @ normal).max() - p.radius
             for p in parts_a for q in parts_b if parted(p, q, *poses)[0] > -LENGTH_SLACK]
    allowed = LENGTH_SLACK + 2 * (a.reach + b.reach) * event['normal_error']
    if event['normal_error'] < 1 and max(along, default=-np.inf) < -allowed:
        faults.append('along the normal they overlap by %g m' % -max(along, default=-np.inf))
    return faults


def link_faults(a, b, link_a, link_b, events, origin):
    """(faults, how many confirmed events held a true change) of two links."""
    left, faults, held = changes(a, b, link_a, link_b, origin), [], 0
    for event in events:
        start, lower, upper = event['interval_start'], event['toi_lower'], event['toi_upper']
        match = next((change for change in left if change[0] == event['kind']
                      and lower - TIME_SLACK <= (change[1] - start) * 1e-9 + change[2] <= upper + TIME_SLACK), None)
        if match is not None:
            left.remove(match)
            held += event['certificate'] == 'CONFIRMED'
        elif event['certificate'] != 'POSSIBLE':
            gap = link_gap(a, b, link_a, link_b, *poses_at(a, b, event, upper, origin))
            if abs(gap) > LENGTH_SLACK:
                faults.append('%g m apart at %s' % (gap, event))
        if event['certificate'] == 'CONFIRMED' and event['kind'] != 'INITIAL_OVERLAP':
            faults += ['%s: %s' % (fault, event) for fault in contact_faults(a, b, event, origin)]
    return faults + ['no event for %s at %d ns + %.12f s' % change for change in left], held


def check(robots, events, origin):
    """As seeds.main asks. What rides strays from its line by a known bound, and who comes as near is possible too."""
    faults, held, of_links = [], 0, {}
    for event in events:
        of_links.setdefault(tuple(event[side][key] for side in 'ab' for key in ('object', 'link')), []).append(event)
    for name_a, name_b in itertools.combinations(sorted(robots), 2):
        a, b = robots[name_a], robots[name_b]
        for link_a, link_b in itertools.product(a.links, b.links):
            theirs = of_links.pop((name_a, link_a, name_b, link_b), [])
            found, good = link_faults(a, b, link_a, link_b, theirs, origin)
            faults += ['%s/%s and %s/%s: %s' % (name_a, link_a, name_b, link_b, fault) for fault in found]
            held += good
    possible = sum(event['certificate'] == 'POSSIBLE' and not any(robots[event[side]['object']].rides() for side in 'ab')
                   for event in events)
    return faults + ['an event of %s/%s and %s/%s' % links for links in of_links], held, possible


def write_and_check(rng, folder):
    start = 1700000000 * 10**9 + rng.randrange(10**9)
    offset = np.array([rng.choice([0.0, 4.6e5]) for _ in range(3)])
    robots, scene = {}, ['objects:']
    for i in range(rng.choice([2, 3])):
        name = 'robot_%d' % i
        robot, path = random_robot(rng, folder, name, offset, start, 1)
        source = 'tf' if robot.sent[-1][0] == 'transform' else 'topic'
        scene.append('  %s: {urdf: %s, pose: {%s: %s}, motion: %s}' % (name, path, source, name, robot.motion))
        robots[name] = robot
    write_bag(folder / 'in.bag', rng, robots)
    (folder / 'scene.yaml').write_text('\n'.join(scene) + '\n', encoding='ascii')
    return lambda events: check(robots, events, offset)


if __name__ == '__main__':
    sys.exit(seeds.main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), write_and_check))
