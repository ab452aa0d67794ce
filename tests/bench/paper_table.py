#!/usr/bin/env python3
"""The paper's own table: what McNeely, Puterbaugh and Troy reported in 1999, and the same measured today.

Usage: paper_table.py [--bin FOLDER] [--short] [--json FILE]

Bakes the generated aircraft bay of the paper's 593,409 polygons and a part of 75 mm (the teapot of the
shared models where it is there, else the sample pump) at 5 mm; runs the sample pump against the sample bay
with ever denser shells until the 99th percentile of a step is above a millisecond. The paper's model reads Chebyshev
layers, as its paper has them, and `default` a map that voxelize writes without options. The collisions are those of
stability_bench's table2.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

import bench_scenes

VOXEL_M = 0.005
PART_M = 0.075
FRAME_NS = 1e6
BAKED = {"paper": ("--metric", "chebyshev"), "default": ()}  # what each model reads
PAPER = {"polygons": 593409, "bake_s": 70, "file_mb": 21, "part_points": 380, "points_at_1_khz": 380,
         "penetration_ratio": 70 / 69000, "penetration_ratio_braking": 6 / 108000,
         "machine": "350 MHz Pentium II; the bake on a 250 MHz R10000"}


def run(*command):
    subprocess.run([str(word) for word in command], check=True)


def scaled_obj(source, target, longest_m):
    """A copy of an OBJ whose longest side is this, in meters."""
    lines = source.read_text().splitlines()
    vertices = [[float(x) for x in line.split()[1:4]] for line in lines if line.startswith("v ")]
    scale = longest_m / max(max(axis) - min(axis) for axis in zip(*vertices))
    with open(target, "w") as file:
        for line in lines:
            if line.startswith("v "):
                x, y, z = (scale * float(word) for word in line.split()[1:4])
                line = f"v {x:.9f} {y:.9f} {z:.9f}"
            elif not line.startswith("f "):
                continue
            print(line, file=file)


def part_points(bin_folder, folder):
    """Points of the part at 5 mm: as the paper takes them, and ours."""
    teapot = bench_scenes.MODELS / "scan/teapot.obj"
    if teapot.exists():
        name, source, units = "teapot", folder / "teapot.obj", "m"
        scaled_obj(teapot, source, PART_M)
    else:
        print(f"the teapot is left out: no {teapot}; the sample pump stands in")
        name, source, units = "pump", bench_scenes.ROOT / "sample_data/part.obj", "mm"
    points = {"part": name}
    for method in ("voxel-centers", "surface"):
        run(bin_folder / "pointshell", source, "--units", units, "-o", folder / "part.pshell", "--quiet", "--voxel-size",
            f"{VOXEL_M}m", "--method", method, "--json", folder / "part.json")
        points[method] = json.loads((folder / "part.json").read_text())["points"]
    return points


def ladder(bin_folder, folder, shells):
    """Time of a step of the loop by points of the shell, both models."""
    data = bench_scenes.ROOT / "sample_data"
    for model, options in BAKED.items():
        run(bin_folder / "voxelize", data / "bay.json", "-o", folder / f"{model}.vox", "--quiet", "--voxel-size", f"{VOXEL_M}m",
            *options)
    rows = []
    for halvings in range(shells):
        run(bin_folder / "pointshell", data / "part.obj", "--units", "mm", "-o", folder / "pump.pshell", "--quiet",
            "--voxel-size", f"{VOXEL_M}m", "--covering-radius", f"{0.866 * VOXEL_M / 2 ** halvings}m", "--effort", "fast",
            "--json", folder / "pump.json")
        points = json.loads((folder / "pump.json").read_text())["points"]
        for model in BAKED:
            run(bin_folder / "voxrun", folder / f"{model}.vox", folder / "pump.pshell", "--device", "sim", "--motion",
                data / "press.csv", "--duration", "8s", "--as-fast-as-possible", "--model", model,
                "--quiet", "--json", folder / "run.json")
            report = json.loads((folder / "run.json").read_text())
            rows.append({"model": model, "target_points": 4 ** halvings, "points": points,
                         "frames": report["frames"], "force_layer_frames": report["force_layer_frames"],
                         "step_ns": report["step_ns"]})
            print(f"{model:8} {points:8} points: step p50 {report['step_ns']['p50'] / 1e3:8.1f} us, "
                  f"p99 {report['step_ns']['p99'] / 1e3:8.1f} us", flush=True)
    return rows


def points_at_1_khz(rows, model):
    """Where the 99th percentile of a step crosses a millisecond: between two shells, log to log; the
    largest shell measured, and False, where it does not."""
    of_model = [row for row in rows if row["model"] == model]
    for low, high in zip(of_model, of_model[1:]):
        a, b = low["step_ns"]["p99"], high["step_ns"]["p99"]
        if a <= FRAME_NS < b:
            share = math.log(FRAME_NS / a) / math.log(b / a)
            return {"points": round(low["points"] * (high["points"] / low["points"]) ** share), "reached": True}
    return {"points": of_model[-1]["points"], "reached": False}


def measure(arguments):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = bench_scenes.aircraft_scene(folder / "bay")
        bakes = {model: bench_scenes.bake(arguments.bin, scene, VOXEL_M, folder / "bay_of_paper.vox", 1 if arguments.short else 5,
                                          options) for model, options in BAKED.items()}
        rows = ladder(arguments.bin, folder, 5 if arguments.short else 6)
        return {"paper": PAPER,
                "bakes": {model: {key: bake[key] for key in ("triangles", "wall_s", "cpu_s", "peak_rss_bytes", "file_bytes")}
                          for model, bake in bakes.items()},
                "part": part_points(arguments.bin, folder), "steps": rows,
                "points_at_1_khz": {model: points_at_1_khz(rows, model) for model in ("paper", "default")}}


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "paper_table", bench_scenes.SHORT)
    bench_scenes.write_report("paper_table", measure(arguments), arguments.json)


if __name__ == "__main__":
    main()
