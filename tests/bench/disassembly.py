#!/usr/bin/env python3
"""Takes an assembly apart with voxplan: which parts come out, in which order, and how near to what.

Usage: disassembly.py BIN ASSEMBLY [--voxel-size 1mm] [--clearance 1mm] [--time 10s] [--units U] [--exact] [--parts N]

Every part that is left is tried against the others that are left; those that come out are taken away, and it is tried
again, until a round brings no part out. A line a trial, as CSV: round, part, whether it came out, seconds of the search,
poses tested, the way's length and proven clearance with the nearest object, or how far it came and what was nearest
there; the verdict of voxcheck (--exact: by the meshes; else by the files, with --felt-seat).
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile


def leaves(bin_folder, assembly, units):
    """The parts, by the names that voxelize prints."""
    listed = subprocess.run([bin_folder / "voxelize", "--list", assembly, *units], check=True, capture_output=True, text=True)
    names = [line.rsplit("  ", 1)[-1].strip() for line in listed.stdout.splitlines()[2:]]
    return [name for name in names if not any(other.startswith(name + "/") for other in names)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("assembly")
    for option, default in (("--voxel-size", "1mm"), ("--clearance", "1mm"), ("--time", "10s"), ("--units", "")):
        parser.add_argument(option, default=default)
    parser.add_argument("--exact", action="store_true")
    parser.add_argument("--parts", type=int, default=0, help="of which at most; 0: all")
    given = parser.parse_args()
    units = ["--units", given.units] if given.units else []

    def run(command, *arguments):
        return subprocess.run([given.bin / command, *map(str, arguments), "--quiet"], capture_output=True, text=True)

    left = leaves(given.bin, given.assembly, units)
    tried = left[: given.parts] if given.parts else left
    gone = []
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow("round part out search_s poses way_mm clearance_mm nearest best_mm blocked_by verdict".split())
    with tempfile.TemporaryDirectory() as folder:
        at = pathlib.Path(folder)
        for number in range(1, len(left) + 1):
            out = []
            for part in [name for name in tried if name not in gone]:
                without = [word for name in (*gone, part) for word in ("--without", name)]
                baked = run("voxelize", given.assembly, *without, "--voxel-size", given.voxel_size, *units, "-o", at / "rest.vox")
                shell = run("pointshell", f"{given.assembly}#{part}", "--voxel-size", given.voxel_size, *units,
                            "-o", at / "part.pshell")
                if baked.returncode or shell.returncode:
                    rows.writerow([number, part, "", "", "", "", "", "", "", "", (baked.stderr + shell.stderr).strip()])
                    continue
                files = (at / "rest.vox", at / "part.pshell")
                planned = run("voxplan", *files, "--clearance", given.clearance, "--time", given.time, "-o", at / "way.csv",
                              "--json", at / "way.json")
                report = json.loads((at / "way.json").read_text())
                if planned.returncode not in (0, 6):
                    rows.writerow([number, part, "", "", "", "", "", "", "", "", planned.stderr.strip()])
                    continue
                seconds, poses = f"{report['seconds']['search']:.3g}", report["poses_tested"]
                if not report["found"]:
                    best = report["best"]
                    rows.writerow([number, part, "no", seconds, poses, "", "", "", f"{1e3 * best['out_m']:.3g}",
                                   best["blocked_by"], ""])
                    sys.stdout.flush()
                    continue
                meshes = ("--exact", given.assembly, *without, "--part", f"{given.assembly}#{part}", *units)
                checked = run("voxcheck", *files, at / "way.csv", "--clearance", given.clearance, "--seat", "0,0,0m",
                              *(meshes if given.exact else ("--felt-seat",)))
                least = report["least_clearance"]
                rows.writerow([number, part, "yes", seconds, poses, f"{1e3 * report['way_m']:.4g}",
                               f"{1e3 * least['clearance_m']:.3f}", least["object"], "", "",
                               "clear" if checked.returncode == 0 else checked.stderr.strip()])
                sys.stdout.flush()
                if checked.returncode == 0:
                    out.append(part)
            gone += out
            if not out or len(gone) >= len(left) - 1:
                break


main()
