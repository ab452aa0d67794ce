"""Closed, outward-oriented triangle solids as arrays, of a count that is known before they are built.

A piece has `triangles`, how many it will have, and `build()`, which returns vertices [n][3] in
millimetres and triangles [m][3], counter-clockwise from outside. Where a profile (u, v) is carried
along a path, u x v is the path's direction.
"""

import functools
import math

import numpy as np


def straight(start, end):
    """The path from `start` to `end`: a function of the number of stations."""
    def stations(count):
        fraction = np.linspace(0, 1, count)[:, None]
        return np.asarray(start, float) * (1 - fraction) + np.asarray(end, float) * fraction
    return stations


def arc(x, radius, low, high):
    """In the plane x, about the axis (y, z) = (0, radius), from angle `low` to `high`; 0 is down."""
    def stations(count):
        angles = np.linspace(low, high, count)
        return np.stack([np.full(count, x), radius * np.sin(angles),
                         radius * (1 - np.cos(angles))], axis=1)
    return stations


def spline(knots):
    """A Catmull-Rom spline through the knots."""
    knots = np.asarray(knots, float)
    padded = np.concatenate([knots[:1], knots, knots[-1:]])

    def stations(count):
        at = np.linspace(0, len(knots) - 1, count)
        span = np.minimum(at.astype(int), len(knots) - 2)
        t = (at - span)[:, None]
        p, q, r, s = (padded[span + n] for n in range(4))
        return 0.5 * (2 * q + (r - p) * t + (2 * p - 5 * q + 4 * r - s) * t ** 2
                      + (3 * q - p - 3 * r + s) * t ** 3)
    return stations


def _unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _carried(profile, path, u_axis):
    """The profile [m][2] at every station [s][3] of the path: [s][m][3]. Its u is `u_axis`, made
    square to the path."""
    tangents = _unit(np.gradient(path, axis=0))
    u = np.asarray(u_axis, float)
    u = _unit(u - (tangents @ u)[:, None] * tangents)
    v = np.cross(tangents, u)
    return (path[:, None] + profile[None, :, :1] * u[:, None] + profile[None, :, 1:] * v[:, None])


def _bands(loop, stations, closed_path=False):
    """Triangles between consecutive stations of a closed loop of vertex numbers, counter-clockwise;
    a station's numbers are those of the one before plus `stride`."""
    first, stride = loop, len(loop)
    nexts = np.roll(first, -1)
    steps = np.arange(stations if closed_path else stations - 1)[:, None]
    low, high = steps * stride, (steps + 1) % stations * stride
    a, b, c, d = first + low, nexts + low, nexts + high, first + high
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


class Bar:
    """A solid bar: a convex loop along a path."""

    def __init__(self, loop, path, stations, u_axis=(0, 1, 0)):
        self._loop, self._path, self._stations = loop, path, stations
        self._u_axis = u_axis
        self.triangles = 2 * len(loop) * (stations - 1) + 2 * (len(loop) - 2)

    def build(self):
        count = len(self._loop)
        vertices = _carried(self._loop, self._path(self._stations), self._u_axis).reshape(-1, 3)
        n = np.arange(1, count - 1)
        cap = np.stack([np.zeros_like(n), n, n + 1], axis=1)
        last = (self._stations - 1) * count
        return vertices, np.concatenate(
            [_bands(np.arange(count), self._stations), cap[:, ::-1], cap + last])


class Section:
    """A thin-walled section, given as the two sides [n][2] of its wall, along a path. `ring` joins
    the wall's end to its start."""

    def __init__(self, sides, path, stations, u_axis=(0, 1, 0), ring=False):
        self._sides, self._path, self._stations = sides, path, stations
        self._u_axis, self._ring = u_axis, ring
        count = len(sides[0])
        self.triangles = 4 * count * (stations - 1) + 4 * (count if ring else count - 1)

    def build(self):
        right, left = self._sides
        count = len(right)
        profile = np.concatenate([right, left[::-1]])
        vertices = _carried(profile, self._path(self._stations), self._u_axis).reshape(-1, 3)
        stride = 2 * count
        i = np.arange(count if self._ring else count - 1)
        j = (i + 1) % count
        cap = np.stack([i, j, stride - 1 - j, i, stride - 1 - j, stride - 1 - i],
                       axis=1).reshape(-1, 3)
        last = (self._stations - 1) * stride
        return vertices, np.concatenate([self._walls(), cap[:, ::-1], cap + last])

    def _walls(self):
        count = len(self._sides[0])
        if not self._ring:
            return _bands(np.arange(2 * count), self._stations)
        stride, steps = 2 * count, np.arange(self._stations - 1)[:, None]
        walls = []
        for loop in (np.arange(count), np.arange(count, 2 * count)):
            nexts, low = np.roll(loop, -1), steps * stride
            a, b, c, d = (loop + low, nexts + low, nexts + low + stride, loop + low + stride)
            walls.append(np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3))
        return np.concatenate(walls)


class Ring:
    """A ring of rectangular section around `axis` through `centre`: a clamp."""

    def __init__(self, centre, axis, radius, width, thickness, stations):
        self._centre, self._axis, self._radius = centre, axis, radius
        self._width, self._thickness, self._stations = width, thickness, stations
        self.triangles = 8 * stations

    def build(self):
        axis = _unit(np.asarray(self._axis, float))
        u = _unit(np.cross(axis, (0, 1, 0)))
        v = np.cross(axis, u)
        angles = np.linspace(0, 2 * math.pi, self._stations, endpoint=False)
        outward = np.cos(angles)[:, None] * u + np.sin(angles)[:, None] * v
        half = self._width / 2
        # The path runs along axis x outward, so (outward, axis) is (u, -v) of its profile.
        corners = [(self._radius, half), (self._radius + self._thickness, half),
                   (self._radius + self._thickness, -half), (self._radius, -half)]
        vertices = np.stack([self._centre + r * outward + h * axis for r, h in corners], axis=1)
        return vertices.reshape(-1, 3), _bands(np.arange(4), self._stations, closed_path=True)


class Domes:
    """Equal domes, such as rivet heads: half spheres on discs at `centres` [n][3], towards `axes`."""

    def __init__(self, centres, axes, radius, around, rings):
        self._centres, self._axes = np.asarray(centres, float), _unit(np.asarray(axes, float))
        self._radius, self._around, self._rings = radius, around, rings
        self.triangles = len(self._centres) * (2 * around * rings - 2)

    def build(self):
        u = np.cross(self._axes, (1.0, 0.0, 0.0))
        flat = np.linalg.norm(u, axis=1) < 0.5  # along x
        u[flat] = np.cross(self._axes[flat], (0.0, 1.0, 0.0))
        u = _unit(u)
        v = np.cross(self._axes, u)
        a = np.linspace(0, 2 * math.pi, self._around, endpoint=False)
        b = 0.5 * math.pi * np.arange(self._rings) / self._rings
        local = np.stack([np.outer(np.cos(b), np.cos(a)), np.outer(np.cos(b), np.sin(a)),
                          np.outer(np.sin(b), np.ones_like(a))], axis=-1).reshape(-1, 3)
        local = self._radius * np.concatenate([local, [(0, 0, 1)]])
        frames = np.stack([u, v, self._axes], axis=1)  # [n][3][3], rows are axes
        vertices = self._centres[:, None] + local @ frames
        one = self._triangles()
        offsets = np.arange(len(self._centres))[:, None, None] * len(local)
        return vertices.reshape(-1, 3), (one + offsets).reshape(-1, 3)

    def _triangles(self):
        loop = np.arange(self._around)
        last = (self._rings - 1) * self._around
        top = np.stack([loop + last, np.roll(loop, -1) + last,
                        np.full(self._around, last + self._around)], axis=1)
        n = np.arange(1, self._around - 1)
        base = np.stack([np.zeros_like(n), n + 1, n], axis=1)
        return np.concatenate([_bands(loop, self._rings), top, base])


class Sheet:
    """An open sheet of exactly `triangles` triangles over a rectangle of (x, y); z is `height`(x, y)."""

    def __init__(self, low, high, height, triangles):
        self._low, self._high, self._height = low, high, height
        self.triangles = triangles

    def build(self):
        longer = (self._high[0] - self._low[0]) / (self._high[1] - self._low[1])
        columns = max(1, round(math.sqrt(self.triangles / 2 * longer)))
        rows = -(-self.triangles // (2 * columns))
        x, y = np.meshgrid(np.linspace(self._low[0], self._high[0], columns + 1),
                           np.linspace(self._low[1], self._high[1], rows + 1))
        vertices = np.stack([x, y, self._height(x, y)], axis=-1).reshape(-1, 3)
        a = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).reshape(-1)
        b, c, d = a + 1, a + columns + 2, a + columns + 1
        triangles = np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3)
        return vertices, triangles[:self.triangles]


def circle(radius, segments):
    """Counter-clockwise loop [segments][2]."""
    angles = np.linspace(0, 2 * math.pi, segments, endpoint=False)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def pipe_wall(radius, thickness, segments):
    """The two sides of a round pipe's wall, for a Section that is a ring."""
    return circle(radius, segments), circle(radius - thickness, segments)


def wall(corners, thickness, bend_radius=0, bend_segments=1, divisions=1):
    """The two sides of a wall along a polyline [n][2], its inner corners rounded, its straight
    stretches in `divisions` pieces: the right side first."""
    return _wall(tuple(map(tuple, corners)), thickness, bend_radius, bend_segments, divisions)


@functools.lru_cache(maxsize=None)  # a scene's parts have few sections
def _wall(corners, thickness, bend_radius, bend_segments, divisions):
    middle = _rounded(np.asarray(corners, float), bend_radius, bend_segments)
    middle = _divided(middle, divisions)
    along = _unit(np.diff(middle, axis=0))
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1)
    before = np.concatenate([normals[:1], normals])
    after = np.concatenate([normals, normals[-1:]])
    mitre = before + after
    mitre /= 0.5 * np.sum(mitre * mitre, axis=1, keepdims=True)
    return middle - thickness / 2 * mitre, middle + thickness / 2 * mitre


def _rounded(corners, radius, segments):
    if radius == 0:
        return corners
    points = [corners[0]]
    for before, corner, after in zip(corners, corners[1:], corners[2:]):
        a, b = _unit(before - corner), _unit(after - corner)
        half = 0.5 * math.acos(np.dot(a, b))
        centre = corner + _unit(a + b) * radius / math.sin(half)
        start, end = (corner + side * radius / math.tan(half) - centre for side in (a, b))
        turn = math.pi - 2 * half
        for t in np.linspace(0, 1, segments + 1):
            points.append(centre + (math.sin((1 - t) * turn) * start
                                    + math.sin(t * turn) * end) / math.sin(turn))
    return np.array(points + [corners[-1]])


def _divided(points, divisions):
    """Every stretch of more than a tenth of the longest in `divisions` pieces."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    pieces = [points[:1]]
    for a, b, length in zip(points, points[1:], lengths):
        count = divisions if length > 0.1 * lengths.max() else 1
        pieces.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.concatenate(pieces)


def joined(pieces):
    """One mesh of several pieces."""
    vertices, triangles, first = [], [], 0
    for piece in pieces:
        points, corners = piece.build()
        vertices.append(points)
        triangles.append(corners + first)
        first += len(points)
    return np.concatenate(vertices), np.concatenate(triangles)
