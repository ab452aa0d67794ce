"""Checks the solids of sample_data with readers of its own: every component of every mesh is
closed, consistently oriented and of positive volume. Prints a line per solid; exit status 1 on
the first fault."""

import collections
import json
import pathlib
import struct
import sys


def read_stl(path):
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    assert len(data) == 84 + 50 * count, path
    corners = [struct.unpack_from("<9f", data, 84 + 50 * n + 12) for n in range(count)]
    return [(c[0:3], c[3:6], c[6:9]) for c in corners]


def read_obj(path):
    rows = [line.split() for line in path.read_text().splitlines()]
    vertices = [tuple(map(float, r[1:])) for r in rows if r[0] == "v"]
    return [tuple(vertices[int(n) - 1] for n in r[1:]) for r in rows if r[0] == "f"]


def read_off(path):
    words = path.read_text().split()
    vertex_count, face_count = int(words[1]), int(words[2])
    numbers = list(map(float, words[4:4 + 3 * vertex_count]))
    faces = list(map(int, words[4 + 3 * vertex_count:]))
    assert len(faces) == 4 * face_count, path
    return [tuple(tuple(numbers[3 * v:3 * v + 3]) for v in faces[4 * n + 1:4 * n + 4])
            for n in range(face_count)]


def read_ply(path):
    header, body = path.read_bytes().split(b"end_header\n", 1)
    counts = [int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element")]
    assert len(body) == 12 * counts[0] + 13 * counts[1], path
    vertices = list(struct.iter_unpack("<3f", body[:12 * counts[0]]))
    return [tuple(vertices[n] for n in face[1:])
            for face in struct.iter_unpack("<B3i", body[12 * counts[0]:])]


def read_glb(path):
    """Name and triangles of every instance, placed in the scene."""
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data, 0)
    assert (magic, version, length) == (b"glTF", 2, len(data)), path
    text_bytes = struct.unpack_from("<I", data, 12)[0]
    gltf = json.loads(data[20:20 + text_bytes])
    binary = data[28 + text_bytes:]
    solids = []

    def visit(index, place):
        node = gltf["nodes"][index]
        here = (lambda p: place(placed(node, p)))
        if "mesh" in node:
            mesh = gltf["meshes"][node["mesh"]]
            solids.append((node["name"], [tuple(here(p) for p in t)
                                          for t in mesh_triangles(gltf, binary, mesh)]))
        for child in node.get("children", []):
            visit(child, here)

    for root in gltf["scenes"][0]["nodes"]:
        visit(root, lambda p: p)
    return solids


def mesh_triangles(gltf, binary, mesh):
    def items(accessor_index, form):
        accessor = gltf["accessors"][accessor_index]
        view = gltf["bufferViews"][accessor["bufferView"]]
        size = struct.calcsize(form)
        return [struct.unpack_from(form, binary, view["byteOffset"] + n * size)
                for n in range(accessor["count"])]

    primitive = mesh["primitives"][0]
    points = items(primitive["attributes"]["POSITION"], "<3f")
    corners = [n for (n,) in items(primitive["indices"], "<H")]
    return [tuple(points[n] for n in corners[t:t + 3]) for t in range(0, len(corners), 3)]


def placed(node, point):
    """The node's rotation, then its translation."""
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    translation = node.get("translation", (0, 0, 0))
    return tuple(sum(r * c for r, c in zip(row, point)) + t for row, t in zip(rows, translation))


def components(triangles):
    """Lists of triangles that hang together by common corners."""
    parent = {}

    def root(p):
        while parent.setdefault(p, p) != p:
            parent[p] = parent[parent[p]]
            p = parent[p]
        return p

    for a, b, c in triangles:
        parent[root(a)] = root(b)
        parent[root(b)] = root(c)
    groups = collections.defaultdict(list)
    for triangle in triangles:
        groups[root(triangle[0])].append(triangle)
    return list(groups.values())


def volume(triangles):
    return sum(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
               + a[2] * (b[0] * c[1] - b[1] * c[0]) for a, b, c in triangles) / 6


def check(name, triangles, unit_mm):
    """Each directed edge once, its opposite once, positive volume."""
    edges = collections.Counter()
    for a, b, c in triangles:
        assert len({a, b, c}) == 3, f"{name}: a triangle with two equal corners"
        edges.update(((a, b), (b, c), (c, a)))
    for (p, q), uses in edges.items():
        assert uses == 1, f"{name}: edge {p} {q} is used {uses} times in one direction"
        assert (q, p) in edges, f"{name}: edge {p} {q} is open"
    cm3 = volume(triangles) * unit_mm ** 3 / 1000
    assert cm3 > 0, f"{name}: volume {cm3} cm3"
    extent = [(max(p[n] for t in triangles for p in t) - min(p[n] for t in triangles for p in t))
              * unit_mm for n in range(3)]
    print(f"{name}: {len(triangles)} triangles, {cm3:.2f} cm3, "
          + " x ".join(f"{e:.1f}" for e in extent) + " mm")


READERS = {".stl": read_stl, ".obj": read_obj, ".off": read_off, ".ply": read_ply}


def main():
    folder = pathlib.Path(sys.argv[1])
    checked = 0
    for path in sorted(folder.iterdir()):
        solids, unit_mm = [], 1
        if path.suffix == ".glb":
            solids, unit_mm = read_glb(path), 1000
        elif path.suffix in READERS:
            solids = [(path.name, READERS[path.suffix](path))]
        for name, triangles in solids:
            for group in components(triangles):
                check(name, group, unit_mm)
                checked += 1
    # 7 wires, 3 frames, 2 beams, 6 posts, 12 brackets and the 6 other files; a housing, its cover, 4
    # bolts, a pin and 2 halves of a clip.
    assert checked == 45, f"{checked} solids"


if __name__ == "__main__":
    main()
