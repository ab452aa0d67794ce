#!/usr/bin/env python3
"""Counts the triangles of mesh files from their text or bytes, by nothing that the readers use.

    face_counts.py --csv TABLE.csv FOLDER

lists each mesh file below FOLDER: its triangles, or faces of STEP and IGES, those that `voxelize --list` reads (of
FORCELAYER_BIN_DIR), and what it says.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import struct
import subprocess
import tempfile


TRIANGLES, FACES = (".obj", ".off", ".ply", ".stl", ".gltf", ".glb", ".drc"), (".step", ".stp", ".igs", ".iges")


def varint(data, at):
    value = shift = 0
    while True:
        value |= (data[at] & 127) << shift
        shift, at = shift + 7, at + 1
        if data[at - 1] < 128:
            return value, at


def of_off(text):
    text = re.sub(r"^\s*OFF", "OFF ", text)
    words = [row for row in (line.split("#")[0].split() for line in text.splitlines()) if row]
    counts, rows = (words[1], words[2:]) if len(words[0]) == 1 else (words[0][1:], words[1:])
    vertices, polygons = map(int, counts[:2])
    flat = [word for row in rows for word in row]
    at, total = 3 * vertices, 0  # vertices of three numbers; polygons without colors
    if any(len(row) != 3 for row in rows[:vertices]) or len(rows) != vertices + polygons:
        for _ in range(polygons):
            total, at = total + int(flat[at]) - 2, at + 1 + int(flat[at])
        return total
    return sum(int(row[0]) - 2 for row in rows[vertices:])


PLY_TYPES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
             "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d", "float64": "d"}


def of_strip(corners):
    """Triangles of strips that -1 ends."""
    total = length = 0
    for corner in [*corners, -1]:
        length = 0 if corner == -1 else length + 1
        total += length >= 3
    return total


def of_ply(data):
    end = data.index(b"end_header")
    header = data[:end].decode("latin-1").split("\n")
    body = data.index(b"\n", end) + 1
    elements = []
    for line in header:
        words = line.split()
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        if words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    is_text = "ascii" in header[1]
    order = ">" if "big" in header[1] else "<"
    words = iter(data[body:].split()) if is_text else None

    def number(kind):
        nonlocal body
        if is_text:
            return float(next(words))
        (value,) = struct.unpack_from(order + PLY_TYPES[kind], data, body)
        body += struct.calcsize(PLY_TYPES[kind])
        return value

    total = 0
    for element, count, properties in elements:
        for _ in range(count):
            for name in properties:
                if name[0] != "list":
                    number(name[0])
                    continue
                values = [number(name[2]) for _ in range(int(number(name[1])))]
                if element == "face" and name[3] in ("vertex_indices", "vertex_index"):
                    total += len(values) - 2 if values else 0
                if element == "tristrips":
                    total += of_strip(values)
    return total


def of_gltf(data):
    if data[:4] == b"glTF":
        document = json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])
    else:
        document = json.loads(data)

    def of_primitive(primitive):
        accessor = primitive.get("indices", primitive["attributes"].get("POSITION"))
        count = document["accessors"][accessor]["count"]
        return {4: count // 3, 5: max(count - 2, 0), 6: max(count - 2, 0)}.get(primitive.get("mode", 4), 0)

    def of_node(node):
        node = document["nodes"][node]
        own = sum(map(of_primitive, document["meshes"][node["mesh"]]["primitives"])) if "mesh" in node else 0
        return own + sum(map(of_node, node.get("children", [])))

    if not document.get("scenes"):
        return 0
    return sum(map(of_node, document["scenes"][document.get("scene", 0)].get("nodes", [])))


def of_draco(data):
    """Draco 2.2 without metadata: the faces; with edgebreaker a byte and the vertices before them."""
    if data[:5] != b"DRACO" or data[5:7] != b"\x02\x02" or data[7] != 1 or data[10] & 0x80:
        return None
    return varint(data, varint(data, 12)[1] if data[8] == 1 else 11)[0]


def count(path):
    """Triangles; for STEP and IGES faces. None where this script cannot tell."""
    data = pathlib.Path(path).read_bytes()
    text = data.decode("latin-1")
    kind = pathlib.Path(path).suffix.lower()
    if kind == ".obj":
        lines = re.sub(r"\\\r?\n", " ", text).splitlines()
        return sum(len(line.split("#")[0].split()) - 3 for line in lines if line.split()[:1] == ["f"])
    if kind == ".off":
        return of_off(text)
    if kind == ".ply":
        return of_ply(data)
    if kind == ".stl":
        return text.lower().count("endfacet") or (struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else 0)
    if kind in (".gltf", ".glb"):
        return of_gltf(data)
    if kind == ".drc":
        return of_draco(data)
    if kind in (".step", ".stp"):
        return len(re.findall(r"=\s*ADVANCED_FACE", text))
    lines = text.splitlines()
    return len([line for line in lines if line[72:73] == "D" and int(line[73:80]) % 2 == 1 and int(line[:8]) in (144, 510)])


def read_by_voxelize(path, folder):
    """Triangles, or None, and what is said."""
    report = folder / "list.json"
    report.unlink(missing_ok=True)
    voxelize = pathlib.Path(os.environ.get("FORCELAYER_BIN_DIR", pathlib.Path(__file__).parents[2] / "build/release/bin")) / "voxelize"
    run = subprocess.run([voxelize, path, "--list", "--json", report], capture_output=True, text=True)
    said = run.stderr.strip().replace(str(path) + ": ", "").replace("voxelize: ", "")
    return (json.loads(report.read_text())["files"][0]["whole"]["triangles"] if run.returncode == 0 else None), said


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", required=True)
    parser.add_argument("folder", type=pathlib.Path)
    arguments = parser.parse_args()
    rows, differ = [], 0
    with tempfile.TemporaryDirectory() as scratch:
        for path in sorted(arguments.folder.rglob("*")):
            if path.suffix.lower() not in TRIANGLES + FACES:
                continue
            counted = count(path)
            read, said = read_by_voxelize(path, pathlib.Path(scratch))
            counts = "faces" if path.suffix.lower() in FACES else "triangles"
            rows.append({"file": path.relative_to(arguments.folder), "counts": counts, "counted": counted, "triangles_read": read,
                         "said": said})
            differ += counts == "triangles" and counted not in (None, read) and not (read is None and said)
    with open(arguments.csv, "w", newline="") as out:
        writer = csv.DictWriter(out, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    unknown = sum(row["counted"] is None for row in rows)
    print(f"{len(rows)} files: {differ} with other triangles and without an error, {unknown} of a kind that is not counted here")


if __name__ == "__main__":
    main()
