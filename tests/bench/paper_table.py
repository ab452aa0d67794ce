#!/usr/bin/env python3
"""The paper's own table: what McNeely, Puterbaugh and Troy reported in 1999, and the same measured today.

Usage: paper_table.py [--bin FOLDER] [--short] [--collisions FILE] [--json FILE]
       paper_table.py --table JSON      prints the table of a report in Markdown

Bakes the generated aircraft bay of the paper's 593,409 polygons and a part of 75 mm (the teapot of the
shared models where it is there, else the sample pump) at 5 mm; runs the sample pump against the sample bay
with ever denser shells until the 99th percentile of a step is above a millisecond; and takes the collisions
from stability_bench's table2.
"""

import argparse
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
PAPER = {"polygons": 593409, "bake_s": 70, "file_mb": 21, "part_points": 380, "points_at_1_khz": 380,
         "penetration_ratio": 70 / 69000, "penetration_ratio_braking": 6 / 108000,
         "machine": "350 MHz Pentium II; the bake on a 250 MHz R10000"}


def run(*command):
    subprocess.run([str(word) for word in command], check=True)


def scaled_obj(source, target, longest_m):
    """A copy of an OBJ whose longest side is this, in metres."""
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


def ladder(bin_folder, folder, short):
    """Time of a step of the loop by points of the shell, both models."""
    data = bench_scenes.ROOT / "sample_data"
    run(bin_folder / "voxelize", data / "bay.json", "-o", folder / "bay.vox", "--quiet", "--voxel-size", f"{VOXEL_M}m")
    rows = []
    for halvings in range(0, 5 if short else 6):
        run(bin_folder / "pointshell", data / "part.obj", "--units", "mm", "-o", folder / "pump.pshell", "--quiet",
            "--voxel-size", f"{VOXEL_M}m", "--covering-radius", f"{0.866 * VOXEL_M / 2 ** halvings}m", "--effort", "fast",
            "--json", folder / "pump.json")
        points = json.loads((folder / "pump.json").read_text())["points"]
        for model in ("paper", "default"):
            run(bin_folder / "voxrun", folder / "bay.vox", folder / "pump.pshell", "--device", "sim", "--motion",
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


def collisions(path):
    table = json.loads(path.read_text())["results"]
    return {row: {key: table[row][key] for key in ("penetration_ratio", "penetration_ratio_95", "force_layer_frames",
                                                   "trials")}
            for row in ("paper, no braking", "paper, braking", "default")}


def measure(arguments):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = bench_scenes.aircraft_scene(folder / "bay")
        bake = bench_scenes.bake(arguments.bin, scene, VOXEL_M, folder / "bay_of_paper.vox", 1 if arguments.short else 5)
        rows = ladder(arguments.bin, folder, arguments.short)
        return {"paper": PAPER,
                "bake": {key: bake[key] for key in ("triangles", "wall_s", "cpu_s", "peak_rss_bytes", "file_bytes")},
                "part": part_points(arguments.bin, folder), "steps": rows,
                "points_at_1_khz": {model: points_at_1_khz(rows, model) for model in ("paper", "default")},
                "collisions": collisions(arguments.collisions)}


def ratio_with_interval(row):
    low, high = row["penetration_ratio_95"]
    frames = f"{row['force_layer_frames'] / 1e6:.1f} million frames"
    if row["penetration_ratio"] == 0:
        return f"0 (below {high:.0e}) in {frames}"
    return f"{row['penetration_ratio']:.3f} ({low:.3f} to {high:.3f}) in {frames}"


def count(measured):
    number = format(float(format(measured["points"], ".2g")), ",.0f")
    return number if measured["reached"] else f"more than {number}"


def table(report):
    r, own = report["results"], report["results"]["paper"]
    bake, part, hit = r["bake"], r["part"], r["collisions"]
    rows = [("", "1999", "today, the paper's model", "today, `default`"),
            ("---", "---:", "---:", "---:"),
            (f"bake of {bake['triangles']:,} polygons at 5 mm", f"{own['bake_s']} s",
             f"{bake['wall_s']:.2f} s", "the same"),
            ("file", f"{own['file_mb']} MB", f"{bake['file_bytes'] / 1e6:.1f} MB", "the same"),
            (f"points of a part of 75 mm ({part['part']})", f"{own['part_points']}", f"{part['voxel-centers']}",
             f"{part['surface']}"),
            ("points at 1 kHz (99th percentile of a step below 1 ms)", f"{own['points_at_1_khz']}",
             count(r["points_at_1_khz"]["paper"]), count(r["points_at_1_khz"]["default"])),
            ("penetration ratio, no braking (95%)", f"{own['penetration_ratio']:.4f}",
             ratio_with_interval(hit["paper, no braking"]), ""),
            ("penetration ratio (95%)", f"{own['penetration_ratio_braking']:.5f}",
             ratio_with_interval(hit["paper, braking"]), ratio_with_interval(hit["default"]))]
    return ["| " + " | ".join(row) + " |" if row[0] != "---" else "|" + "|".join(row) + "|" for row in rows]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], prog="paper_table.py")
    results = bench_scenes.results_folder()
    parser.add_argument("--bin", type=pathlib.Path, default=bench_scenes.ROOT / "build/release/bin")
    parser.add_argument("--short", action="store_true", help="one repetition, shorter runs, fewer shells")
    parser.add_argument("--collisions", type=pathlib.Path, default=results / "stability_table2.json")
    parser.add_argument("--json", type=pathlib.Path, default=results / "paper_table.json")
    parser.add_argument("--table", type=pathlib.Path, metavar="JSON", help="print the table of this report")
    arguments = parser.parse_args()
    if not arguments.table:
        bench_scenes.write_report("paper_table", measure(arguments), arguments.json)
    print("\n".join(table(json.loads((arguments.table or arguments.json).read_text()))))


if __name__ == "__main__":
    main()
