"""The sample scene: a 1.2 m long bay of an aircraft, skin below, floor above. Millimetres.

x runs aft to forward, y to the left, z up; the floor is open forward of x = 100.
"""

import math

from .mesh_files import GlbScene
from .solids import (Solid, bent_path, circle, extrude, i_profile, rectangle, spline_path, sweep,
                     tube)

HALF_LENGTH = 600
SKIN_RADIUS = 1900         # of the inner side, about an axis along x at z = SKIN_RADIUS
SKIN_THICKNESS = 2
HALF_SPAN = 400            # of skin and frames, in y
FRAME_STATIONS = (-450, 0, 450)
FRAME_HEIGHT = 90
FLOOR_BEAM_Y = (-250, 250)
FLOOR_BEAM_BOTTOM = 300
FLOOR_BEAM_HEIGHT = 80
FLOOR_PLATE_BOTTOM = FLOOR_BEAM_BOTTOM + FLOOR_BEAM_HEIGHT
POST_BOTTOM = 105
BULKHEAD_X = -586


def _arc_frames(segments, span):
    """Frames along the inner side of the skin: u along x, v towards its axis, path along y."""
    half = math.asin(span / SKIN_RADIUS)
    frames = []
    for n in range(segments + 1):
        a = half * (2 * n / segments - 1)
        s, c = math.sin(a), math.cos(a)
        # u x v must point along the path (0, c, s): with v inward (0, -s, c), u is -x.
        frames.append(((0, SKIN_RADIUS * s, SKIN_RADIUS * (1 - c)), (-1, 0, 0), (0, -s, c)))
    return frames


def skin_panel():
    stations = [-HALF_LENGTH + 100 * n for n in range(13)]
    inner = [(u, 0) for u in stations]
    outer = [(u, -SKIN_THICKNESS) for u in stations]
    return sweep(outer + inner[::-1], _arc_frames(48, HALF_SPAN))


def curved_frame():
    return sweep(i_profile(50, FRAME_HEIGHT, 4, 4), _arc_frames(48, HALF_SPAN))


def floor_beam():
    """Along x, its lower flange's middle on the origin."""
    return extrude(i_profile(50, FLOOR_BEAM_HEIGHT, 4, 4), (), -HALF_LENGTH, HALF_LENGTH,
                   place=lambda u, v, w: (w, u, v), divisions=12)


def post():
    """A square tube of 30 mm, from z = 0 up to the floor beam."""
    return extrude(rectangle(-15, -15, 15, 15), [rectangle(-12, -12, 12, 12, clockwise=True)], 0,
                   FLOOR_BEAM_BOTTOM - POST_BOTTOM)


def angle_bracket():
    """An L of two drilled legs: one along +x under z = 0, one down along -z behind x = 0."""
    length, depth, thickness, half = 60, 70, 4, 22
    solid = Solid()
    profile = [(0, 0), (0, -depth), (thickness, -depth), (thickness, -thickness),
               (length, -thickness), (length, 0)]
    solid.face(lambda x, z: (x, -half, z), profile)
    solid.face(lambda x, z: (-x, half, z), [(-x, z) for x, z in profile[::-1]])
    holes = [circle((c, 0), 4.5, 24) for c in (24, 45)]
    down_holes = [[(c, y) for c, y in loop] for loop in (circle((c, 0), 4.5, 24) for c in (30, 54))]

    def reversed_holes(loops):
        return [loop[::-1] for loop in loops]

    def mirrored(loops):  # (u, y) -> (-u, y) turns the loops round
        return [[(-u, y) for u, y in loop] for loop in loops]

    # Leg under z = 0: its upper face looks up, its lower one down and starts at the other leg.
    solid.face(lambda x, y: (x, y, 0), rectangle(0, -half, length, half), reversed_holes(holes))
    solid.face(lambda x, y: (-x, y, -thickness), rectangle(-length, -half, -thickness, half),
               mirrored(holes))
    # Leg behind x = 0: its outer face looks to -x, its inner one to +x. Here u = -z.
    solid.face(lambda u, y: (0, y, u), rectangle(-depth, -half, 0, half), mirrored(down_holes))
    solid.face(lambda u, y: (thickness, y, -u), rectangle(thickness, -half, depth, half),
               reversed_holes(down_holes))
    _close_leg_sides(solid, holes, down_holes, length, depth, thickness, half)
    return solid


def _close_leg_sides(solid, holes, down_holes, length, depth, thickness, half):
    """The legs' tips and the walls of their holes."""
    solid.quad((length, -half, -thickness), (length, half, -thickness), (length, half, 0),
               (length, -half, 0))
    solid.quad((0, -half, -depth), (0, half, -depth), (thickness, half, -depth),
               (thickness, -half, -depth))
    for loop in holes:
        solid.band([(u, y, 0) for u, y in loop], [(u, y, -thickness) for u, y in loop])
    for loop in down_holes:
        solid.band([(thickness, y, -u) for u, y in loop], [(0, y, -u) for u, y in loop])


def floor_plate():
    """With lightening holes in two rows; the lane between them is whole."""
    holes = [circle((x, y), 40, 40, clockwise=True)
             for x in range(-545, 31, 115) for y in (-140, 140)]
    return extrude(rectangle(-HALF_LENGTH, -275, 100, 275), holes, FLOOR_PLATE_BOTTOM,
                   FLOOR_PLATE_BOTTOM + 4)


def bulkhead():
    """A plate across the bay, with passages for lines, wires, beams and a hand."""
    holes = [circle((-100, 200), 28, 32, clockwise=True),
             circle((-170, 160), 20, 24, clockwise=True),
             circle((120, 180), 55, 40, clockwise=True),
             circle((0, 470), 60, 40, clockwise=True)]
    holes += [rectangle(y - 35, FLOOR_BEAM_BOTTOM - 10, y + 35, FLOOR_PLATE_BOTTOM + 14,
                        clockwise=True) for y in FLOOR_BEAM_Y]
    return extrude(rectangle(-370, 60, 370, 560), holes, BULKHEAD_X - 4, BULKHEAD_X,
                   place=lambda u, v, w: (w, u, v))


def hydraulic_line():
    return tube(bent_path([(-600, -100, 200), (300, -100, 200), (300, -390, 200)], 70, 12), 12, 28)


def return_line():
    return tube(bent_path([(-600, -170, 160), (440, -170, 160), (440, -170, 500), (440, 60, 560)],
                          45, 10), 7, 20)


def wire_bundle(random):
    """Seven wires that run loosely together along the bay, each a solid of its own."""
    wires = Solid()
    for number in range(7):
        a = 2 * math.pi * number / 6
        lay = (0, 0) if number == 6 else (11 * math.cos(a), 11 * math.sin(a))
        knots = []
        for station in range(-600, 601, 120):
            loose = 1 + 1.4 * random.random()
            sag = 25 * math.cos(math.pi * station / 450)
            knots.append((station + (0 if abs(station) == 600 else 20 * (random.random() - 0.5)),
                          130 + loose * lay[0], 180 + sag + loose * lay[1]))
        wires.add(tube(spline_path(knots, 6), 2.5 if number else 4, 10))
    return wires


def _metres(x, y, z):
    return [x / 1000, y / 1000, z / 1000]


def structure():
    """Frames, floor beams, posts and brackets, as an assembly of instances."""
    scene = GlbScene()
    root = scene.node("bay_structure")
    frame, beam = scene.mesh("curved_frame", curved_frame()), scene.mesh("floor_beam", floor_beam())
    upright, bracket = scene.mesh("post", post()), scene.mesh("angle_bracket", angle_bracket())
    frames = scene.node("frames", root)
    for n, x in enumerate(FRAME_STATIONS):
        scene.node(f"frame_{n + 1}", frames, mesh=frame, translation=_metres(x, 0, 0))
    floor = scene.node("floor", root, translation=_metres(0, 0, FLOOR_BEAM_BOTTOM))
    for side, y in zip(("right", "left"), FLOOR_BEAM_Y):
        scene.node(f"floor_beam_{side}", floor, mesh=beam, translation=_metres(0, y, 0))
        for n, x in enumerate(FRAME_STATIONS):
            joint = scene.node(f"joint_{side}_{n + 1}", floor, translation=_metres(x, y, 0))
            scene.node(f"post_{side}_{n + 1}", joint, mesh=upright,
                       translation=_metres(0, 0, POST_BOTTOM - FLOOR_BEAM_BOTTOM))
            scene.node(f"bracket_{side}_{n + 1}_forward", joint, mesh=bracket,
                       translation=_metres(15, 0, 0))
            scene.node(f"bracket_{side}_{n + 1}_aft", joint, mesh=bracket,
                       translation=_metres(-15, 0, 0), rotation=[0, 0, 1, 0])
    return scene
