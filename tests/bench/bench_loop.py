#!/usr/bin/env python3
"""Runs the loop for a long time while the machine is busy, and replays the run.

Usage: bench_loop.py [--minutes 30] [--bin FOLDER] [--out build/loop_bench] [--json FILE]

Bakes the sample scene and part, lets the sample's hand press for as long as wanted at 1 kHz with every
core kept busy by a niced loop, and repeats the recording as fast as possible: the same outcome, bit
for bit, says that no state was lost. Writes JSON: what voxrun reports of its clock, and the machine.
"""

import json
import os
import pathlib
import subprocess
import sys

import bench_scenes

PAUSE_S = 0.5  # of the hand between two rounds
KEPT = """frames force_layer_frames penetration_frames guard_cuts deadline_misses skipped_ticks dropped_frames
minor_faults major_faults involuntary_switches steal_s wall_s output_trips max_device_force_n peak_rss_bytes""".split()


def write_motion(path, seconds):
    """The sample's motion, over and over."""
    header, *rows = (bench_scenes.ROOT / "sample_data/press.csv").read_text().splitlines()
    rows = [row.split(",", 1) for row in rows]
    begin = float(rows[0][0])
    round_s = float(rows[-1][0]) - begin + PAUSE_S
    with open(path, "w") as file:
        print(header, file=file)
        for n in range(int(seconds / round_s) + 1):
            for t, pose in rows:
                print(f"{n * round_s + float(t) - begin:.6f},{pose}", file=file)


def run(binaries, out, minutes):
    data = bench_scenes.ROOT / "sample_data"
    write_motion(out / "motion.csv", 60 * minutes)
    for command in (
            ["voxelize", data / "bay.json", "-o", "bay.vox", "--voxel-size", "5mm", "--quiet"],
            ["pointshell", data / "part.obj", "--units", "mm", "-o", "part.pshell", "--voxel-size",
             "5mm", "--quiet"]):
        subprocess.run([binaries / command[0], *command[1:]], cwd=out, check=True)
    busy = [subprocess.Popen(["nice", "-n", "19", sys.executable, "-c", "while True: pass"])
            for _ in range(os.cpu_count())]
    try:
        subprocess.run([binaries / "voxrun", "bay.vox", "part.pshell", "--device", "sim", "--motion",
                        "motion.csv", "--duration", f"{60 * minutes}s", "--record", "run.flr", "--udp",
                        "7999", "--json", "voxrun.json"], cwd=out, check=True)
    finally:
        for process in busy:
            process.kill()
    subprocess.run([binaries / "voxrun", "bay.vox", "part.pshell", "--replay",
                    "run.flr", "--as-fast-as-possible", "--json", "replay.json", "--quiet"],
                   cwd=out, check=True)


def report(out):
    """Rows from the files of a run in `out`, and whether all is well."""
    ran, again = (json.loads((out / name).read_text()) for name in ("voxrun.json", "replay.json"))
    accounted = sum(ran["miss_causes"].values())
    same = ran["outcome_hash"] == again["outcome_hash"]
    print(f"{ran['frames']} frames, {ran['deadline_misses']} deadline misses, {accounted} accounted for, "
          f"replay {'the same' if same else 'DIFFERS'}")
    figures = {**{key: ran[key] for key in KEPT}, "replay_is_the_same": same,
               **{f"misses: {cause}": misses for cause, misses in ran["miss_causes"].items()},
               **{f"{clock}_{key}_us": value / 1e3 for clock in ("step", "tick", "wakeup")
                  for key, value in ran[f"{clock}_ns"].items()}}
    return [{"figure": key, "value": value} for key, value in figures.items()], same and accounted == ran["deadline_misses"]


def main():
    options = bench_scenes.arguments(
        sys.modules[__name__], "loop", ("--minutes", {"type": float, "default": 30}),
        ("--out", {"type": pathlib.Path, "default": bench_scenes.ROOT / "build/loop_bench"}))
    options.out.mkdir(parents=True, exist_ok=True)
    run(options.bin.resolve(), options.out, options.minutes)
    rows, well = report(options.out)
    bench_scenes.write_report("loop", rows, options.json)
    sys.exit(0 if well else 1)


if __name__ == "__main__":
    main()
