#!/usr/bin/env python3
"""Writes sample_data/: a bay of an aircraft, a pump to move through it, a hand motion, and a small
assembly with installed parts.

Usage: make_sample_data.py [FOLDER]      (default: sample_data beside scripts)

Seeded and deterministic: the same bytes on every machine. Python's standard library alone.
"""

import json
import pathlib
import random
import sys

from samplegen import bay, housing, mesh_files, motion, pump

SEED = 1999

MANIFEST = {
    "voxel_size": "5mm",
    "layers": 2,
    "parts": [
        {"name": "structure", "mesh": "structure.glb"},
        {"name": "skin", "mesh": "skin.stl", "units": "mm"},
        {"name": "floor_plate", "mesh": "floor_plate.obj", "units": "mm"},
        {"name": "bulkhead", "mesh": "bulkhead.off", "units": "mm"},
        {"name": "hydraulic_line", "mesh": "hydraulic_line.ply", "units": "mm"},
        {"name": "return_line", "mesh": "return_line.stl", "units": "mm"},
        {"name": "wires", "mesh": "wires.ply", "units": "mm"},
    ],
}


def write_sample_data(folder):
    """Writes every file of the sample data into `folder`, which is made if missing."""
    folder.mkdir(parents=True, exist_ok=True)
    bay.structure().write(folder / "structure.glb")
    mesh_files.write_stl(folder / "skin.stl", bay.skin_panel())
    mesh_files.write_obj(folder / "floor_plate.obj", bay.floor_plate(), "floor_plate")
    mesh_files.write_off(folder / "bulkhead.off", bay.bulkhead())
    mesh_files.write_ply(folder / "hydraulic_line.ply", bay.hydraulic_line())
    mesh_files.write_stl(folder / "return_line.stl", bay.return_line())
    mesh_files.write_ply(folder / "wires.ply", bay.wire_bundle(random.Random(SEED)))
    mesh_files.write_obj(folder / "part.obj", pump.pump(), "pump")
    housing.housing_assembly().write(folder / "gearbox.glb")
    (folder / "bay.json").write_text(json.dumps(MANIFEST, indent=2) + "\n", encoding="ascii")
    (folder / "press.csv").write_text(motion.motion_csv(motion.PRESS), encoding="ascii")
    (folder / "lift.csv").write_text(motion.motion_csv(motion.LIFT), encoding="ascii")


def main():
    if len(sys.argv) > 2 or sys.argv[1:] in (["-h"], ["--help"]):
        print(__doc__.strip())
        return 0 if len(sys.argv) == 2 else 2
    default = pathlib.Path(__file__).resolve().parent.parent / "sample_data"
    write_sample_data(pathlib.Path(sys.argv[1]) if len(sys.argv) == 2 else default)
    return 0


if __name__ == "__main__":
    sys.exit(main())
