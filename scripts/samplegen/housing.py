"""A small assembly with installed parts: a cover with four bolts on a housing, a pin in its bore, a
clip of two halves on the pin. Millimetres; z up, the housing stands on z = 0.

tests/support/make_sample_step.cpp writes the same parts as exact surfaces.
"""

import math

from .mesh_files import GlbScene
from .solids import Solid, circle, rectangle

LENGTH, WIDTH, HEIGHT = 110, 70, 40      # of the housing
POCKET = (8, 8, 72, 62)                  # u0, v0, u1, v1; open above
POCKET_BOTTOM = 8
COVER_LENGTH, COVER_THICKNESS = 80, 6
BOLT_PLACES = ((4, 4), (76, 4), (76, 66), (4, 66))
BOLT_RADIUS, BOLT_LENGTH = 1.9, 18       # of the shank, below the head
BOLT_HEAD_RADIUS, BOLT_HEAD_HEIGHT = 3.5, 3
TAP_RADIUS, TAP_BOTTOM = 2, 25           # of the holes in the housing
PIN_PLACE = (94, 35)
PIN_RADIUS, PIN_LENGTH = 4.9, 60
BORE_RADIUS = 5
CLIP_BOTTOM, CLIP_HEIGHT = 42, 8
CLIP_INNER_RADIUS, CLIP_OUTER_RADIUS = 5, 10
CLIP_GAP = 0.2                           # between the halves

SEGMENTS = 48                            # of circles


def _block(outer, low, high, holes):
    """A prism from `low` to `high` with `holes`: (counter-clockwise loop, height of its floor)."""
    solid = Solid()
    through = [loop[::-1] for loop, floor in holes if floor == low]
    solid.face(lambda u, v: (u, v, high), outer, [loop[::-1] for loop, _ in holes])
    under = Solid()
    under.face(lambda u, v: (u, v, low), outer, through)
    for i, j, k in under.triangles:
        solid.triangle(under.vertices[i], under.vertices[k], under.vertices[j])
    solid.band([(u, v, low) for u, v in outer], [(u, v, high) for u, v in outer])
    for loop, floor in holes:
        wall = loop[::-1]
        solid.band([(u, v, floor) for u, v in wall], [(u, v, high) for u, v in wall])
        if floor != low:
            solid.face(lambda u, v, z=floor: (u, v, z), loop)
    return solid


def housing():
    holes = [(rectangle(*POCKET), POCKET_BOTTOM),
             (circle(PIN_PLACE, BORE_RADIUS, SEGMENTS), 0)]
    holes += [(circle(place, TAP_RADIUS, SEGMENTS), TAP_BOTTOM) for place in BOLT_PLACES]
    return _block(rectangle(0, 0, LENGTH, WIDTH), 0, HEIGHT, holes)


def cover():
    """Its lower side on z = 0."""
    holes = [(circle(place, TAP_RADIUS, SEGMENTS), 0) for place in BOLT_PLACES]
    return _block(rectangle(0, 0, COVER_LENGTH, WIDTH), 0, COVER_THICKNESS, holes)


def bolt():
    """Along z, the lower side of its head on z = 0."""
    solid = Solid()
    head, shank = circle((0, 0), BOLT_HEAD_RADIUS, 6), circle((0, 0), BOLT_RADIUS, SEGMENTS)
    solid.face(lambda u, v: (u, v, BOLT_HEAD_HEIGHT), head)
    solid.band([(u, v, 0) for u, v in head], [(u, v, BOLT_HEAD_HEIGHT) for u, v in head])
    solid.face(lambda v, u: (u, v, 0), [(v, u) for u, v in head[::-1]],
               [[(v, u) for u, v in shank]])
    solid.band([(u, v, -BOLT_LENGTH) for u, v in shank], [(u, v, 0) for u, v in shank])
    solid.face(lambda v, u: (u, v, -BOLT_LENGTH), [(v, u) for u, v in shank[::-1]])
    return solid


def pin():
    return _block(circle((0, 0), PIN_RADIUS, SEGMENTS), 0, PIN_LENGTH, [])


def clip_half():
    """The half of a ring with x > 0, about z."""
    def arc(radius):
        last = math.acos(CLIP_GAP / 2 / radius)
        angles = [last * (2 * n / SEGMENTS - 1) for n in range(SEGMENTS + 1)]
        return [(radius * math.cos(a), radius * math.sin(a)) for a in angles]

    outer, inner = arc(CLIP_OUTER_RADIUS), arc(CLIP_INNER_RADIUS)
    return _block(outer + inner[::-1], 0, CLIP_HEIGHT, [])


def _metres(x, y, z):
    return [x / 1000, y / 1000, z / 1000]


def housing_assembly():
    scene = GlbScene()
    root = scene.node("Gearbox")
    scene.node("Housing", root, mesh=scene.mesh("Housing", housing()))
    lid = scene.node("Lid", root, translation=_metres(0, 0, HEIGHT))
    scene.node("Cover", lid, mesh=scene.mesh("Cover", cover()))
    bolt_mesh = scene.mesh("Bolt", bolt())
    for x, y in BOLT_PLACES:
        scene.node("Bolt", lid, mesh=bolt_mesh, translation=_metres(x, y, COVER_THICKNESS))
    scene.node("Pin", root, mesh=scene.mesh("Pin", pin()), translation=_metres(*PIN_PLACE, 0))
    clip = scene.node("Clip", root, translation=_metres(*PIN_PLACE, CLIP_BOTTOM))
    half = scene.mesh("Half", clip_half())
    scene.node("Half", clip, mesh=half)
    scene.node("Half", clip, mesh=half, rotation=[0, 0, 1, 0])
    return scene
