"""The parts of the bay: skin below, floor above, and what runs between. Millimetres.

x runs along the bay, y across it, z up; the skin is part of a cylinder about an axis along x.
"""

import math

import numpy as np

from .solids import (Bar, Domes, Ring, Section, Sheet, arc, circle, pipe_wall, spline, straight,
                     wall)

LENGTH = 8000
SKIN_RADIUS = 1900         # inner side
HALF_ANGLE = math.radians(25)
SKIN_THICKNESS = 2
FRAME_PITCH = 500
FRAME_HEIGHT = 100
BEAM_BOTTOM = 480
BEAM_HEIGHT = 80
HALF_WIDTH = 720           # of the floor
PANELS = 8
WIRES_A_BUNDLE = 12
TUBES = ((-200, 190, 14), (-140, 175, 10), (-80, 190, 10), (80, 180, 8), (140, 190, 12),
         (200, 175, 6), (-480, 400, 10), (-430, 420, 6), (430, 410, 12), (480, 400, 8))
BUNDLES = ((0, 240), (-60, 330), (60, 330), (-130, 420), (130, 420), (-520, 300), (520, 300), (0, 420))
DUCTS = ((-330, 300, 80), (330, 300, 60))


class Detail:
    """How finely to tessellate: factors on the steps around a section and along a path."""

    def __init__(self, around, along):
        self._around, self._along = around, along

    def around(self, steps):
        return max(3, round(steps * self._around))

    def along(self, steps):
        """Stations of a path of so many steps."""
        return max(1, round(steps * self._along)) + 1


def _stations():
    return range(0, LENGTH + 1, FRAME_PITCH)


def _skin_height(y):
    return SKIN_RADIUS - math.sqrt(SKIN_RADIUS ** 2 - y ** 2)


def _skin_point(x, angle, height):
    """A point `height` inside the skin, and the direction inwards."""
    inward = (0.0, -math.sin(angle), math.cos(angle))
    radius = SKIN_RADIUS - height
    return (x, radius * math.sin(angle), SKIN_RADIUS - radius * math.cos(angle)), inward


def skin_panel(number, detail):
    count = detail.around(60) + 1
    angles = np.linspace(-HALF_ANGLE, HALF_ANGLE, count)
    sides = [np.stack([r * np.sin(angles), SKIN_RADIUS - r * np.cos(angles)], axis=1)
             for r in (SKIN_RADIUS + SKIN_THICKNESS, SKIN_RADIUS)]
    length = LENGTH / PANELS
    return [Section(sides, straight((number * length, 0, 0), ((number + 1) * length, 0, 0)),
                    detail.along(8))]


def frame(x, detail):
    section = wall([(-25, 2), (0, 2), (0, FRAME_HEIGHT), (25, FRAME_HEIGHT)], 2.5, 5,
                   detail.around(3), detail.around(2))
    return [Section(section, arc(x, SKIN_RADIUS, -HALF_ANGLE, HALF_ANGLE), detail.along(64),
                    (-1, 0, 0))]


def stringer(angle, detail):
    """A hat section on the skin."""
    section = wall([(-30, 1.5), (-15, 1.5), (-10, 30), (10, 30), (15, 1.5), (30, 1.5)], 1.6, 4,
                   detail.around(3), detail.around(1))
    s, c = math.sin(angle), math.cos(angle)
    turned = [np.stack([c * side[:, 0] - s * side[:, 1], s * side[:, 0] + c * side[:, 1]], axis=1)
              for side in section]
    (_, y, z), _ = _skin_point(0, angle, 0)
    return [Section(turned, straight((0, y, z), (LENGTH, y, z)), detail.along(32))]


def cross_beam(x, detail):
    section = wall([(30, 0), (0, 0), (0, BEAM_HEIGHT), (30, BEAM_HEIGHT)], 3, 5, detail.around(3),
                   detail.around(2))
    return [Section(section, straight((x, -HALF_WIDTH, BEAM_BOTTOM), (x, HALF_WIDTH, BEAM_BOTTOM)),
                    detail.along(24), (-1, 0, 0))]


def posts(x, detail):
    sides = pipe_wall(16, 2, detail.around(16))
    return [Section(sides, straight((x, y, _skin_height(y) + FRAME_HEIGHT), (x, y, BEAM_BOTTOM)),
                    detail.along(5), (1, 0, 0), ring=True) for y in (-560, 560)]


def brackets(x, detail):
    """Angles between posts and beam, with their bolts."""
    pieces, bolts, axes = [], [], []
    for y in (-560, 560):
        for side in (-1, 1):
            corner = y + 17 * side
            section = wall([(60 * side, -2), (2 * side, -2), (2 * side, -60)][::side], 4, 6,
                           detail.around(4), detail.around(2))
            pieces.append(Section(section, straight((x - 22, corner, BEAM_BOTTOM),
                                                    (x + 22, corner, BEAM_BOTTOM)),
                                  detail.along(4)))
            for along in (-12, 12):
                bolts += [(x + along, corner + 38 * side, BEAM_BOTTOM - 4),
                          (x + along, corner + 4 * side, BEAM_BOTTOM - 40)]
                axes += [(0, 0, -1), (0, side, 0)]
    pieces.append(Domes(bolts, axes, 5, detail.around(14), detail.around(4)))
    return pieces


def seat_track(y, detail):
    section = wall([(-18, 0), (18, 0), (18, 22), (8, 22)], 3, 4, detail.around(3), detail.around(2))
    z = BEAM_BOTTOM + BEAM_HEIGHT + 4
    return [Section(section, straight((0, y, z), (LENGTH, y, z)), detail.along(40))]


def floor_panel(number, detail):
    width = LENGTH / PANELS
    z = BEAM_BOTTOM + BEAM_HEIGHT + 32
    section = wall([(-HALF_WIDTH, 0), (HALF_WIDTH, 0)], 9, divisions=detail.around(24))
    return [Section(section, straight((number * width + 2, 0, z), ((number + 1) * width - 2, 0, z)),
                    detail.along(10))]


def _wandering(random, y, z, pitch, loose, sag=0.0):
    """Knots of a line along the bay that is held at every frame and loose between."""
    knots = []
    for n in range(LENGTH // pitch + 1):
        held = n * pitch % FRAME_PITCH == 0
        give = 0.15 if held else 1.0
        knots.append((n * pitch, y + loose * give * random.uniform(-1, 1),
                      z + loose * give * random.uniform(-1, 1) - (0 if held else sag)))
    return knots


def tube(random, y, z, radius, detail):
    """A hydraulic line with swerves around what is in its way."""
    knots = _wandering(random, y, z, FRAME_PITCH, 12)
    for n in random.sample(range(2, len(knots) - 2), 3):
        x, at, height = knots[n]
        knots[n] = (x, at + random.choice((-35, 35)), height + random.uniform(-25, 25))
    return [Bar(circle(radius, detail.around(16)), spline(knots), detail.along(230))]


def clamps(x, detail):
    """The rings that hold the lines at a frame."""
    return [Ring((x, y, z), (1, 0, 0), radius + 1, 14, 3, detail.around(40))
            for y, z, radius in TUBES]


def wire_bundle(random, y, z, detail):
    """Wires that run loosely together, each a solid of its own."""
    pieces = []
    for n in range(WIRES_A_BUNDLE):
        a = 2 * math.pi * n / WIRES_A_BUNDLE
        lay = 0 if n == 0 else random.uniform(6, 12)
        knots = _wandering(random, y + lay * math.cos(a), z + lay * math.sin(a), FRAME_PITCH // 2,
                           4, sag=random.uniform(8, 16))
        steps = detail.along(random.uniform(150, 190))
        pieces.append(Bar(circle(random.choice((1.2, 1.6, 2.4)), detail.around(8)), spline(knots),
                          steps))
    return pieces


def duct(random, y, z, radius, detail):
    knots = _wandering(random, y, z, 2 * FRAME_PITCH, 15)
    return [Section(pipe_wall(radius, 2, detail.around(40)), spline(knots), detail.along(80),
                    ring=True)]


def equipment_box(x, y, detail):
    """A box with cooling fins above and round connectors on its side."""
    bottom, width, length, height = _skin_height(abs(y)) + FRAME_HEIGHT + 20, 140, 260, 110
    top = bottom + height
    block = wall([(-width / 2, height / 2), (width / 2, height / 2)], height,
                 divisions=detail.around(6))
    pieces = [Section(block, straight((x, y, bottom), (x + length, y, bottom)), detail.along(8))]
    for n in range(16):
        fin = wall([(0, -1), (0, 18)], 2.5, divisions=detail.around(3))
        at = y - width / 2 + 8 + n * (width - 16) / 15
        pieces.append(Section(fin, straight((x + 6, at, top), (x + length - 6, at, top)),
                              detail.along(8)))
    for n in range(4):
        z = bottom + 25 + 20 * n
        pieces.append(Bar(circle(8, detail.around(24)), straight((x - 18, y, z), (x + 1, y, z)),
                          detail.along(3)))
    return pieces


def frame_rivets(x, detail):
    """Heads on the frame's foot."""
    placed = [_skin_point(x - 14, angle, 3) for angle in
              np.linspace(-0.97 * HALF_ANGLE, 0.97 * HALF_ANGLE, 56)]
    centres, axes = zip(*placed)
    return [Domes(centres, axes, 3, detail.around(10), detail.around(3))]


def stringer_rivets(angle, detail):
    """Heads on both feet of a stringer."""
    placed = [_skin_point(x, angle + side * 22 / SKIN_RADIUS, 2) for side in (-1, 1)
              for x in range(25, LENGTH, 100)]
    centres, axes = zip(*placed)
    return [Domes(centres, axes, 2.5, detail.around(8), detail.around(3))]


def blanket(triangles):
    """An open sheet of insulation under the floor: it takes up what the other parts leave."""
    def height(x, y):
        return BEAM_BOTTOM - 20 + 6 * np.sin(x / 90) * np.cos(y / 70)
    return [Sheet((100, -400), (LENGTH - 100, 400), height, triangles)]


def parts(random, detail):
    """Name and pieces of every part but the blanket."""
    stringers = [math.radians(a) for a in (-22.5, -17.5, -12.5, -7.5, -2.5, 2.5, 7.5, 12.5, 17.5, 22.5)]
    listed = [(f"skin_panel_{n + 1}", skin_panel(n, detail)) for n in range(PANELS)]
    for n, x in enumerate(_stations(), start=1):
        listed += [(f"frame_{n}", frame(x, detail)), (f"frame_rivets_{n}", frame_rivets(x, detail)),
                   (f"cross_beam_{n}", cross_beam(x, detail)), (f"posts_{n}", posts(x, detail)),
                   (f"brackets_{n}", brackets(x, detail)), (f"clamps_{n}", clamps(x, detail))]
    for n, angle in enumerate(stringers, start=1):
        listed += [(f"stringer_{n}", stringer(angle, detail)),
                   (f"stringer_rivets_{n}", stringer_rivets(angle, detail))]
    listed += [(f"seat_track_{n + 1}", seat_track(y, detail))
               for n, y in enumerate((-600, -250, 250, 600))]
    listed += [(f"floor_panel_{n + 1}", floor_panel(n, detail)) for n in range(PANELS)]
    listed += [(f"tube_{n + 1}", tube(random, *t, detail)) for n, t in enumerate(TUBES)]
    listed += [(f"wire_bundle_{n + 1}", wire_bundle(random, *b, detail))
               for n, b in enumerate(BUNDLES)]
    listed += [(f"duct_{n + 1}", duct(random, *d, detail)) for n, d in enumerate(DUCTS)]
    listed += [(f"equipment_{n + 1}", equipment_box(650 + 1250 * n, 400 * (-1) ** n, detail))
               for n in range(6)]
    return listed
