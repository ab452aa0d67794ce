#!/usr/bin/env python3
"""The forecasts of `voxelize --plan` beside the bakes themselves: file size and time.

Usage: plan_bench.py [--bin FOLDER] [--repeat N] [--json FILE]

For the sample scene, the models of ../shared/models at 512 voxels across and the generated aircraft bay at 5 mm, and the
half and the quarter of these sizes. Prints a table and writes JSON. The plan is asked for --repeat times, as the bakes are, and
the least of its times counts, as theirs does.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import bench_scenes

ACROSS = 512


def plan(bin_folder, scene, voxel_size_m, folder, repeat):
    report = folder / "plan.json"
    command = [bin_folder / "voxelize", scene.path, "--plan", "--quiet", "--json", report, "--voxel-size",
               f"{voxel_size_m:.9g}m"]
    if scene.units:
        command += ["--units", scene.units]
    best = None
    for _ in range(repeat):
        subprocess.run(command, check=True)
        sizes = json.loads(report.read_text())["plan"]
        best = best or sizes
        for a, b in zip(best, sizes):
            a["bake_s"] = min(a["bake_s"], b["bake_s"])
    return best


def compare(bin_folder, scene, voxel_size_m, folder, repeat):
    for size in plan(bin_folder, scene, voxel_size_m, folder, repeat):
        facts = bench_scenes.bake(bin_folder, scene, size["voxel_size_m"], folder / "plan.vox", repeat)
        seconds = facts["seconds"]
        row = {"scene": scene.name, "voxel_size_m": size["voxel_size_m"], "planned_bytes": size["file_bytes"],
               "file_bytes": facts["file_bytes"], "planned_s": size["bake_s"],
               "bake_s": seconds["total"] - seconds["read"]}
        row["bytes_ratio"] = row["planned_bytes"] / row["file_bytes"]
        row["time_ratio"] = row["planned_s"] / row["bake_s"]
        print(f"{row['scene']:9} {row['voxel_size_m'] * 1e3:9.4g} {row['planned_bytes'] / 1e6:9.2f} "
              f"{row['file_bytes'] / 1e6:9.2f} {row['bytes_ratio']:6.2f} {row['planned_s'] * 1e3:9.0f} "
              f"{row['bake_s'] * 1e3:9.0f} {row['time_ratio']:6.2f}", flush=True)
        yield row


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "bake_plan", bench_scenes.REPEAT)
    print(f"{'scene':9} {'voxel mm':>9} {'plan MB':>9} {'file MB':>9} {'ratio':>6} {'plan ms':>9} {'bake ms':>9} "
          f"{'ratio':>6}")
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scenes = [(bench_scenes.sample_scene(), 0.01), (bench_scenes.aircraft_scene(folder / "bay"), 0.005)]
        scenes += [(scene, scene.longest_m / ACROSS) for scene in bench_scenes.model_scenes()]
        for scene, voxel_size_m in scenes:
            rows += compare(arguments.bin, scene, voxel_size_m, folder, arguments.repeat)
    for key, what in (("bytes_ratio", "size"), ("time_ratio", "time")):
        ratios = [row[key] for row in rows]
        print(f"planned {what}: {min(ratios):.2f} to {max(ratios):.2f} of the true one")
    bench_scenes.write_report("bake_plan", rows, arguments.json)


if __name__ == "__main__":
    main()
