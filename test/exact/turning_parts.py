"""Convex parts that move straight and turn along the shortest arc between poses: when two of them touch, by an answer of its
own in doubles.

Two convex parts are apart exactly when a direction parts them that belongs to a face of one, an edge of each, or (of a
ball) a face, edge or vertex. A walk in steps that no contact can begin and end in, then bisection, finds the changes to some
1e-12 s; a contact that lasts less than FLOOR may be stepped over.
"""

import itertools

import numpy as np

FLOOR = 2e-7  # [s]


def times(p, q):
    """Product of two quaternions (x, y, z, w)."""
    return np.append(p[3] * q[:3] + q[3] * p[:3] + np.cross(p[:3], q[:3]), p[3] * q[3] - p[:3] @ q[:3])


def matrix_of(q):
    x, y, z, w = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


class Part:
    """Convex hull of `corners` (n x 3, frame of the robot), grown by `radius`."""

    def __init__(self, corners, triangles, radius=0.0):
        self.corners, self.radius = corners, radius
        self.normals, self.edges, self.starts = np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3))
        if len(corners) > 1:
            faces = corners[triangles]
            normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
            outward = np.sign(np.sum(normals * (faces[:, 0] - corners.mean(axis=0)), axis=1))
            self.normals = normals * (outward / np.linalg.norm(normals, axis=1))[:, None]
            pairs = sorted({tuple(sorted(e)) for t in triangles for e in itertools.combinations(t, 2)})
            self.starts = corners[[i for i, _ in pairs]]
            edges = corners[[j for _, j in pairs]] - self.starts
            self.edges = edges / np.linalg.norm(edges, axis=1)[:, None]


def parted(a, b, pose_a, pose_b):
    """The most that one of the deciding directions parts two parts by, and that direction, from a to b: [m]."""
    (at_a, turn_a), (at_b, turn_b) = pose_a, pose_b
    corners_a, corners_b = a.corners @ turn_a.T + at_a, b.corners @ turn_b.T + at_b
    directions = [a.normals @ turn_a.T, -b.normals @ turn_b.T]
    if len(a.corners) == 1 or len(b.corners) == 1:
        to_b = (corners_b[None, :] - corners_a[:, None]).reshape(-1, 3)
        directions.append(to_b)
        for part, turn, at, point, sign in ((a, turn_a, at_a, corners_b[0], 1), (b, turn_b, at_b, corners_a[0], -1)):
            along, off = part.edges @ turn.T, point - (part.starts @ turn.T + at)
            directions.append(sign * (off - along * np.sum(along * off, axis=1)[:, None]))
    else:
        crosses = np.cross((a.edges @ turn_a.T)[:, None], (b.edges @ turn_b.T)[None]).reshape(-1, 3)
        directions += [crosses, -crosses]
    directions = np.concatenate(directions)
    lengths = np.linalg.norm(directions, axis=1)
    directions = directions[lengths > 1e-9] / lengths[lengths > 1e-9][:, None]
    if len(directions) == 0:
        return -a.radius - b.radius, np.zeros(3)
    gaps = (directions @ corners_b.T).min(axis=1) - (directions @ corners_a.T).max(axis=1)
    best = int(np.argmax(gaps))
    return gaps[best] - a.radius - b.radius, directions[best]


class Robot:
    """`links`: name -> parts in the robot's frame. `sent`: what is sent, [(what, poses)]; a pose is (stamp in ns, position,
    quaternion) and, of an `odometry`, its linear and angular velocity in the world. `motion`: slerp, hermite or spin."""

    def __init__(self, links, sent, motion='slerp'):
        self.links, self.sent, self.motion = links, sent, motion
        self.poses = composed(sent[0][1], sent[1][1]) if self.rides() else sent[0][1]
        self.balls = {}
        for name, parts in links.items():
            corners = np.concatenate([p.corners for p in parts])
            centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
            self.balls[name] = centre, max(np.linalg.norm(p.corners - centre, axis=1).max() + p.radius for p in parts)
        self.reach = max(np.linalg.norm(p.corners, axis=1).max() + p.radius for parts in links.values() for p in parts)

    def rides(self):
        return len(self.sent) > 1

    def piece(self, begin, origin):
        return Piece(self.poses, begin, origin, self.motion)


class Piece:
    """What has `poses` between two of their stamps; positions are relative to `origin`, times in s after `begin`."""

    def __init__(self, poses, begin, origin, motion='slerp'):
        before, after = next(s for s in zip(poses, poses[1:]) if s[0][0] <= begin < s[1][0])
        self.late, seconds = (begin - before[0]) * 1e-9, (after[0] - before[0]) * 1e-9
        way, self.turn = np.array(after[1]) - np.array(before[1]), np.array(before[2])
        ends = [before[3], after[3]] if motion == 'hermite' else [way / seconds] * 2
        # Bezier's middle points keep the velocities at both ends.
        points = [np.zeros(3), ends[0] * seconds / 3, way - ends[1] * seconds / 3, way]
        self.speed = 3 * max(np.linalg.norm(q - p) for p, q in zip(points, points[1:])) / seconds
        self.cubic = [np.array(before[1]) - origin, ends[0], (3 * way / seconds - 2 * ends[0] - ends[1]) / seconds,
                      (ends[0] + ends[1] - 2 * way / seconds) / seconds**2]
        arc = times(np.array(after[2]), self.turn * (-1, -1, -1, 1))
        arc = arc if arc[3] >= 0 else -arc
        sine = np.linalg.norm(arc[:3])
        self.axis = arc[:3] / sine if sine > 0 else np.zeros(3)
        angle = 2 * np.arctan2(sine, arc[3])
        if motion == 'spin':
            meant = (before[4] + after[4]) / 2 @ self.axis * seconds
            angle += 2 * np.pi * np.round((meant - angle) / (2 * np.pi))
        self.spin = angle / seconds

    def pose(self, s):
        """(position, quaternion)."""
        s = s + self.late
        arc = np.append(np.sin(self.spin * s / 2) * self.axis, np.cos(self.spin * s / 2))
        return self.cubic[0] + s * (self.cubic[1] + s * (self.cubic[2] + s * self.cubic[3])), times(arc, self.turn)

    def at(self, s):
        """(position, matrix)."""
        position, turn = self.pose(s)
        return position, matrix_of(turn)


def composed(outer, inner):
    """Poses of what has `inner` poses in a frame that has `outer` ones: at each stamp of either."""
    found, zero = [], np.zeros(3)
    first, last = max(outer[0][0], inner[0][0]), min(outer[-1][0], inner[-1][0])
    for stamp in sorted({pose[0] for pose in outer + inner if first <= pose[0] <= last}):
        (at, turn), (way, arc) = (next(((np.array(p[1]), np.array(p[2])) for p in poses if p[0] == stamp), None)
                                  or Piece(poses, stamp, zero).pose(0.0) for poses in (outer, inner))
        found.append((stamp, at + matrix_of(turn) @ way, times(turn, arc)))
    return found


def link_gap(a, b, link_a, link_b, pose_a, pose_b):
    """Negative where two links touch; else no more than their distance."""
    (centre_a, radius_a), (centre_b, radius_b) = a.balls[link_a], b.balls[link_b]
    off = np.linalg.norm(pose_b[0] + pose_b[1] @ centre_b - pose_a[0] - pose_a[1] @ centre_a) - radius_a - radius_b
    if off > 0:
        return off
    return min(parted(p, q, pose_a, pose_b)[0] for p in a.links[link_a] for q in b.links[link_b])


def pieces(a, b):
    """(begin, end) in ns of the stretches on which both robots are between two of their stamps."""
    start, end = max(a.poses[0][0], b.poses[0][0]), min(a.poses[-1][0], b.poses[-1][0])
    knots = sorted({pose[0] for pose in a.poses + b.poses if start <= pose[0] <= end})
    return list(zip(knots, knots[1:]))


def changes(a, b, link_a, link_b, origin):
    """[(kind, piece's begin in ns, seconds after it)]."""
    found, touching = [], None
    for begin, end in pieces(a, b):
        path_a, path_b, length = a.piece(begin, origin), b.piece(begin, origin), (end - begin) * 1e-9
        fastest = (path_a.speed + path_b.speed + abs(path_a.spin) * a.reach + abs(path_b.spin) * b.reach + 1e-9)

        def gap(s):
            return link_gap(a, b, link_a, link_b, path_a.at(s), path_b.at(s))

        s, here = 0.0, gap(0.0)
        if touching is None:
            touching = here <= 0
            if touching:
                found.append(('INITIAL_OVERLAP', begin, 0.0))
        while s < length:
            after = min(length, s + max(abs(here) / fastest, FLOOR))
            there = gap(after)
            if (there <= 0) != touching:
                low, high = s, after
                for _ in range(60):
                    middle = (low + high) / 2
                    if (gap(middle) <= 0) == touching:
                        low = middle
                    else:
                        high = middle
                touching = not touching
                found.append(('IMPACT' if touching else 'SEPARATION', begin, high))
            s, here = after, there
    return found
