#!/usr/bin/env python3
"""How bake, pointshell, voxcheck and the contact query scale with the cores of a machine.

Usage: cores.py [--bin FOLDER] [--short] [--repeat N] [--json FILE]

Each task runs with 1, 2, 4, 8, ... threads, up to one for each core; the same bytes or answers every time (a difference
ends the run). Commands are processes of their own, of which the least time counts, of one run where that is long; the query
is the median of its frames.
--short: smaller scenes and fewer frames. Prints a table and writes JSON.
"""

import hashlib
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import bench_scenes
import path_time

POLYGONS = 10_500_000
ENOUGH_S = 8  # for the runs of a command with so many threads
MOTIONS = ("wall", "tight fit", "everything")


def thread_counts():
    return [n for n in (1, 2, 4, 8, 16, 32, 64) if n <= os.cpu_count()]


def run(command, report, folder):
    """Seconds by the clock and of processors, and the stages that the command reports."""
    usage = folder / "usage.json"
    status = subprocess.run([sys.executable, bench_scenes.ROOT / "tests/bench/measured_run.py", usage, *command, "--quiet",
                             "--json", report], stderr=subprocess.DEVNULL, check=False).returncode
    used, told = json.loads(usage.read_text()), json.loads(report.read_text())
    if status not in (0, 6):  # 6: voxcheck found a violation
        sys.exit(f"{command[0].name} ended with status {status}")
    return {"wall_s": used["wall_s"], "cpu_s": used["cpu_s"],
            "stages": {k: v for k, v in told.get("seconds", {}).items() if k != "total"}}


def answer(path):
    """The bytes of a baked file, or what a check found."""
    if path.suffix != ".json":
        return hashlib.sha256(path.read_bytes()).hexdigest()
    told = json.loads(path.read_text())
    return told["moments_tested"], len(told["violations"])


def scaled(task, command, output, repeat, folder):
    first = None
    for threads in thread_counts():
        best, spent_s = None, 0
        for n in range(repeat):
            if n > 0 and spent_s > ENOUGH_S:
                break
            one = run([*command, "--threads", str(threads)], folder / "report.json", folder)
            spent_s += one["wall_s"]
            best = one if best is None or one["wall_s"] < best["wall_s"] else best
            found = answer(output)
            if first not in (None, found):
                sys.exit(f"{task}: another answer with {threads} threads")
            first = found
        for stage, seconds in best["stages"].items():
            yield {"task": task, "stage": stage, "threads": threads, "wall_s": seconds, "cpu_s": None}
        yield {"task": task, "stage": "whole", "threads": threads, "wall_s": best["wall_s"], "cpu_s": best["cpu_s"]}


def bakes(binaries, folder, short, repeat):
    bay = bench_scenes.aircraft_scene(folder / "large", 1_200_000 if short else POLYGONS)
    scenes = [(bay, 0.005 if short else 0.002)]
    scenes += [(scene, scene.longest_m / (256 if short else 1024)) for scene in bench_scenes.model_scenes() if scene.name == "engine"]
    for scene, voxel_m in scenes:
        out = folder / "scene.vox"
        command = [binaries / "voxelize", scene.path, "-o", out, "--voxel-size", f"{voxel_m:.9g}m"]
        yield from scaled(f"voxelize: {scene.name}", command + (["--units", scene.units] if scene.units else []), out, repeat, folder)


def shells(binaries, folder, short, repeat):
    for scene in bench_scenes.model_scenes():
        if scene.name not in ("dragon", "counter"):
            continue
        out = folder / "part.pshell"
        yield from scaled(f"pointshell: {scene.name}",
                          [binaries / "pointshell", scene.path, "--units", scene.units, "--voxel-size",
                           f"{scene.longest_m / (128 if short else 512):.9g}m", "-o", out], out, repeat, folder)


def check(binaries, folder, short, repeat):
    command = [binaries / "voxcheck", *path_time.write_check(binaries, folder, 1 if short else 30), "--clearance", "12.7mm"]
    yield from scaled("voxcheck: half an hour", command, folder / "report.json", repeat, folder)


def queries(binaries, folder, short):
    report = folder / "query.json"
    points = "100000" if short else "1000000"
    command = [binaries / "query_bench", "--from", points, "--largest", points, "--seconds", "0.1" if short else "1",
               "--our-seconds", "0.1" if short else "1", "--no-peers", "--json", report]
    for motion in MOTIONS:
        command += ["--motion", motion]
    for threads in thread_counts()[1:]:
        command += ["--threads", str(threads)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    for row in json.loads(report.read_text())["results"]:
        words = row["method"].split(", ")
        if words[0] == "all skipping" and (len(words) == 1 or words[1].endswith(" threads")):
            yield {"task": f"query: {row['motion']}", "stage": "whole",
                   "threads": int(words[1].split()[0]) if len(words) > 1 else 1, "wall_s": row["p50_us"] / 1e6, "cpu_s": None}


def main():
    args = bench_scenes.arguments(sys.modules[__name__], "cores", bench_scenes.SHORT, bench_scenes.REPEAT)
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        common = (args.bin, folder, args.short)
        for part in (bakes(*common, args.repeat), shells(*common, args.repeat), check(*common, args.repeat), queries(*common)):
            for row in part:
                rows.append(row)
                used = "" if row["cpu_s"] is None else f"{row['cpu_s'] / row['wall_s']:6.2f} cores"
                print(f"{row['task']:28} {row['stage']:10} {row['threads']:3} threads {row['wall_s']:11.6f} s {used}", flush=True)
    bench_scenes.write_report("cores", rows, args.json)


if __name__ == "__main__":
    main()
