"""Exact vectors of fractions, and when a sphere that moves straight touches a triangle.

Touching means being within the radius of it: inside the prism between the two offset faces, or one of the three edge
cylinders, or one of the three vertex spheres. That set is convex, so one line meets it in one interval, from the
smallest root to the largest. Only square roots are rounded, at 60 digits.
"""

import math
from fractions import Fraction

ZERO = Fraction(0)
DIGITS = 60


def add(a, b):
    return tuple(p + q for p, q in zip(a, b))


def sub(a, b):
    return tuple(p - q for p, q in zip(a, b))


def scaled(a, factor):
    return tuple(p * factor for p in a)


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def root(value):
    """Square root of a fraction >= 0, to DIGITS digits behind the point."""
    return Fraction(math.isqrt(value.numerator * 10**(2 * DIGITS) // value.denominator), 10**DIGITS)


def linear(lo, hi, value, slope):
    """Part of [lo, hi] where value + slope t >= 0; None if empty."""
    if slope == 0:
        return (lo, hi) if value >= 0 else None
    zero = -value / slope
    lo, hi = (max(lo, zero), hi) if slope > 0 else (lo, min(hi, zero))
    return (lo, hi) if lo <= hi else None


def quadratic(a, b, c):
    """Where a t^2 + 2 b t + c <= 0, a > 0; None if nowhere."""
    square = b * b - a * c
    if square < 0:
        return None
    return ((-b - root(square)) / a, (-b + root(square)) / a)


def touching(triangle, start, way, radius):
    """The part of t in [0, 1] for which start + t way is within `radius` of the triangle; None if none."""
    parts = []
    normal = cross(sub(triangle[1], triangle[0]), sub(triangle[2], triangle[0]))
    height, climb = dot(normal, sub(start, triangle[0])), dot(normal, way)
    limit = radius * root(dot(normal, normal))
    prism = linear(ZERO, Fraction(1), height + limit, climb)
    prism = prism and linear(*prism, limit - height, -climb)
    for i in range(3):
        corner, edge = triangle[i], sub(triangle[(i + 1) % 3], triangle[i])
        side = cross(normal, edge)
        prism = prism and linear(*prism, dot(side, sub(start, corner)), dot(side, way))
        from_corner, length2 = sub(start, corner), dot(edge, edge)
        sphere = quadratic(dot(way, way), dot(from_corner, way), dot(from_corner, from_corner) - radius * radius)
        parts.append(sphere)
        p, q = dot(from_corner, edge), dot(way, edge)
        cylinder = quadratic(dot(way, way) * length2 - q * q, dot(from_corner, way) * length2 - p * q,
                             (dot(from_corner, from_corner) - radius * radius) * length2 - p * p)
        cylinder = cylinder and linear(*cylinder, p, q)
        parts.append(cylinder and linear(*cylinder, length2 - p, -q))
    parts = [part for part in parts + [prism] if part]
    if not parts:
        return None
    lo, hi = max(ZERO, min(p[0] for p in parts)), min(Fraction(1), max(p[1] for p in parts))
    return (lo, hi) if lo <= hi else None


def nearest(triangle, point):
    """The triangle's point next to `point`."""
    normal = cross(sub(triangle[1], triangle[0]), sub(triangle[2], triangle[0]))
    edges = [(triangle[i], sub(triangle[(i + 1) % 3], triangle[i])) for i in range(3)]
    if all(dot(cross(normal, edge), sub(point, corner)) >= 0 for corner, edge in edges):
        return sub(point, scaled(normal, dot(normal, sub(point, triangle[0])) / dot(normal, normal)))
    feet = [add(c, scaled(e, min(max(dot(sub(point, c), e) / dot(e, e), ZERO), Fraction(1)))) for c, e in edges]
    return min(feet, key=lambda foot: dot(sub(point, foot), sub(point, foot)))


def near(triangle, start, way, radius):
    """False only when the line [start, start + way] stays clear of the triangle by more than a millimetre (doubles)."""
    a, s, w = [tuple(map(float, v)) for v in (triangle[0], start, way)]
    size = max(math.dist(a, tuple(map(float, corner))) for corner in triangle)
    t = min(max(dot(sub(a, s), w) / (dot(w, w) or 1.0), 0.0), 1.0)
    return math.dist(a, add(s, scaled(w, t))) <= size + float(radius) + 1e-3
