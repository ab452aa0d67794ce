#!/usr/bin/env python3
"""Runs the loop for a long time while the machine is busy, and replays the run.

Usage: bench_loop.py [--minutes 30] [--bin build/release/bin] [--out build/loop_bench]

Bakes the sample scene and part, lets the sample's hand press for as long as wanted at 1 kHz with every
core kept busy by a niced loop, and repeats the recording as fast as possible: the same outcome, bit
for bit, says that no state was lost. Writes OUT/loop.json: what voxrun reports of its clock, and the
machine. How it measures: tests/bench/METHOD.md.
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAUSE_S = 0.5  # of the hand between two rounds
KEPT = """frames force_layer_frames penetration_frames contact_frames guard_cuts step_ns tick_ns wakeup_ns
deadline_misses miss_causes worst_frames skipped_ticks dropped_frames minor_faults major_faults
voluntary_switches involuntary_switches steal_s wall_s output_trips last_trip max_device_force_n
energy_generated_j peak_rss_bytes outcome_hash warnings parameters""".split()


def write_motion(path, seconds):
    """The sample's motion, over and over."""
    header, *rows = (ROOT / "sample_data/press.csv").read_text().splitlines()
    rows = [row.split(",", 1) for row in rows]
    begin = float(rows[0][0])
    round_s = float(rows[-1][0]) - begin + PAUSE_S
    with open(path, "w") as file:
        print(header, file=file)
        for n in range(int(seconds / round_s) + 1):
            for t, pose in rows:
                print(f"{n * round_s + float(t) - begin:.6f},{pose}", file=file)


def run(binaries, out, minutes):
    data = ROOT / "sample_data"
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
    subprocess.run([binaries / "voxrun", "bay.vox", "part.pshell", "--device", "replay", "--replay",
                    "run.flr", "--as-fast-as-possible", "--json", "replay.json", "--quiet"],
                   cwd=out, check=True)


def machine():
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo")
                if line.startswith("model name")), platform.machine())
    return {"cpu": cpu, "cores": os.cpu_count(), "virtual": " hypervisor" in open("/proc/cpuinfo").read(),
            "system": f"{platform.system()} {platform.release()} {platform.version()}",
            "date": datetime.datetime.utcnow().strftime("%Y-%m-%dT%H:%M:%SZ")}


def report(out, command):
    """From the files of a run in `out`."""
    ran, again = (json.loads((out / name).read_text()) for name in ("voxrun.json", "replay.json"))
    accounted = sum(ran["miss_causes"].values())
    results = {key: ran[key] for key in KEPT}
    results["replay_is_the_same"] = ran["outcome_hash"] == again["outcome_hash"]
    results["misses_accounted_for"] = accounted == ran["deadline_misses"]
    (out / "loop.json").write_text(json.dumps(
        {"benchmark": "loop", "command": command, "machine": machine(), "results": results},
        indent=2) + "\n")
    print(f"{ran['frames']} frames, {ran['deadline_misses']} deadline misses, {accounted} accounted for, "
          f"replay {'the same' if results['replay_is_the_same'] else 'DIFFERS'}")
    print(f"wrote {out / 'loop.json'}")
    return results["replay_is_the_same"] and results["misses_accounted_for"]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/loop_bench")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    run(options.bin.resolve(), options.out, options.minutes)
    sys.exit(0 if report(options.out, f"scripts/bench_loop.py --minutes {options.minutes:g}") else 1)


if __name__ == "__main__":
    main()
