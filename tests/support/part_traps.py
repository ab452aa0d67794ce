#!/usr/bin/env python3
"""Time and memory of pointshell for parts that took too much, beside its forecast.

    part_traps.py --csv TABLE.csv --bin FOLDER... [--parts NAME...] [--models DIR] [--within FACTOR]

Each FOLDER holds a pointshell; its name in the table is what stands before an '=' (before=build/old/bin). The parts are made here;
the engine is that of DIR (../shared/models). A run that takes longer than ten minutes is ended. With --within the status
is 1 where the points or the memory that a bake told before it began are off by more than this factor.
"""
import argparse
import csv
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
LIMIT_S = 600


def write_stl(path, triangles):
    with open(path, "wb") as out:
        out.write(bytes(80) + struct.pack("<I", len(triangles)))
        for a, b, c in triangles:
            out.write(struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0))


def write_glb(path, document, binary):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    path.write_bytes(b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(binary)) + struct.pack("<I", len(text)) + b"JSON" + text +
                     struct.pack("<I", len(binary)) + b"BIN\0" + binary)


def turned(profile, segments):
    """The surface that a profile of (radius, height) sweeps about z."""
    ring = lambda radius, height: [(radius * math.cos(2 * math.pi * k / segments), radius * math.sin(2 * math.pi * k / segments), height)
                                   for k in range(segments)]
    rings = [ring(*row) for row in profile]
    triangles = []
    for low, high in zip(rings, rings[1:]):
        for k in range(segments):
            m = (k + 1) % segments
            triangles += [t for t in ((low[k], low[m], high[m]), (low[k], high[m], high[k])) if len(set(t)) == 3]
    return triangles


def box(low, high):
    corner = lambda n: tuple(high[axis] if n >> axis & 1 else low[axis] for axis in range(3))
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return [tuple(corner(face[n]) for n in order) for face in faces for order in ((0, 1, 2), (0, 2, 3))]


def make_grooves(folder, _):
    """A plate of 200 mm with ten thousand grooves along it, 0.015 mm deep; voxels of 2.4 mm."""
    side, grooves, depth, height = 200, 10000, 0.015, 10
    ridge = [(0.5 * n * side / grooves, height - depth * (n % 2)) for n in range(2 * grooves + 1)]
    middle, triangles = side / 2, []
    for (a, low), (b, high) in zip(ridge, ridge[1:]):
        triangles += [((a, 0, low), (b, 0, high), (b, side, high)), ((a, 0, low), (b, side, high), (a, side, low)),
                      ((a, 0, low), (middle, 0, 0), (b, 0, high)), ((b, side, high), (middle, side, 0), (a, side, low))]
    for y, order in ((0, 1), (side, -1)):
        ends = [((0, y, height), (0, y, 0), (middle, y, 0)), ((side, y, height), (middle, y, 0), (side, y, 0))]
        triangles += [t[::order] for t in ends]
    triangles += [t for t in box((0, 0, 0), (side, side, height)) if all(c[0] == 0 for c in t) or all(c[0] == side for c in t)]
    for low, high in ((0, middle), (middle, side)):
        triangles += [((low, 0, 0), (low, side, 0), (high, side, 0)), ((low, 0, 0), (high, side, 0), (high, 0, 0))]
    write_stl(folder / "grooves.stl", triangles)
    return [folder / "grooves.stl", "--units", "mm", "--voxel-size", "2.4mm"]


def make_threads(folder, _):
    """A bolt, 40 mm by 200 mm, with a thousand grooves 0.1 mm deep; voxels of 1.5 mm."""
    profile = [(0, 0)] + [(20 - 0.1 * (n % 2), 0.1 * n) for n in range(2001)] + [(0, 200)]
    write_stl(folder / "threads.stl", turned(profile, 96))
    return [folder / "threads.stl", "--units", "mm", "--voxel-size", "1.5mm"]


def write_bodies(path, bodies):
    """An assembly with a mesh for each body, whose corners are in mm."""
    meshes, binary = [], b""
    accessors, views, nodes = [], [], []
    for n, triangles in enumerate(bodies):
        corners = [c for t in triangles for c in t]
        data = b"".join(struct.pack("<3f", *(1e-3 * x for x in c)) for c in corners)
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        accessors.append({"bufferView": n, "componentType": 5126, "count": len(corners), "type": "VEC3"})
        meshes.append({"primitives": [{"attributes": {"POSITION": n}}]})
        nodes.append({"mesh": n, "name": f"body{n}"})
        binary += data
    write_glb(path, {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "meshes": meshes,
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(binary)}]}, binary)


def make_touching(folder, _):
    """Fifty-six cubes of 20 mm, each touching its neighbors; voxels of 2 mm."""
    bodies = [box((20 * i, 20 * j, 20 * k), (20 * i + 20, 20 * j + 20, 20 * k + 20))
              for i in range(7) for j in range(4) for k in range(2)]
    write_bodies(folder / "touching.glb", bodies)
    return [folder / "touching.glb", "--voxel-size", "2mm"]


def write_boxes(path, shared):
    """Three thousand boxes of 6 mm, 20 mm apart, each with a mesh of its own or all with one."""
    meshes, binary, accessors, views, nodes = [], b"", [], [], []
    for n in range(3000):
        at = (20 * (n % 15), 20 * (n // 15 % 20), 20 * (n // 300))
        if not shared or not meshes:
            low = (0, 0, 0) if shared else at
            corners = [c for t in box(low, tuple(x + 6 for x in low)) for c in t]
            data = b"".join(struct.pack("<3f", *(1e-3 * x for x in c)) for c in corners)
            views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
            accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": len(corners), "type": "VEC3"})
            meshes.append({"primitives": [{"attributes": {"POSITION": len(views) - 1}}]})
            binary += data
        nodes.append({"mesh": len(meshes) - 1, "name": f"box{n}"})
        if shared:
            nodes[-1]["translation"] = [1e-3 * x for x in at]
    write_glb(path, {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "meshes": meshes,
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(binary)}]}, binary)


def make_bodies(folder, _):
    """Three thousand boxes of 6 mm; voxels of 2 mm."""
    write_boxes(folder / "bodies.glb", False)
    return [folder / "bodies.glb", "--voxel-size", "2mm"]


def make_overlapping(folder, _):
    """Eight balls of 22 mm, 12 mm apart, so that half of their surface is inside others; voxels of 0.55 mm, one thread."""
    profile = [(0 if n in (0, 24) else 11 * math.sin(math.pi * n / 24), -11 * math.cos(math.pi * n / 24)) for n in range(25)]
    bodies = [[tuple(tuple(c + 12 * (n >> axis & 1) for axis, c in enumerate(corner)) for corner in t) for t in turned(profile, 50)]
              for n in range(8)]
    write_bodies(folder / "overlapping.glb", bodies)
    return [folder / "overlapping.glb", "--voxel-size", "0.55mm", "--threads", "1"]


def make_copies(folder, _):
    """Three thousand places of one box of 6 mm; voxels of 2 mm."""
    write_boxes(folder / "copies.glb", True)
    return [folder / "copies.glb", "--voxel-size", "2mm"]


def make_fan(folder, _):
    """A disc of 200 mm in 20,000 slivers about its middle; voxels of 1 mm."""
    rim = [(100 * math.cos(2 * math.pi * k / 20000), 100 * math.sin(2 * math.pi * k / 20000), 0) for k in range(20000)]
    write_stl(folder / "fan.stl", [((0, 0, 0), a, b) for a, b in zip(rim, rim[1:] + rim[:1])])
    return [folder / "fan.stl", "--units", "mm", "--voxel-size", "1mm"]


def make_solid(folder, _):
    """A block of 200 x 150 x 100 mm; voxels of 2 mm."""
    write_stl(folder / "solid.stl", box((0, 0, 0), (200, 150, 100)))
    return [folder / "solid.stl", "--units", "mm", "--voxel-size", "2mm"]


def make_ball(folder, _):
    """A ball of 200 mm in 25,000 triangles; voxels of 3 mm."""
    profile = [(0 if n in (0, 79) else 100 * math.sin(math.pi * n / 79), -100 * math.cos(math.pi * n / 79)) for n in range(80)]
    write_stl(folder / "ball.stl", turned(profile, 157))
    return [folder / "ball.stl", "--units", "mm", "--voxel-size", "3mm"]


def make_engine(_, models):
    """An engine of 121,496 triangles; voxels of 10 mm."""
    return [models / "cad/2CylinderEngine.glb", "--units", "mm", "--voxel-size", "10mm"]


def make_instances(folder, models):
    """Sixty-four engines of 121,496 triangles, 8 by 8; voxels of 20 mm."""
    data = (models / "cad/2CylinderEngine.glb").read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + length])
    binary = data[28 + length:]
    single, roots = document["nodes"], document["scenes"][document.get("scene", 0)]["nodes"]
    nodes, tops = [], []
    for n in range(64):
        first = len(nodes)
        for node in single:
            own = dict(node)
            own.pop("camera", None)
            if "children" in own:
                own["children"] = [first + child for child in own["children"]]
            nodes.append(own)
        tops.append({"name": f"engine{n}", "children": [first + root for root in roots],
                     "translation": [1000 * (n % 8), 1000 * (n // 8), 0]})
    document["scenes"] = [{"nodes": list(range(len(nodes), len(nodes) + 64))}]
    document["scene"], document["nodes"] = 0, nodes + tops
    write_glb(folder / "instances.glb", document, binary)
    return [folder / "instances.glb", "--units", "mm", "--voxel-size", "20mm"]


def make_stray(folder, _):
    """A ball of 100 mm in triangles of 2 mm, of which one vertex is a kilometer away; voxels of 5 mm."""
    rings = 79
    profile = [(0 if n in (0, rings) else 50 * math.sin(math.pi * n / rings), -50 * math.cos(math.pi * n / rings)) for n in range(rings + 1)]
    triangles = turned(profile, 157)
    stray = triangles[len(triangles) // 2][0]
    write_stl(folder / "stray.stl", [tuple((1e6, 0, 0) if c == stray else c for c in t) for t in triangles])
    return [folder / "stray.stl", "--units", "mm", "--voxel-size", "5mm"]


PARTS = {"grooves": make_grooves, "threads": make_threads, "touching": make_touching, "instances": make_instances, "stray": make_stray,
         "bodies": make_bodies, "copies": make_copies, "overlapping": make_overlapping,
         "fan": make_fan, "solid": make_solid, "ball": make_ball, "engine": make_engine}


def row_of(part, name, binary, call, folder):
    report, usage, shell = folder / "report.json", folder / "usage.json", folder / "part.pshell"
    for path in (report, usage, shell):
        path.unlink(missing_ok=True)
    command = ["timeout", str(LIMIT_S), str(pathlib.Path(binary) / "pointshell"), *map(str, call), "-o", str(shell), "--json", str(report)]
    run = subprocess.run([sys.executable, str(HERE.parent / "bench/measured_run.py"), str(usage), *command], capture_output=True, text=True)
    took = json.loads(usage.read_text())
    facts = json.loads(report.read_text()) if report.exists() else {}
    expected = facts.get("expected", {})
    stages = facts.get("seconds", {})
    told = lambda key, unit: f"{expected[key] / unit:.3g}" if expected else ""
    row = {"part": part, "program": name, "status": run.returncode, "cpu_s": f"{took['cpu_s']:.3g}",
           "peak_mb": f"{took['peak_rss_bytes'] / 1e6:.0f}", "triangles": facts.get("triangles", ""), "points": facts.get("points", ""),
           "certificate_pieces": facts.get("certificate_pieces", ""), "told_cpu_s": told("thread_s", 1), "told_mb": told("bytes", 1e6),
           "told_points": told("points", 1), "points_s": stages.get("points", ""),
           "hidden_s": sum(stages.get(stage, 0) for stage in ("hidden", "corners", "weights"))}
    print(row, file=sys.stderr)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", required=True)
    parser.add_argument("--bin", nargs="+", required=True)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--models", type=pathlib.Path, default=HERE.parents[2] / "shared/models")
    parser.add_argument("--within", type=float)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        rows = []
        for part in arguments.parts:
            call = PARTS[part](folder, arguments.models)
            rows += [row_of(part, *(program.split("=", 1) if "=" in program else ("now", program)), call, folder)
                     for program in arguments.bin]
    with open(arguments.csv, "w", newline="") as out:
        writer = csv.DictWriter(out, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    if arguments.within:
        off = [f"{row['part']}: {row[key]} beside {row[told]} told as {told}" for row in rows
               for key, told in (("points", "told_points"), ("peak_mb", "told_mb"))
               if not 1 / arguments.within <= float(row[told]) / float(row[key]) <= arguments.within]
        sys.exit("\n".join(off) or 0)


if __name__ == "__main__":
    main()
