#!/usr/bin/env python3
"""Names, boxes and volumes of the parts of STEP assemblies, as voxelize and pointshell read them and as gmsh does.

    step_gmsh.py --csv TABLE.csv [FILE.step...]

Without files: the assembly of make_step_assembly in millimeter, inch and meter. Needs gmsh (Debian: gmsh), and voxelize,
pointshell and make_step_assembly in FORCELAYER_BIN_DIR. Each part is matched with the solid whose box is nearest to its own, and no
solid is matched twice. gmsh's name of it, by the C interface of its library, is the path of products and their instances: a label
of ours must be one of the two at its level ("[2]" of a second one apart). gmsh's boxes are exact for parts of planes and circles, as the assembly has;
around spline curves they are loose, so boxes of FILEs are those of gmsh's own triangles.
"""
import argparse
import ctypes.util
import csv
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BIN = pathlib.Path(os.environ.get("FORCELAYER_BIN_DIR", pathlib.Path(__file__).parents[2] / "build/release/bin"))


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=300)


def gmsh_solids(path, is_of_triangles, folder):
    """Boxes (low, high) and volumes of all solids, mm."""
    script = folder / "ask.geo"
    script.write_text(
        'SetFactory("OpenCASCADE");\nGeometry.OCCTargetUnit = "MM";\n'
        f'Geometry.OCCBoundsUseStl = {int(is_of_triangles)};\n'
        f'v() = ShapeFromFile("{path}");\nv() = Volume{{:}};\n'
        "For i In {0:#v()-1}\n  b() = BoundingBox Volume{v(i)};\n  m() = Mass Volume{v(i)};\n"
        '  Printf("solid %.12g %.12g %.12g %.12g %.12g %.12g %.12g", b(0), b(1), b(2), b(3), b(4), b(5), m(0));\nEndFor\n')
    answer = run("gmsh", "-0", script)
    lines = re.findall(r"solid ([-0-9.e+ ]+)", answer.stdout)
    if not lines:
        sys.exit(f"gmsh found no solid in {path}: {answer.stdout[-500:]}{answer.stderr[-500:]}")
    numbers = [[float(x) for x in line.split()] for line in lines]
    return [(row[:6], row[6]) for row in numbers]


NAMES = """
import ctypes, json, sys
library, error = ctypes.CDLL(sys.argv[1]), ctypes.c_int()
def call(function, *arguments):
    getattr(library, function)(*arguments, ctypes.byref(error))
    assert error.value == 0, function
call("gmshInitialize", 0, None, 1)
call("gmshOptionSetNumber", b"General.Terminal", ctypes.c_double(0))
call("gmshOptionSetNumber", b"Geometry.OCCImportLabels", ctypes.c_double(1))
call("gmshOpen", sys.argv[2].encode())
tags, count, names = ctypes.POINTER(ctypes.c_int)(), ctypes.c_size_t(), []
call("gmshModelGetEntities", ctypes.byref(tags), ctypes.byref(count), 3)
for n in range(1, count.value, 2):
    name = ctypes.c_char_p()
    call("gmshModelGetEntityName", 3, tags[n], ctypes.byref(name))
    names.append(name.value.decode())
print(json.dumps(names))
"""


def gmsh_names(path):
    """The names of all solids, in the order of gmsh_solids()."""
    library = ctypes.util.find_library("gmsh") or "libgmsh.so.4.8"
    return json.loads(run(sys.executable, "-c", NAMES, library, path).stdout)


def is_same_name(ours, theirs):
    """'clamp/rod_1' and 'Shapes/clamp/rod_1/rod'."""
    labels, names = ours.split("/"), theirs.split("/")[1:]
    pairs = [names[:1]] + [names[n:n + 2] for n in range(1, len(names), 2)]
    return len(labels) == len(pairs) and all(
        re.sub(r"\[\d+\]$", "", label) in pair for label, pair in zip(labels, pairs))


def our_parts(path, folder):
    """Boxes by node, mm, of the nodes that are one part."""
    report = folder / "list.json"
    if run(BIN / "voxelize", path, "--list", "--json", report).returncode != 0:
        sys.exit(f"voxelize --list {path} failed")
    nodes = json.loads(report.read_text())["files"][0]["nodes"]
    names = [node["node"] for node in nodes]
    leaves = [n for n in nodes if not any(other.startswith(n["node"] + "/") for other in names)]
    return {n["node"]: [1e3 * x for x in n["low_m"] + n["high_m"]] for n in leaves}


def our_volume_mm3(path, node, size_mm, folder):
    report = folder / "shell.json"
    answer = run(BIN / "pointshell", f"{path}#{node}", "--voxel-size", f"{size_mm / 20}mm", "--effort", "fast", "--quiet",
                 "-o", folder / "part.pshell", "--json", report)
    if answer.returncode != 0:
        sys.exit(f"pointshell {path}#{node}: {answer.stderr}")
    return 1e9 * json.loads(report.read_text())["volume_m3"]


def rows_of(name, path, is_of_triangles, folder):
    solids = [(*solid, theirs) for solid, theirs in zip(gmsh_solids(path, is_of_triangles, folder), gmsh_names(path))]
    parts = our_parts(path, folder)
    if len(solids) != len(parts):
        sys.exit(f"{name}: {len(parts)} parts, {len(solids)} solids of gmsh")
    for node, box in parts.items():
        distance = lambda solid: max(abs(a - b) for a, b in zip(box, solid[0]))
        nearest = min(solids, key=distance)
        solids.remove(nearest)
        size = max(box[n + 3] - box[n] for n in range(3))
        volume = our_volume_mm3(path, node, size, folder)
        yield {"file": name, "node": node, "same_name": int(is_same_name(node, nearest[2])), "size_mm": f"{size:.6g}", "box_difference_mm": f"{distance(nearest):.3g}",
               "volume_mm3": f"{volume:.7g}", "gmsh_volume_mm3": f"{nearest[1]:.7g}",
               "volume_difference": f"{volume / nearest[1] - 1:.2g}"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*")
    parser.add_argument("--csv", required=True)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        files = [(pathlib.Path(f).name, pathlib.Path(f).resolve()) for f in arguments.files]
        for unit in [] if files else ["MM", "INCH", "M"]:
            path = folder / f"clamp_{unit.lower()}.step"
            run(BIN / "make_step_assembly", path, unit)
            files.append((path.name, path))
        rows = [row for name, path in files for row in rows_of(name, path, bool(arguments.files), folder)]
    with open(arguments.csv, "w", newline="") as out:
        writer = csv.DictWriter(out, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    worst_box = max(float(r["box_difference_mm"]) / float(r["size_mm"]) for r in rows)
    worst_volume = max(abs(float(r["volume_difference"])) for r in rows)
    same = sum(row["same_name"] for row in rows)
    print(f"{len(rows)} parts: {same} names are the same, boxes differ by at most {worst_box:.2g} of their size, volumes by {worst_volume:.2g}")


if __name__ == "__main__":
    main()
