"""The moving part: a small pump with a mounting flange and an outlet elbow, 75 mm long.

Millimetres, in its own frame: shaft along +x, flange on x = 0, outlet towards +z.
"""

import math

from .solids import Solid, circle, rounded_rectangle

BODY_RADIUS = 18
FLANGE_HALF = 28
FLANGE_THICKNESS = 6
SEGMENTS = 48
ELBOW_SEGMENTS = 20


def _ring(x, radius):
    """Loop about the x axis, counter-clockwise seen from +x."""
    return [(x, y, z) for y, z in circle((0, 0), radius, SEGMENTS)]


def _flange(solid):
    outline = rounded_rectangle(-FLANGE_HALF, -FLANGE_HALF, FLANGE_HALF, FLANGE_HALF, 6, 6)
    bolts = [circle((y, z), 3, 16) for y in (-21, 21) for z in (-21, 21)]
    body = circle((0, 0), BODY_RADIUS, SEGMENTS)
    holes = [loop[::-1] for loop in (*bolts, body)]
    solid.face(lambda y, z: (FLANGE_THICKNESS, y, z), outline, holes)
    solid.face(lambda y, z: (0, -y, z), [(-y, z) for y, z in outline[::-1]],
               [[(-y, z) for y, z in hole[::-1]] for hole in holes])

    def at(loop, x):
        return [(x, y, z) for y, z in loop]

    solid.band(at(outline, 0), at(outline, FLANGE_THICKNESS))
    for bolt in bolts:
        solid.band(at(bolt, FLANGE_THICKNESS), at(bolt, 0))


def _front(solid):
    """Bearing housing and shaft."""
    profile = [(FLANGE_THICKNESS, BODY_RADIUS), (12, BODY_RADIUS), (17, 14), (22, 14), (22, 5),
               (32, 5), (33, 4)]
    rings = [_ring(x, r) for x, r in profile]
    for low, high in zip(rings, rings[1:]):
        solid.band(low, high)
    solid.cap(rings[-1])


def _elbow_rings():
    """Rings from the rear face along -x, then bent up to +z."""
    radius, bend, port_z, rear = 6, 9, 5, -24
    rings = []
    for turn in range(-1, 11):
        a = math.radians(max(turn, 0) * 9)
        straight = 0 if turn < 0 else 3
        cx = rear - straight - bend * math.sin(a)
        cz = port_z + bend * (1 - math.cos(a))
        up = (math.sin(a), math.cos(a))  # of the ring's own vertical, in (x, z)
        rings.append([(cx + radius * v * up[0], radius * u, cz + radius * v * up[1])
                      for u, v in circle((0, 0), 1, ELBOW_SEGMENTS)])
    top = [(x, y, 26.0) for x, y, _ in rings[-1]]
    return rings + [top]


def _rear(solid):
    """Motor housing, its rear face and the outlet elbow with a blind bore."""
    rings = [_ring(x, r) for x, r in ((-24, 16), (-22, BODY_RADIUS), (0, BODY_RADIUS))]
    for low, high in zip(rings, rings[1:]):
        solid.band(low, high)
    elbow = _elbow_rings()
    port = [(y, z) for _, y, z in elbow[0]]
    solid.face(lambda y, z: (-24, -y, z), [(-y, z) for _, y, z in rings[0][::-1]],
               [[(-y, z) for y, z in port]])
    for low, high in zip(elbow, elbow[1:]):
        solid.band(high, low)
    _bore(solid, elbow[-1])


def _bore(solid, rim):
    cx = sum(p[0] for p in rim) / len(rim)
    inner = [(cx + (x - cx) * 0.6, y * 0.6, z) for x, y, z in rim]
    bottom = [(x, y, z - 6) for x, y, z in inner]
    solid.band(inner, rim)
    solid.band(bottom, inner)
    solid.cap(bottom[::-1])


def pump():
    solid = Solid()
    _flange(solid)
    _front(solid)
    _rear(solid)
    return solid
