#!/usr/bin/python3
"""Random balls and points on pose streams of their own rates, jitter, delays and holes: every change of contact that
rational arithmetic finds must be in a bracket of the replay's, and nothing else may be there.

    balls.py path/to/replay FIRST_SEED COUNT [crowd]

`crowd` makes 60 or 100 of them, more than are watched pair by pair: who comes near whom is the broad phase's to find.

Between two stamps a centre moves on a straight line (PoseStamped) or on the cubic of its twists (Odometry, `hermite`), so
the squared distance of two centres is a polynomial with rational coefficients on each common piece; only its roots are
rounded, to 60 digits. Prints the seed of each fault.
"""

import bisect
import decimal
import sys
from fractions import Fraction
from math import comb

import rosbag
import rospy
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry

import seeds

decimal.getcontext().prec = 60
MAX_GAP_NS = 10**9  # the scene's default


class Ball:
    """A radius and poses [(stamp in ns, centre, quaternion, velocity in the world)]."""

    def __init__(self, rng, offset, room, start_ns, end_ns, fires):
        self.radius = rng.choice([0.0, 0.05, 0.3, 1.0])
        self.poses = []
        self.hermite = rng.random() < 0.4
        rests = rng.random() < 0.15
        rate = rng.choice([5, 10, 30, 100])
        centre = [offset[k] + rng.uniform(-room, room) for k in range(3)]
        velocity = [0.0 if rests else rng.gauss(0.0, rng.choice([1, 20, 200])) for _ in range(3)]
        stamp = start_ns + rng.randrange(3 * 10**8)
        while stamp < end_ns:
            # Halves make a rotation that permutes the axes: exact, so that the twist in the world is too.
            turn = [rng.choice([-0.5, 0.5]) if self.hermite else rng.gauss(0.0, 1.0) for _ in range(4)]
            length = sum(x * x for x in turn) ** 0.5
            self.poses.append((stamp, tuple(centre), tuple(x / length for x in turn), tuple(velocity)))
            step = 12 * 10**8 if rng.random() < 0.02 else int(1e9 / rate * rng.uniform(0.3, 1.7))
            stamp += step
            if fires and rng.random() < 0.05:  # what rested may fire, what flew may stop
                velocity = [rng.choice([0, 1]) * rng.gauss(0.0, rng.choice([1, 20, 200])) for _ in range(3)]
            for k in range(3):
                centre[k] += velocity[k] * step * 1e-9
                if abs(centre[k] - offset[k]) > room:  # back into the room
                    velocity[k] = -abs(velocity[k]) if centre[k] > offset[k] else abs(velocity[k])

    def runs(self):
        """Stretches of poses without a hole."""
        stretch = [self.poses[0]]
        for pose in self.poses[1:]:
            if pose[0] - stretch[-1][0] > MAX_GAP_NS:
                yield stretch
                stretch = []
            stretch.append(pose)
        yield stretch


def path(ball, stretch, begin_ns):
    """The centre as three polynomials in seconds from `begin_ns`, on the segment that begins there or holds it."""
    before, after = next(s for s in zip(stretch, stretch[1:]) if s[0][0] <= begin_ns < s[1][0])
    h, late = Fraction(after[0] - before[0], 10**9), Fraction(begin_ns - before[0], 10**9)
    axes = []
    for k in range(3):
        p, q = Fraction(before[1][k]), Fraction(after[1][k])
        mean = (q - p) / h
        first, last = (Fraction(before[3][k]), Fraction(after[3][k])) if ball.hermite else (mean, mean)
        c = [p, first, (3 * mean - 2 * first - last) / h, (first + last - 2 * mean) / h**2]
        axes.append([sum(c[n] * comb(n, m) * late**(n - m) for n in range(m, 4)) for m in range(4)])
    return axes


def box(ball, stretch, begin_ns):
    """(lower, upper) corner of a box that holds the centre on the segment that begins there or holds it, by its Bezier
    points, with a millimetre to spare."""
    i = bisect.bisect_right(stretch, begin_ns, key=lambda pose: pose[0]) - 1
    before, after = stretch[i], stretch[i + 1]
    points = [before[1], after[1]]
    if ball.hermite:
        third = (after[0] - before[0]) * 1e-9 / 3
        points += [[before[1][k] + third * before[3][k] for k in range(3)],
                   [after[1][k] - third * after[3][k] for k in range(3)]]
    return [min(p[k] for p in points) - 1e-3 for k in range(3)], [max(p[k] for p in points) + 1e-3 for k in range(3)]


def far(box_a, box_b, distance):
    return any(box_a[0][k] - box_b[1][k] > distance or box_b[0][k] - box_a[1][k] > distance for k in range(3))


def value(polynomial, x):
    result = decimal.Decimal(0)
    for c in reversed(polynomial):
        result = result * x + c
    return result


def roots(polynomial, end):
    """Where a polynomial changes its sign in (0, end], ascending: bisected between the roots of its derivative."""
    if len(polynomial) < 2:
        return []
    turns = roots([n * c for n, c in enumerate(polynomial)][1:], end)
    found = []
    for low, high in zip([decimal.Decimal(0)] + turns, turns + [end]):
        rises = value(polynomial, high) > 0
        if rises == (value(polynomial, low) > 0):
            continue
        for _ in range(170):
            middle = (low + high) / 2
            if (value(polynomial, middle) > 0) == rises:
                high = middle
            else:
                low = middle
        found.append(high)
    return found


def beyond(path_a, path_b, distance):
    """Squared distance of the centres minus the squared distance that touches, as a polynomial."""
    squared = [Fraction(0)] * 7
    squared[0] = -distance * distance
    for p, q in zip(path_a, path_b):
        apart = [y - x for x, y in zip(p, q)]
        for i, c in enumerate(apart):
            for j, d in enumerate(apart):
                squared[i + j] += c * d
    return squared


def stretch_changes(ball_a, ball_b, a, b, distance):
    """[(kind, time in ns)] on two stretches; a contact that the data leave open has kind OPEN, at their end."""
    start, end = max(a[0][0], b[0][0]), min(a[-1][0], b[-1][0])
    knots = sorted({pose[0] for pose in a + b if start <= pose[0] <= end})
    found, touching = [], None
    for begin, until in zip(knots, knots[1:]):
        if far(box(ball_a, a, begin), box(ball_b, b, begin), distance):
            assert not touching
            touching = False
            continue
        exact = beyond(path(ball_a, a, begin), path(ball_b, b, begin), distance)
        if touching is None:
            touching = exact[0] <= 0
            if touching:
                found.append(('INITIAL_OVERLAP', decimal.Decimal(begin)))
        rounded = [decimal.Decimal(c.numerator) / decimal.Decimal(c.denominator) for c in exact]
        for root in roots(rounded, decimal.Decimal(until - begin) / 10**9):
            touching = not touching
            found.append(('IMPACT' if touching else 'SEPARATION', begin + root * 10**9))
    return found + [('OPEN', decimal.Decimal(end))] if touching else found


def changes(a, b, contact_distance):
    distance = Fraction(a.radius) + Fraction(b.radius) + Fraction(contact_distance)
    return [change for run_a in a.runs() for run_b in b.runs()
            for change in stretch_changes(a, b, run_a, run_b, distance)]


def make_world(rng, crowd):
    start = 1700000000 * 10**9 + rng.randrange(10**9)
    offset = [rng.choice([0.0, 0.0, 5e6, 4.6e5]) for _ in range(3)]
    room, seconds = rng.choice([4, 8, 20] if crowd else [3, 6, 10]), rng.choice([1, 3])
    balls = {'ball_%02d' % i: Ball(rng, offset, room, start, start + seconds * 10**9, crowd)
             for i in range(rng.choice([60, 100] if crowd else [2, 3, 6, 12]))}
    return balls, rng.choice([0.0, 0.0, 0.1])


def to_child(q, v):
    """A vector of the world in the axes of a frame with quaternion q."""
    x, y, z, w = q
    return ((1 - 2 * (y * y + z * z)) * v[0] + 2 * (x * y + z * w) * v[1] + 2 * (x * z - y * w) * v[2],
            2 * (x * y - z * w) * v[0] + (1 - 2 * (x * x + z * z)) * v[1] + 2 * (y * z + x * w) * v[2],
            2 * (x * z + y * w) * v[0] + 2 * (y * z - x * w) * v[1] + (1 - 2 * (x * x + y * y)) * v[2])


def message_of(ball, stamp, centre, turn, velocity):
    message = Odometry() if ball.hermite else PoseStamped()
    message.header.frame_id = 'world'
    message.header.stamp = rospy.Time(stamp // 10**9, stamp % 10**9)
    pose = message.pose
    if ball.hermite:
        pose = message.pose.pose
        linear = message.twist.twist.linear
        linear.x, linear.y, linear.z = to_child(turn, velocity)
    pose.position.x, pose.position.y, pose.position.z = centre
    pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = turn
    return message


def write_bag(path, rng, balls):
    """Every pose arrives up to 50 ms late, so that streams mix and overtake themselves within `reorder`."""
    arrivals = sorted(((pose[0] + rng.randrange(5 * 10**7), name, message_of(ball, *pose))
                       for name, ball in balls.items() for pose in ball.poses), key=lambda arrival: arrival[:2])
    with rosbag.Bag(str(path), 'w') as bag:
        for received, name, message in arrivals:
            bag.write('/' + name, message, rospy.Time(received // 10**9, received % 10**9))


def scene_text(balls, contact_distance):
    lines = ['pairs: {contact_distance: %r}' % contact_distance, 'objects:']
    for name, ball in balls.items():
        shape = 'sphere: {radius: %r}' % ball.radius if ball.radius else 'point: {}'
        motion = 'hermite' if ball.hermite else 'slerp'
        lines.append('  %s: {%s, pose: {topic: %s}, motion: %s}' % (name, shape, name, motion))
    return '\n'.join(lines) + '\n'


def holds(event, change):
    """Whether this event is this change: an UNCERTIFIED end of contact stands where a hole begins."""
    lower = event['interval_start'] + decimal.Decimal(event['toi_lower']) * 10**9
    upper = event['interval_start'] + decimal.Decimal(event['toi_upper']) * 10**9
    if event['certificate'] == 'UNCERTIFIED':
        return change[0] == 'OPEN' and event['reason'] == 'GAP'
    return event['kind'] == change[0] and lower <= change[1] <= upper


def check(balls, contact_distance, events):
    """As seeds.main asks."""
    faults, held = [], 0
    names = sorted(balls)
    of_pair = {}
    for event in events:
        of_pair.setdefault((event['a']['object'], event['b']['object']), []).append(event)
    for i, name_a in enumerate(names):
        for name_b in names[i + 1:]:
            left = changes(balls[name_a], balls[name_b], contact_distance)
            for event in of_pair.pop((name_a, name_b), []):
                match = next((change for change in left if holds(event, change)), None)
                if match is not None:
                    left.remove(match)
                    held += event['certificate'] == 'CONFIRMED'
                elif event['certificate'] != 'POSSIBLE':
                    faults.append('nothing true in %s' % event)
            faults += ['%s and %s: no event for %s at %s' % (name_a, name_b, kind, when)
                       for kind, when in left if kind != 'OPEN']
    faults += ['an event of %s and %s' % pair for pair in of_pair]
    return faults, held, sum(event['certificate'] == 'POSSIBLE' for event in events)


def write_and_check(rng, folder):
    balls, contact_distance = make_world(rng, 'crowd' in sys.argv[4:])
    write_bag(folder / 'in.bag', rng, balls)
    (folder / 'scene.yaml').write_text(scene_text(balls, contact_distance), encoding='utf-8')
    return lambda events: check(balls, contact_distance, events)


if __name__ == '__main__':
    sys.exit(seeds.main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), write_and_check))
