"""Closed, outward-oriented triangle solids as a CAD system would tessellate them. Millimetres."""

import math

from .polygon import triangulate

STEPS_PER_MM = 10000  # coordinates are kept to 0.1 um: the same bytes on every machine


class Solid:
    """Vertices and triangles; equal points are one vertex."""

    def __init__(self):
        self.vertices = []   # (x, y, z) mm
        self.triangles = []  # index triples, counter-clockwise from outside
        self._index = {}

    def vertex(self, point):
        key = tuple(round(c * STEPS_PER_MM) for c in point)
        if key not in self._index:
            self._index[key] = len(self.vertices)
            self.vertices.append(tuple(c / STEPS_PER_MM for c in key))
        return self._index[key]

    def triangle(self, a, b, c):
        corners = tuple(self.vertex(p) for p in (a, b, c))
        if len(set(corners)) == 3:
            self.triangles.append(corners)

    def quad(self, a, b, c, d):
        self.triangle(a, b, c)
        self.triangle(a, c, d)

    def face(self, place, outer, holes=()):
        """A plane face: loops of (u, v), put into space by `place`(u, v)."""
        points = [p for loop in (outer, *holes) for p in loop]
        for i, j, k in triangulate(outer, holes):
            self.triangle(place(*points[i]), place(*points[j]), place(*points[k]))

    def band(self, first, second):
        """Quads between two closed loops of equal length; outside is to the right of
        first -> second when the loops run counter-clockwise towards the viewer's up."""
        count = len(first)
        for i in range(count):
            j = (i + 1) % count
            self.quad(first[i], first[j], second[j], second[i])

    def cap(self, loop):
        """A fan from the loop's centre, outward where the loop is counter-clockwise."""
        centre = tuple(sum(p[axis] for p in loop) / len(loop) for axis in range(3))
        for p, q in zip(loop, loop[1:] + loop[:1]):
            self.triangle(centre, p, q)

    def add(self, other, move=lambda p: p):
        for i, j, k in other.triangles:
            self.triangle(*(move(other.vertices[n]) for n in (i, j, k)))

    def moved(self, move):
        result = Solid()
        result.add(self, move)
        return result


def circle(centre, radius, segments, clockwise=False):
    """Loop of (u, v) around `centre`."""
    angles = [2 * math.pi * n / segments for n in range(segments)]
    loop = [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles]
    return loop[::-1] if clockwise else loop


def rectangle(u0, v0, u1, v1, clockwise=False):
    loop = [(u0, v0), (u1, v0), (u1, v1), (u0, v1)]
    return loop[::-1] if clockwise else loop


def rounded_rectangle(u0, v0, u1, v1, radius, segments):
    """Counter-clockwise loop; `segments` edges to each corner."""
    corners = [(u1 - radius, v0 + radius, -90), (u1 - radius, v1 - radius, 0),
               (u0 + radius, v1 - radius, 90), (u0 + radius, v0 + radius, 180)]
    loop = []
    for u, v, start in corners:
        for n in range(segments + 1):
            a = math.radians(start + 90 * n / segments)
            loop.append((u + radius * math.cos(a), v + radius * math.sin(a)))
    return loop


def i_profile(width, height, flange, web):
    """Counter-clockwise I of (u, v), centred in u, standing on v = 0."""
    w, t = width / 2, web / 2
    return [(-w, 0), (w, 0), (w, flange), (t, flange), (t, height - flange), (w, height - flange),
            (w, height), (-w, height), (-w, height - flange), (-t, height - flange), (-t, flange),
            (-w, flange)]


def extrude(outer, holes, w0, w1, place=lambda u, v, w: (u, v, w), divisions=1):
    """The profile from w0 to w1; `place` must keep orientation (u x v = w)."""
    solid = Solid()
    solid.face(lambda u, v: place(u, v, w1), outer, holes)
    lower = Solid()
    lower.face(lambda u, v: place(u, v, w0), outer, holes)
    for i, j, k in lower.triangles:
        solid.triangle(lower.vertices[i], lower.vertices[k], lower.vertices[j])
    levels = [w0 + (w1 - w0) * n / divisions for n in range(divisions + 1)]
    for loop in (outer, *holes):
        for low, high in zip(levels, levels[1:]):
            solid.band([place(u, v, low) for u, v in loop], [place(u, v, high) for u, v in loop])
    return solid


def sweep(profile, frames):
    """`profile` (counter-clockwise loop of (u, v)) carried along frames (origin, u axis, v axis);
    the path runs along u x v. Both ends are capped as plane faces."""
    solid = Solid()

    def place(frame, u, v):
        origin, au, av = frame
        return tuple(origin[n] + u * au[n] + v * av[n] for n in range(3))

    rings = [[place(frame, u, v) for u, v in profile] for frame in frames]
    for low, high in zip(rings, rings[1:]):
        solid.band(low, high)
    solid.face(lambda u, v: place(frames[-1], u, v), profile)
    solid.face(lambda u, v: place(frames[0], -u, v), [(-u, v) for u, v in profile[::-1]])
    return solid


def _sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def _cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _unit(a):
    length = math.sqrt(_dot(a, a))
    return tuple(x / length for x in a)


def _offset(a, direction, length):
    return tuple(x + length * d for x, d in zip(a, direction))


def path_frames(path):
    """Frames along a polyline without twist: each is the last one's, projected."""
    tangents = [_unit(_sub(path[min(n + 1, len(path) - 1)], path[max(n - 1, 0)]))
                for n in range(len(path))]
    axis = min(range(3), key=lambda n: abs(tangents[0][n]))
    u = tuple(1.0 if n == axis else 0.0 for n in range(3))
    frames = []
    for origin, tangent in zip(path, tangents):
        u = _unit(_offset(u, tangent, -_dot(u, tangent)))
        frames.append((origin, u, _cross(tangent, u)))
    return frames


def tube(path, radius, segments):
    """A solid round bar along a polyline."""
    return sweep(circle((0, 0), radius, segments), path_frames(path))


def bent_path(corners, bend_radius, segments):
    """A polyline whose inner corners are rounded by arcs of `segments` edges."""
    path = [corners[0]]
    for before, corner, after in zip(corners, corners[1:], corners[2:]):
        a, b = _unit(_sub(before, corner)), _unit(_sub(after, corner))
        half = 0.5 * math.acos(_dot(a, b))
        centre = _offset(corner, _unit(tuple(x + y for x, y in zip(a, b))),
                         bend_radius / math.sin(half))
        start = _sub(_offset(corner, a, bend_radius / math.tan(half)), centre)
        end = _sub(_offset(corner, b, bend_radius / math.tan(half)), centre)
        turn = math.pi - 2 * half
        for n in range(segments + 1):
            t = n / segments
            weights = (math.sin((1 - t) * turn) / math.sin(turn), math.sin(t * turn) / math.sin(turn))
            path.append(tuple(c + weights[0] * s + weights[1] * e
                              for c, s, e in zip(centre, start, end)))
    return path + [corners[-1]]


def spline_path(knots, steps):
    """Catmull-Rom spline through the knots, `steps` edges to each span."""
    padded = [knots[0]] + list(knots) + [knots[-1]]
    path = [knots[0]]
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:]):
        for n in range(1, steps + 1):
            t = n / steps
            path.append(tuple(
                0.5 * (2 * q + (r - p) * t + (2 * p - 5 * q + 4 * r - s) * t * t
                       + (3 * q - p - 3 * r + s) * t ** 3) for p, q, r, s in zip(a, b, c, d)))
    return path
