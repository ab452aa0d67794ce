"""Triangles of a plane polygon with holes, by ear clipping in integers."""

GRID = 1 << 20  # steps per unit: exact signs, and collinear points are seen as such


def _snapped(point):
    return round(point[0] * GRID), round(point[1] * GRID)


def _cross(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _inside(p, a, b, c):
    return _cross(a, b, p) >= 0 and _cross(b, c, p) >= 0 and _cross(c, a, p) >= 0


def signed_area(loop):
    """Area of the loop of (u, v), positive when counter-clockwise."""
    return 0.5 * sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(loop, loop[1:] + loop[:1]))


def _segments_cross(a, b, c, d):
    """Whether the open segments ab and cd meet in a point that is no shared end."""
    if a in (c, d) or b in (c, d):
        return False
    return _cross(a, b, c) * _cross(a, b, d) <= 0 and _cross(c, d, a) * _cross(c, d, b) <= 0


def _opens_towards(points, loop, n, target):
    """Whether the segment from corner n of `loop` to `target` starts on the loop's left side."""
    before, corner = points[loop[n - 1]], points[loop[n]]
    after = points[loop[(n + 1) % len(loop)]]
    if _cross(before, corner, after) > 0:
        return _cross(corner, after, target) > 0 and _cross(before, corner, target) > 0
    return not (_cross(corner, after, target) <= 0 and _cross(before, corner, target) <= 0)


def _bridge(points, outer, hole):
    """Joins `hole` to `outer` by the shortest segment that crosses neither."""
    edges = [(points[i], points[j]) for loop in (outer, hole)
             for i, j in zip(loop, loop[1:] + loop[:1])]
    pairs = sorted(
        ((points[o][0] - points[h][0]) ** 2 + (points[o][1] - points[h][1]) ** 2, n, m)
        for n, o in enumerate(outer) for m, h in enumerate(hole))
    for _, n, m in pairs:
        a, b = points[outer[n]], points[hole[m]]
        if not (_opens_towards(points, outer, n, b) and _opens_towards(points, hole, m, a)):
            continue
        if not any(_segments_cross(a, b, c, d) for c, d in edges):
            return outer[:n + 1] + hole[m:] + hole[:m + 1] + outer[n:]
    raise ValueError("a hole lies outside its polygon")


def triangulate(outer, holes=()):
    """Index triples into outer + holes[0] + holes[1] ..., counter-clockwise.

    `outer` is a counter-clockwise loop of (u, v), every hole a clockwise one inside it.
    """
    points = [_snapped(p) for p in outer]
    loop = list(range(len(outer)))
    hole_loops = []
    for hole in holes:
        hole_loops.append(list(range(len(points), len(points) + len(hole))))
        points += [_snapped(p) for p in hole]
    # Holes on the right first, so that a later bridge never has to jump over an earlier hole.
    for hole in sorted(hole_loops, key=lambda h: -max(points[i][0] for i in h)):
        loop = _bridge(points, loop, hole)
    return _clip_ears(points, loop)


def _is_ear(points, loop, n):
    i, j, k = loop[n - 1], loop[n], loop[(n + 1) % len(loop)]
    a, b, c = points[i], points[j], points[k]
    if _cross(a, b, c) <= 0:
        return False
    return not any(_inside(points[p], a, b, c) for p in loop
                   if p not in (i, j, k) and points[p] not in (a, b, c))


def _clip_ears(points, loop):
    triangles = []
    loop = list(loop)
    while len(loop) > 3:
        # The ear with the shortest new edge keeps slivers few.
        order = sorted(range(len(loop)),
                       key=lambda n: _edge2(points, loop[n - 1], loop[(n + 1) % len(loop)]))
        best = next(n for n in order if _is_ear(points, loop, n))
        triangles.append((loop[best - 1], loop[best], loop[(best + 1) % len(loop)]))
        del loop[best]
    triangles.append(tuple(loop))
    return triangles


def _edge2(points, i, j):
    return (points[i][0] - points[j][0]) ** 2 + (points[i][1] - points[j][1]) ** 2
