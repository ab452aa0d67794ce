#!/usr/bin/env python3
"""How much of a bake a cache saves: the generated aircraft bay baked without a cache, into an empty one, again without
a change, and after one part has been moved. Times are those of the whole command, medians over ROUNDS; every file is
compared with the bake without a cache.

    scripts/bench_cache.py build/release/bin [--rounds 5] [--voxel-size 5mm] [--part skin_panel_4] [--json FILE]
"""
import argparse
import filecmp
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--voxel-size", default="5mm")
    parser.add_argument("--part", help="the part that moves (default: each of five spread over the list)")
    parser.add_argument("--json")
    arguments = parser.parse_args()
    voxelize = os.path.abspath(os.path.join(arguments.bin, "voxelize"))
    generator = os.path.join(os.path.dirname(os.path.abspath(__file__)), "make_aircraft_bay.py")

    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, generator, folder], check=True, stdout=subprocess.DEVNULL)
        os.chdir(folder)
        with open("aircraft_bay.json") as file:
            scene = json.load(file)
        parts = [part["name"] for part in scene["parts"]]
        movers = [arguments.part] if arguments.part else [parts[len(parts) * k // 5 + 3] for k in range(5)]

        def bake(output, *more):
            start = time.monotonic()
            subprocess.run([voxelize, "scene.json", "--voxel-size", arguments.voxel_size, "-o", output, "--quiet", *more],
                           check=True)
            return time.monotonic() - start

        def write_scene(moved=None):
            changed = json.loads(json.dumps(scene))
            for part in changed["parts"]:
                if part["name"] == moved:
                    x, *rest = part.get("translation", ["0mm", "0mm", "0mm"])
                    part["translation"] = ["13mm" if x in (0, "0mm") else 0, *rest]
            with open("scene.json", "w") as file:
                json.dump(changed, file)

        def check(a, b):
            if not filecmp.cmp(a, b, shallow=False):
                sys.exit(a + " and " + b + " differ")

        times = {"plain": [], "cold": [], "unchanged": []}
        times.update({"moved " + part: [] for part in movers})
        for _ in range(arguments.rounds):
            shutil.rmtree("cache", ignore_errors=True)
            write_scene()
            times["plain"].append(bake("plain.vox"))
            times["cold"].append(bake("cold.vox", "--cache", "cache"))
            times["unchanged"].append(bake("again.vox", "--cache", "cache"))
            check("cold.vox", "plain.vox")
            check("again.vox", "plain.vox")
            for part in movers:
                write_scene()
                bake("again.vox", "--cache", "cache")
                write_scene(part)
                times["moved " + part].append(bake("moved.vox", "--cache", "cache"))
                bake("plain_moved.vox")
                check("moved.vox", "plain_moved.vox")

    medians = {name: statistics.median(values) for name, values in times.items()}
    print("%d parts, %s, medians of %d" % (len(parts), arguments.voxel_size, arguments.rounds))
    for name, seconds in medians.items():
        print("%-24s %7.3f s  %5.2f of the first with a cache  %5.2f of the bake without one"
              % (name, seconds, seconds / medians["cold"], seconds / medians["plain"]))
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump({"parts": len(parts), "voxel_size": arguments.voxel_size, "seconds": times}, file, indent=2)


if __name__ == "__main__":
    main()
