#!/usr/bin/env python3
"""Writes an assembly of 2000 parts, and the same triangles as one mesh.

Usage: make_large_assembly.py FOLDER [SEGMENTS]

FOLDER/assembly.glb: 40 meshes, each placed 50 times: 5 levels of 2 sides, of which one mirrors the
other, of 5 bays of 40 parts; names repeat from bay to bay. FOLDER/flat.ply: its triangles where they
stand, in millimetres. SEGMENTS (default 24): edges of a circle, which sets the triangles. The same
bytes on every machine; Python's standard library alone.
"""

import pathlib
import sys

from samplegen import mesh_files
from samplegen.solids import Solid, circle, extrude, i_profile, rectangle

LEVELS, BAYS, KINDS = 5, 5, 40
LEVEL_HEIGHT, BAY_LENGTH, SIDE_OFFSET = 300, 500, 60  # mm


def part(kind, segments):
    """One of 40 solids of 20 to 60 mm."""
    size = 20 + kind
    if kind % 4 == 0:
        return extrude(circle((0, 0), size / 2, segments), (), 0, 10 + kind)
    if kind % 4 == 1:
        hole = circle((0, 0), size / 4, segments, clockwise=True)
        return extrude(rectangle(-size / 2, -size / 2, size / 2, size / 2), [hole], 0, 8)
    if kind % 4 == 2:
        return extrude(i_profile(size, 1.5 * size, 4, 4), (), 0, 40, divisions=segments // 6)
    hole = circle((0, 0), size / 3, segments, clockwise=True)
    return extrude(circle((0, 0), size / 2, segments), [hole], 0, 15)


def _metres(x, y, z):
    return [x / 1000, y / 1000, z / 1000]


def write_assembly(folder, segments):
    solids = [part(kind, segments) for kind in range(KINDS)]
    scene, flat = mesh_files.GlbScene(), Solid()
    meshes = [scene.mesh(f"part_{kind}", solid) for kind, solid in enumerate(solids)]
    root = scene.node("rack")
    for level in range(LEVELS):
        floor = scene.node(f"level_{level}", root,
                           translation=_metres(0, 0, LEVEL_HEIGHT * level))
        for side, mirror in (("left", 1), ("right", -1)):
            half = scene.node(side, floor, translation=_metres(0, SIDE_OFFSET * mirror, 0),
                              scale=[1, mirror, 1])
            for bay in range(BAYS):
                cell = scene.node("bay", half, translation=_metres(BAY_LENGTH * bay, 0, 0))
                for kind, solid in enumerate(solids):
                    x, y = 90 * (kind % 5), 110 * (kind // 5)
                    scene.node(f"part_{kind}", cell, mesh=meshes[kind],
                               translation=_metres(x, y, 0))
                    place = (BAY_LENGTH * bay + x, y + SIDE_OFFSET, LEVEL_HEIGHT * level)
                    _add(flat, solid, place, mirror)
    scene.write(folder / "assembly.glb")
    mesh_files.write_ply(folder / "flat.ply", flat)


def _add(flat, solid, place, mirror):
    moved = [(x + place[0], (y + place[1]) * mirror, z + place[2]) for x, y, z in solid.vertices]
    first = len(flat.vertices)
    flat.vertices += moved
    flat.triangles += [tuple(first + n for n in (t if mirror == 1 else t[::-1]))
                       for t in solid.triangles]


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[1] in ("-h", "--help"):
        print(__doc__.strip())
        return 0 if sys.argv[1:] in (["-h"], ["--help"]) else 2
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    write_assembly(folder, int(sys.argv[2]) if len(sys.argv) == 3 else 24)
    return 0


if __name__ == "__main__":
    sys.exit(main())
