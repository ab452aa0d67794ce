"""aircraft_bay_check.py FOLDER TRIANGLES: the scene in FOLDER has exactly so many triangles in more than
a hundred parts, and every part but the one open sheet is closed, consistently oriented and of positive
volume. Exit status 1 on the first fault."""

import json
import pathlib
import sys

import numpy as np


def read_ply(path):
    data = path.read_bytes()
    body = data.index(b"end_header\n") + len(b"end_header\n")
    vertex_count, face_count = (int(line.split()[2]) for line in data[:body].splitlines()
                                if line.startswith(b"element"))
    vertices = np.frombuffer(data, "<f4", 3 * vertex_count, body).reshape(-1, 3)
    faces = np.frombuffer(data, [("corners", "u1"), ("index", "<i4", 3)], face_count,
                          body + 12 * vertex_count)
    assert len(data) == body + 12 * vertex_count + 13 * face_count, path
    return vertices.astype(float), faces["index"].astype(np.int64)


def check_closed(name, vertices, triangles):
    """Each directed edge once, and its opposite once."""
    starts, ends = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    there = np.sort(starts * len(vertices) + ends)
    back = np.sort(ends * len(vertices) + starts)
    assert np.all(np.diff(there) > 0), f"{name}: an edge is used twice in one direction"
    assert np.array_equal(there, back), f"{name}: an open edge"


def check_solid(name, vertices, triangles):
    a, b, c = (vertices[triangles[:, n]] - vertices.mean(axis=0) for n in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    assert area.min() > 0, f"{name}: a triangle without area"
    assert np.sum(a * np.cross(b, c)) > 0, f"{name}: inside out"


def main():
    folder = pathlib.Path(sys.argv[1])
    parts = json.loads((folder / "aircraft_bay.json").read_text())["parts"]
    assert len(parts) > 100, len(parts)
    total = 0
    for part in parts:
        vertices, triangles = read_ply(folder / part["mesh"])
        total += len(triangles)
        if part["name"] == "insulation_blanket":
            continue
        check_closed(part["name"], vertices, triangles)
        check_solid(part["name"], vertices, triangles)
    assert total == int(sys.argv[2]), f"{total} triangles"


if __name__ == "__main__":
    main()
