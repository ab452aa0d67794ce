#!/usr/bin/env python3
"""Takes assemblies apart with voxplan: the parts that come out, their order, and how near they come to what.

Usage: disassembly.py [--short] [--bin FOLDER] [--json FILE]

Every part that is left is tried against the others that are left, small ones first. A part whose path voxcheck confirms
is taken away at once. Rounds go on until one brings no part out. A part that lies deeper in others than the stored
distances reach is tried with greater ones (--range). A part that is nearer to others in its seat than the clearance
asked for is tried with a clearance of 0, and where not even that is proven, with smaller voxels. A row is a part in a
round: the last trial, and the verdict of voxcheck (by the meshes, or by the files with --felt-seat). --short takes the
gearbox alone.
"""

import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

import bench_scenes

RANGES = (4, 10, 30)  # voxels
SMALLER = (1, 1 / 2, 1 / 4)  # voxels, tried one after the other
SEARCH = "8s"
# By name: file, unit, voxel size in mm, clearance, whether the meshes decide.
ASSEMBLIES = {
    "gearbox": (bench_scenes.ROOT / "sample_data/gearbox.glb", [], 1, "0.5mm", True),
    "as1": (bench_scenes.MODELS / "cad/as1-oc-214.stp", [], 1, "0.3mm", False),
    "engine": (bench_scenes.MODELS / "cad/2CylinderEngine.glb", ["--units", "mm"], 2, "0.5mm", False)}


def leaves(bin_folder, assembly, units):
    """The parts, by the names that voxelize prints; those with the smallest boxes first: bolts before what they hold."""
    listed = subprocess.run([bin_folder / "voxelize", "--list", assembly, *units], check=True, capture_output=True, text=True)
    lines = listed.stdout.splitlines()[2:]
    names = [line.rsplit("  ", 1)[-1].strip() for line in lines]
    box = dict(zip(names, (re.search(r"([0-9.e+]+) x ([0-9.e+]+) x ([0-9.e+]+)", line) for line in lines)))
    found = [name for name in names if not any(other.startswith(name + "/") for other in names)]
    return sorted(found, key=lambda name: math.prod(float(edge) for edge in box[name].groups()))


class Assembly:
    def __init__(self, bin_folder, name, at):
        self.bin, self.at = bin_folder, at
        self.path, self.units, self.voxel_mm, self.clearance, self.exact = ASSEMBLIES[name]
        self.gone = []

    def run(self, command, *arguments):
        return subprocess.run([self.bin / command, *map(str, arguments), "--quiet"], capture_output=True, text=True)

    def said(self, process):
        return process.stderr.strip().replace(f"{self.at}/", "")

    def attempt(self, part, clearance, depth, voxel):
        """The row of one trial; and why it was refused, or an empty text."""
        at, size = self.at, ("--voxel-size", f"{voxel:g}mm")
        row = {"out": "", "asked_mm": float(clearance[:-2]), "range_mm": depth * voxel, "voxel_mm": voxel, "search_s": None,
               "poses": None, "way_mm": None, "clearance_mm": None, "nearest": None, "best_mm": None, "blocked_by": None,
               "verdict": None}
        without = [word for name in (*self.gone, part) for word in ("--without", name)]
        for command in (["pointshell", f"{self.path}#{part}", *size, *self.units, "-o", at / "part.pshell"],
                        ["voxelize", self.path, *without, *size, *self.units, "--range", f"{depth * voxel:g}mm",
                         "--cache", at / "cache", "-o", at / "rest.vox"]):
            baked = self.run(*command)
            if baked.returncode:
                return row, self.said(baked)
        files = (at / "rest.vox", at / "part.pshell")
        planned = self.run("voxplan", *files, "--clearance", clearance, "--time", SEARCH, "-o", at / "way.csv",
                           "--json", at / "way.json")
        if planned.returncode not in (0, 6):
            return row, self.said(planned)
        report = json.loads((at / "way.json").read_text())
        row.update(search_s=report["seconds"]["search"], poses=report["poses_tested"])
        if not report["found"]:
            best = report["best"]
            row.update(out="no", best_mm=1e3 * best["out_m"], blocked_by=", ".join(best["blocked_by"]))
            return row, ""
        meshes = ("--exact", self.path, *without, "--part", f"{self.path}#{part}", *self.units)
        checked = self.run("voxcheck", *files, at / "way.csv", "--clearance", clearance, "--seat", "0,0,0m",
                           *(meshes if self.exact else ("--felt-seat",)))
        least = report["min_clearance"]
        row.update(out="yes", way_mm=1e3 * report["length_m"], clearance_mm=1e3 * least["clearance_m"], nearest=least["object"],
                   verdict="clear" if checked.returncode == 0 else self.said(checked))
        return row, ""

    def outcome(self, part):
        depths, voxels, clearance = list(RANGES), [self.voxel_mm * fraction for fraction in SMALLER], self.clearance
        while True:
            row, refused = self.attempt(part, clearance, depths[0], voxels[0])
            near = "than --clearance" in refused
            if "--range" in refused and len(depths) > 1:
                depths.pop(0)
            elif near and clearance != "0mm":
                clearance = "0mm"
            elif near and len(voxels) > 1:
                voxels.pop(0)
            else:
                return {**row, "verdict": refused or row["verdict"]}

    def rows(self):
        left = leaves(self.bin, self.path, self.units)
        for number in range(1, len(left) + 1):
            before = len(self.gone)
            for part in [name for name in left if name not in self.gone]:
                if len(self.gone) == len(left) - 1:
                    return
                row = self.outcome(part)
                yield {"round": number, "part": part, **row}
                if row["out"] == "yes" and row["verdict"] == "clear":
                    self.gone.append(part)
            if len(self.gone) == before:
                return


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "disassembly", bench_scenes.SHORT)
    rows = []
    for name in ["gearbox"] if arguments.short else ASSEMBLIES:
        if not ASSEMBLIES[name][0].exists():
            print(f"{name} left out: no {ASSEMBLIES[name][0]}")
            continue
        with tempfile.TemporaryDirectory() as folder:
            for row in Assembly(arguments.bin.resolve(), name, pathlib.Path(folder)).rows():
                rows.append({"assembly": name, **row})
                print(rows[-1], flush=True)
    bench_scenes.write_report("disassembly", rows, arguments.json)


if __name__ == "__main__":
    main()
