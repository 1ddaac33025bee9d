"""An independent slow answer for a recorded robot (a box) among fixed obstacles: sampling and bisection, in doubles.

Shares nothing with the package. Between two stamps the robot's centre moves straight and its orientation by shortest-arc
slerp. Every segment near an obstacle is sampled each millisecond of data time, each change of sign is bisected.
"""

import math

STEP = 1e-3  # [s]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def turned(q, v):
    """v turned by the unit quaternion q = (x, y, z, w)."""
    t = tuple(2.0 * c for c in cross(q[:3], v))
    u = cross(q[:3], t)
    return tuple(v[i] + q[3] * t[i] + u[i] for i in range(3))


def back(q, v):
    return turned((-q[0], -q[1], -q[2], q[3]), v)


def slerp(p, q, part):
    if sum(a * b for a, b in zip(p, q)) < 0.0:
        q = tuple(-c for c in q)
    angle = 2.0 * math.atan2(math.dist(p, q), math.dist(p, tuple(-c for c in q)))
    if angle < 1e-9:
        mixed = tuple(a + part * (b - a) for a, b in zip(p, q))
    else:
        s = math.sin(angle)
        mixed = tuple((math.sin((1.0 - part) * angle) * a + math.sin(part * angle) * b) / s for a, b in zip(p, q))
    length = math.sqrt(sum(c * c for c in mixed))
    return tuple(c / length for c in mixed)


class Segment:
    """Two consecutive poses: stamps [ns], positions relative to a near origin [m], quaternions."""

    def __init__(self, first, second):
        self.start_ns, self.end_ns = first[0], second[0]
        self.seconds = (second[0] - first[0]) * 1e-9
        self.p, self.q = (first[1], second[1]), (first[2], second[2])

    def at(self, s, origin):
        """Position minus `origin` and orientation at s seconds; subtracts before it interpolates."""
        part = s / self.seconds
        start = tuple(a - o for a, o in zip(self.p[0], origin))
        way = tuple(b - a for a, b in zip(*self.p))
        return tuple(a + part * w for a, w in zip(start, way)), slerp(self.q[0], self.q[1], part)


def outside(v, half):
    """Signed distance of a point from a box about the origin."""
    d = [abs(c) - h for c, h in zip(v, half)]
    far = math.sqrt(sum(max(c, 0.0)**2 for c in d))
    return far if far > 0.0 else max(d)


def ball_gap(half, radius):
    """Signed distance between the robot's box and a ball; the ball's centre is the origin."""
    return lambda p, q: outside(back(q, tuple(-c for c in p)), half) - radius


def post_gap(half, radius):
    """Robot and an upright post, both level and at the same height: the same in the plane."""
    def gap(p, q):
        x, y, _ = back(q, (-p[0], -p[1], 0.0))
        return outside((x, y, 0.0), (half[0], half[1], 1.0)) - radius
    return gap


def box_gap(half, other, turn):
    """Largest gap along the four face axes of two upright boxes in the plane; its sign says apart or touching."""
    def gap(p, q):
        best = -math.inf
        axes = [turned(q, (1.0, 0.0, 0.0)), turned(q, (0.0, 1.0, 0.0)),
                turned(turn, (1.0, 0.0, 0.0)), turned(turn, (0.0, 1.0, 0.0))]
        for axis in axes:
            reach = 0.0
            for i in range(2):
                reach += half[i] * abs(sum(a * b for a, b in zip(axis, axes[i])))
                reach += other[i] * abs(sum(a * b for a, b in zip(axis, axes[2 + i])))
            best = max(best, abs(sum(a * b for a, b in zip(axis, p))) - reach)
        return best
    return gap


def gap_function(robot_size, obstacle):
    """(gap(p, q), reach of both [m]) for one obstacle of the scene file."""
    half = [s / 2 for s in robot_size]
    reach = math.sqrt(sum(h * h for h in half))
    if 'sphere' in obstacle:
        radius = obstacle['sphere']['radius']
        return ball_gap(half, radius), reach + radius
    for kind in ('cylinder', 'capsule'):
        if kind in obstacle:
            radius = obstacle[kind]['radius']
            return post_gap(half, radius), reach + radius + obstacle[kind]['length']
    other = [s / 2 for s in obstacle['box']['size']]
    return box_gap(half, other, obstacle['pose']['fixed']['orientation']), reach + math.sqrt(sum(h * h for h in other))


def changes(segments, gap, reach, origin):
    """[(kind, segment, seconds from its start)] of one obstacle; kind IMPACT, SEPARATION."""
    result = []
    for segment in segments:
        middle, _ = segment.at(segment.seconds / 2, origin)
        if math.sqrt(sum(c * c for c in middle)) > reach + math.dist(*segment.p) + 0.01:
            continue
        count = max(1, round(segment.seconds / STEP))
        times = [segment.seconds * k / count for k in range(count + 1)]
        values = [gap(*segment.at(s, origin)) for s in times]
        for (s0, g0), (s1, g1) in zip(zip(times, values), list(zip(times, values))[1:]):
            if (g0 > 0.0) == (g1 > 0.0):
                continue
            lo, hi = s0, s1
            for _ in range(60):
                half = (lo + hi) / 2
                lo, hi = (half, hi) if (gap(*segment.at(half, origin)) > 0.0) == (g0 > 0.0) else (lo, half)
            result.append(('IMPACT' if g0 > 0.0 else 'SEPARATION', segment, (lo + hi) / 2))
    return result
