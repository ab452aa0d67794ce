#!/usr/bin/python3
"""Writes an underfloor bay of an aircraft, 8 m long: a manifest and a mesh for every part.

Usage: make_aircraft_bay.py FOLDER [--polygons N] [--voxel-size 5mm] [--seed N] [--translation X,Y,Z]

Seeded and deterministic. The scene has exactly N triangles (593,409 unless told otherwise, the
count of the aircraft geometry of McNeely, Puterbaugh and Troy 1999) in 169 parts. --translation
places it elsewhere, in meters. Writes FOLDER/aircraft_bay.json and FOLDER/PART.ply.
"""

import argparse
import json
import os
import pathlib
import random
import sys

SYSTEM_PYTHON = "/usr/bin/python3"  # where Debian's python3-numpy is

try:
    import numpy as np
except ImportError:
    if os.path.realpath(sys.executable) != os.path.realpath(SYSTEM_PYTHON):
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, *sys.argv])
    sys.exit("make_aircraft_bay.py: numpy is missing; install the package python3-numpy")

from aircraftgen import bay, solids  # noqa: E402  (numpy is looked for first)

POLYGONS = 593409
BASE_POLYGONS = 620000  # what the parts have at the detail of 1
STEPS_PER_MM = 10000    # coordinates are kept to 0.1 um: the same bytes on every machine
MIN_BLANKET = 0.002     # of all triangles


def _parts(seed, detail):
    return bay.parts(random.Random(seed), detail)


def _count(parts):
    return sum(piece.triangles for _, pieces in parts for piece in pieces)


def scene(seed, polygons):
    """Name and pieces of every part, of exactly `polygons` triangles altogether."""
    around = (polygons / BASE_POLYGONS) ** 0.5
    most = polygons - max(1, round(MIN_BLANKET * polygons))
    low, high = 0.0, 4 * around + 1
    if _count(_parts(seed, bay.Detail(around, low))) > most:
        raise ValueError(f"{polygons} triangles are too few for the bay's parts")
    for _ in range(24):  # the finest steps along that leave room for the blanket
        middle = (low + high) / 2
        if _count(_parts(seed, bay.Detail(around, middle))) <= most:
            low = middle
        else:
            high = middle
    parts = _parts(seed, bay.Detail(around, low))
    return parts + [("insulation_blanket", bay.blanket(polygons - _count(parts)))]


def write_ply(path, vertices, triangles):
    """Binary little-endian PLY."""
    header = "\n".join([
        "ply", "format binary_little_endian 1.0", "comment millimetres",
        f"element vertex {len(vertices)}", "property float x", "property float y",
        "property float z", f"element face {len(triangles)}",
        "property list uchar int vertex_indices", "end_header"]) + "\n"
    faces = np.empty(len(triangles), dtype=[("corners", "u1"), ("index", "<i4", 3)])
    faces["corners"], faces["index"] = 3, triangles
    points = np.round(vertices * STEPS_PER_MM) / STEPS_PER_MM
    with open(path, "wb") as file:
        file.write(header.encode("ascii"))
        file.write(points.astype("<f4").tobytes())
        file.write(faces.tobytes())


def write_scene(folder, parts, voxel_size, translation):
    folder.mkdir(parents=True, exist_ok=True)
    listed = []
    for name, pieces in parts:
        write_ply(folder / f"{name}.ply", *solids.joined(pieces))
        part = {"name": name, "mesh": f"{name}.ply", "units": "mm"}
        if translation is not None:
            part["translation"] = [f"{c}m" for c in translation]
        listed.append(part)
    manifest = {"voxel_size": voxel_size, "layers": 2, "parts": listed}
    (folder / "aircraft_bay.json").write_text(json.dumps(manifest, indent=1) + "\n",
                                              encoding="ascii")


def _vector(text):
    values = [float(c) for c in text.split(",")]
    if len(values) != 3:
        raise argparse.ArgumentTypeError("give X,Y,Z in meters")
    return values


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0],
                                     prog="make_aircraft_bay.py")
    parser.add_argument("folder", type=pathlib.Path, metavar="FOLDER")
    parser.add_argument("--polygons", type=int, default=POLYGONS, metavar="N",
                        help=f"triangles of the scene (default {POLYGONS})")
    parser.add_argument("--voxel-size", default="5mm", help="in the manifest (default 5mm)")
    parser.add_argument("--seed", type=int, default=1999)
    parser.add_argument("--translation", type=_vector, metavar="X,Y,Z", help="in meters")
    arguments = parser.parse_args()
    try:
        parts = scene(arguments.seed, arguments.polygons)
    except ValueError as error:
        parser.error(str(error))
    write_scene(arguments.folder, parts, arguments.voxel_size, arguments.translation)
    return 0


if __name__ == "__main__":
    sys.exit(main())
