#!/usr/bin/env python3
"""Takes an assembly apart with voxplan: which parts come out, in which order, and how near to what.

Usage: disassembly.py BIN ASSEMBLY [--voxel-size 1mm] [--clearance 0.5mm] [--time 10s] [--units U] [--exact] [--parts N]

Every part that is left is tried against the others that are left, small ones first; one that comes out is taken away at once, and it is
tried again, until a round brings no part out. A part that lies deeper in others than the stored distances tell is tried
with ever deeper ones (--range); one that is nearer to others in its seat than the clearance asked for is tried with
none, and where not even that is proven with smaller voxels. A line a trial, as CSV: round, part, whether it came out,
the clearance asked for, the range and the voxel size, seconds of the search, poses tested, the way's length and proven
clearance with the nearest object, its sharpest corners, or how far it came and what was nearest there; the verdict of voxcheck (--exact: by the meshes; else by the files, with --felt-seat).
"""

import argparse
import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

RANGES = (4, 10, 30)  # voxels
SMALLER = (1, 1 / 2, 1 / 4)  # voxels, tried one after the other


def leaves(bin_folder, assembly, units):
    """The parts, by the names that voxelize prints; those with the smallest boxes first: bolts before what they hold."""
    listed = subprocess.run([bin_folder / "voxelize", "--list", assembly, *units], check=True, capture_output=True, text=True)
    lines = listed.stdout.splitlines()[2:]
    names = [line.rsplit("  ", 1)[-1].strip() for line in lines]
    box = dict(zip(names, (re.search(r"([0-9.e+]+) x ([0-9.e+]+) x ([0-9.e+]+)", line) for line in lines)))
    found = [name for name in names if not any(other.startswith(name + "/") for other in names)]
    return sorted(found, key=lambda name: math.prod(float(edge) for edge in box[name].groups()))


def product(p, q):
    a, b, c, d = p
    e, f, g, h = q
    return (a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f,
            a * h + b * g - c * f + d * e)


def corners(path, shell):
    """The sharpest corner of a way, degrees, and the most degrees a millimeter of the shorter leg beside a corner.

    A leg is the way of the part's centroid, and its turn times the part's radius."""
    rows = [[float(cell) for cell in row[1:8]] for row in list(csv.reader(open(path)))[1:]]
    legs = []
    for a, b in zip(rows, rows[1:]):
        centers = []
        for row in (a, b):
            q, back = row[3:], [row[3], -row[4], -row[5], -row[6]]
            turned = product(product(q, [0, *shell["center_m"]]), back)[1:]
            centers.append([x + y for x, y in zip(row, turned)])
        turn = product(b[3:], [a[3], -a[4], -a[5], -a[6]])
        sine = math.hypot(*turn[1:])
        angle = 2 * math.atan2(sine, abs(turn[0])) * (1 if turn[0] >= 0 else -1)
        arm = [angle * shell["bounding_radius_m"] * x / sine if sine > 0 else 0 for x in turn[1:]]
        leg = [q - p for p, q in zip(*centers)] + arm
        if math.hypot(*leg) > 1e-9:
            legs.append(leg)
    sharpest = steepest = 0
    for a, b in zip(legs, legs[1:]):
        cosine = sum(p * q for p, q in zip(a, b)) / math.hypot(*a) / math.hypot(*b)
        corner = math.degrees(math.acos(max(-1, min(1, cosine))))
        sharpest = max(sharpest, corner)
        steepest = max(steepest, corner / (1e3 * min(math.hypot(*a), math.hypot(*b))))
    return sharpest, steepest


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("assembly")
    for option, default in (("--voxel-size", "1mm"), ("--clearance", "0.5mm"), ("--time", "10s"), ("--units", "")):
        parser.add_argument(option, default=default)
    parser.add_argument("--exact", action="store_true")
    parser.add_argument("--parts", type=int, default=0, help="of which at most; 0: all")
    given = parser.parse_args()
    units = ["--units", given.units] if given.units else []
    voxel_mm = float(given.voxel_size.removesuffix("mm"))

    def run(command, *arguments):
        return subprocess.run([given.bin / command, *map(str, arguments), "--quiet"], capture_output=True, text=True)

    left = leaves(given.bin, given.assembly, units)
    tried = left[: given.parts] if given.parts else left
    gone = []
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow("round part out asked_mm range_mm voxel_mm search_s poses way_mm clearance_mm nearest corner_deg deg_per_mm best_mm blocked_by verdict".split())

    def attempt(at, part, clearance, depth, voxel):
        """The outcome of one trial, as the columns from `out` on; why it was refused, or an empty text."""
        size = ("--voxel-size", f"{voxel:g}mm")
        shell = run("pointshell", f"{given.assembly}#{part}", *size, *units, "-o", at / "part.pshell")
        if shell.returncode:
            return [], shell.stderr.strip()
        without = [word for name in (*gone, part) for word in ("--without", name)]
        baked = run("voxelize", given.assembly, *without, *size, *units, "--range", f"{depth * voxel:g}mm",
                    "--cache", at / "cache", "-o", at / "rest.vox")
        if baked.returncode:
            return [], baked.stderr.strip()
        files = (at / "rest.vox", at / "part.pshell")
        planned = run("voxplan", *files, "--clearance", clearance, "--time", given.time, "-o", at / "way.csv",
                      "--json", at / "way.json")
        if planned.returncode not in (0, 6):
            return [], planned.stderr.strip().replace(f"{at}/", "")
        report = json.loads((at / "way.json").read_text())
        asked = [clearance.removesuffix("mm"), f"{depth * voxel:g}", f"{voxel:g}", f"{report['seconds']['search']:.3g}",
                 report["poses_tested"]]
        if not report["found"]:
            best = report["best"]
            return ["no", *asked, "", "", "", "", "", f"{1e3 * best['out_m']:.3g}", ", ".join(best["blocked_by"]), ""], ""
        meshes = ("--exact", given.assembly, *without, "--part", f"{given.assembly}#{part}", *units)
        checked = run("voxcheck", *files, at / "way.csv", "--clearance", clearance, "--seat", "0,0,0m",
                      *(meshes if given.exact else ("--felt-seat",)))
        least = report["least_clearance"]
        run("voxinfo", files[1], "--json", at / "part.json")
        shape = json.loads((at / "part.json").read_text())
        verdict = "clear" if checked.returncode == 0 else checked.stderr.strip().replace(f"{at}/", "")
        return ["yes", *asked, f"{1e3 * report['way_m']:.4g}", f"{1e3 * least['clearance_m']:.3f}", least["object"],
                *(f"{figure:.2g}" for figure in corners(at / "way.csv", shape)), "", "", verdict], ""

    def outcome(at, part):
        depths, voxels, clearance = list(RANGES), [voxel_mm * share for share in SMALLER], given.clearance
        while True:
            row, refused = attempt(at, part, clearance, depths[0], voxels[0])
            if row:
                return row
            if "--range" in refused and len(depths) > 1:
                depths.pop(0)
            elif "nearer there than --clearance" in refused and clearance != "0mm":
                clearance = "0mm"
            elif "nearer there than --clearance" in refused and len(voxels) > 1:
                voxels.pop(0)
            else:
                return ["", clearance.removesuffix("mm"), f"{depths[0] * voxels[0]:g}", f"{voxels[0]:g}",
                        "", "", "", "", "", "", "", "", "", refused]

    with tempfile.TemporaryDirectory() as folder:
        at = pathlib.Path(folder)
        for number in range(1, len(left) + 1):
            before = len(gone)
            for part in [name for name in tried if name not in gone]:
                if len(gone) == len(left) - 1:
                    return
                row = outcome(at, part)
                rows.writerow([number, part, *row])
                sys.stdout.flush()
                if row[0] == "yes" and row[-1] == "clear":
                    gone.append(part)
            if len(gone) == before:
                return


main()
