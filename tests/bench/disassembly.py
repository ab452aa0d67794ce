#!/usr/bin/env python3
"""Takes assemblies apart with forcelayer disassemble: the parts that come out, and how near they come to what.

Usage: disassembly.py [--short] [--bin FOLDER] [--json FILE]

A row is a step, or a part that is left, with the seconds of the whole command. --short takes the gearbox alone.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import bench_scenes

ASSEMBLIES = {  # by name: file, options
    "gearbox": (bench_scenes.ROOT / "sample_data/gearbox.glb", []),
    "as1": (bench_scenes.MODELS / "cad/as1-oc-214.stp", []),
    "engine": (bench_scenes.MODELS / "cad/2CylinderEngine.glb", ["--units", "mm"])}


def rows(bin_folder, name, folder):
    path, options = ASSEMBLIES[name]
    ended = subprocess.run([bin_folder / "forcelayer", "disassemble", path, *options, "-o", folder, "--quiet"])
    if ended.returncode not in (0, 6, 7):
        sys.exit(f"disassembly.py: {name}: status {ended.returncode}")
    sequence = json.loads((folder / "sequence.json").read_text())
    for number, step in enumerate(sequence["steps"], 1):
        yield {"assembly": name, "step": number, "parts": " + ".join(step["parts"]), "settled_by": step["settled_by"],
               "length_m": step["path_length_m"], "clearance_m": step["clearance_m"], "nearest": step["nearest"],
               "blocked_by": None, "seconds": sequence["seconds"]}
    for left in sequence["left"]:
        yield {"assembly": name, "step": None, "parts": left["part"], "settled_by": None, "length_m": None,
               "clearance_m": None, "nearest": None, "blocked_by": ", ".join(left["blocked_by"]),
               "seconds": sequence["seconds"]}


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "disassembly", bench_scenes.SHORT)
    results = []
    for name in ["gearbox"] if arguments.short else ASSEMBLIES:
        if not ASSEMBLIES[name][0].exists():
            print(f"{name} left out: no {ASSEMBLIES[name][0]}")
            continue
        with tempfile.TemporaryDirectory() as folder:
            for row in rows(arguments.bin.resolve(), name, pathlib.Path(folder)):
                results.append(row)
                print(row, flush=True)
    bench_scenes.write_report("disassembly", results, arguments.json)


if __name__ == "__main__":
    main()
