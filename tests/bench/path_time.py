#!/usr/bin/env python3
"""How long voxcheck takes for half an hour at 1 kHz.

Usage: path_time.py [--short] [--json FILE]

Bakes the generated aircraft bay at 5 mm and the sample part, lets a simulated hand lead the part a minute through the
bay from place to place (seeded; the scene holds it where it touches), and checks that way thirty times there and back:
1,800,000 poses. The shell that is checked has 100,000 points. The short form checks one minute.
"""

import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

import bench_scenes

VOXEL_M = 0.005
COVER_MM = 0.243  # of a shell of 100,000 points
SEED = 26
SPEED_MPS = 0.15


def write_motion(path, box, seconds):
    """A hand that goes from place to place in the box, from outside."""
    numbers = random.Random(SEED)
    low, high = box
    at, time_s = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2] + 0.3], 0.0
    with open(path, "w") as file:
        file.write("t_s,x_m,y_m,z_m,qw,qx,qy,qz\n")
        q = (1.0, 0.0, 0.0, 0.0)
        while True:
            file.write(f"{time_s:.3f}," + ",".join(f"{v:.6f}" for v in (*at, *q)) + "\n")
            if time_s >= seconds:
                return
            to = [max(l, min(h, a + numbers.uniform(-0.8, 0.8))) for a, l, h in zip(at, low, high)]
            time_s += max(0.5, math.dist(at, to) / SPEED_MPS)
            half, about = numbers.uniform(-0.3, 0.3), [numbers.gauss(0, 1) for _ in range(3)]
            length = math.hypot(*about)
            q = (math.cos(half), *(math.sin(half) * v / length for v in about))
            at = to


def there_and_back(minute, path, times):
    """Writes the way so often, at 1 kHz."""
    header, *lines = minute.read_text().splitlines()
    poses = [line.split(",", 1)[1] for line in lines]
    with open(path, "w") as file:
        file.write(header + "\n")
        for n in range(times):
            for i, pose in enumerate(poses if n % 2 == 0 else reversed(poses)):
                file.write(f"{(n * len(poses) + i) / 1000:.3f},{pose}\n")


def write_check(binaries, folder, times):
    """Writes bay.vox, fine.pshell and path.csv, a minute's way so often; the arguments of voxcheck for them."""
    scene = bench_scenes.aircraft_scene(folder / "bay")
    facts = bench_scenes.bake(binaries, scene, VOXEL_M, folder / "bay.vox")
    low = facts["origin_m"]
    box = (low, [l + VOXEL_M * n for l, n in zip(low, facts["dims"])])
    part = bench_scenes.ROOT / "sample_data/part.obj"
    for shell, options in (("part", []), ("fine", ["--covering-radius", f"{COVER_MM}mm"])):
        subprocess.run([binaries / "pointshell", part, "--units", "mm", "--voxel-size", f"{VOXEL_M}m", "--quiet",
                        *options, "-o", folder / f"{shell}.pshell", "--json", folder / f"{shell}.json"], check=True)
    write_motion(folder / "hand.csv", box, 60)
    subprocess.run([binaries / "voxrun", folder / "bay.vox", folder / "part.pshell", "--motion", folder / "hand.csv",
                    "--duration", "60s", "--as-fast-as-possible", "--quiet", "--save-path", folder / "minute.csv"],
                   check=True)
    there_and_back(folder / "minute.csv", folder / "path.csv", times)
    return [folder / "bay.vox", folder / "fine.pshell", folder / "path.csv"]


def main():
    args = bench_scenes.arguments(sys.modules[__name__], "path_time", bench_scenes.SHORT)
    binaries = args.bin
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        checked = write_check(binaries, folder, 1 if args.short else 30)
        points = json.loads((folder / "fine.json").read_text())["points"]
        results = []
        for clearance in ("12.7mm", "3mm"):
            for threads in (1, 2):
                usage = folder / "usage.json"
                status = subprocess.run(
                    [sys.executable, bench_scenes.ROOT / "tests/bench/measured_run.py", usage, binaries / "voxcheck",
                     *checked, "--clearance", clearance,
                     "--threads", str(threads), "--quiet", "--json", folder / "check.json"],
                    stderr=subprocess.DEVNULL, check=False).returncode
                check, used = json.loads((folder / "check.json").read_text()), json.loads(usage.read_text())
                results.append({"clearance_mm": float(clearance[:-2]), "threads": threads, "points": points,
                                "poses": check["poses"], "moments_tested": check["moments_tested"],
                                "violations": len(check["violations"]), "status": status,
                                "read_s": check["seconds"]["read"], "check_s": check["seconds"]["check"],
                                "wall_s": used["wall_s"], "cpu_s": used["cpu_s"],
                                "peak_bytes": used["peak_rss_bytes"]})
                print(results[-1])
        bench_scenes.write_report("path_time", results, args.json)


if __name__ == "__main__":
    main()
