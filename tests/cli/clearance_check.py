"""Scenes, parts and hands by seed, and the exact distances of their meshes (clearance.sh).

Usage: clearance_check.py make SEED       writes scene.json with its meshes, part.obj and motion.csv
       clearance_check.py judge SEED...   compares run_SEED.csv with the meshes of SEED
"""

import csv
import json
import sys

import numpy as np

S = 0.005  # voxel size, m
JUDGED = 60  # frames of a run


def box(half):
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
             [1, 5, 7], [1, 7, 3]]
    return corners[np.array(faces)]


def sheet(half):
    return np.array([[[-1, -1, 0], [1, -1, 0], [1, 1, 0]], [[-1, -1, 0], [1, 1, 0], [-1, 1, 0]]]) * half


def ball(radius, steps=8):
    def at(i, j):
        u, v = 2 * np.pi * i / steps, np.pi * j / (steps // 2)
        return radius * np.array([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)])
    quads = [(at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)) for i in range(steps) for j in range(steps // 2)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    area = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    return triangles[area > 1e-9 * radius ** 2]


def rotation(q):
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def turn(random):
    q = random.normal(size=4)
    return q / np.linalg.norm(q)


class Case:
    """All in meters; meshes as arrays of triangles."""

    def __init__(self, seed):
        random = np.random.default_rng(seed)
        self.objects = []
        for _ in range(random.integers(2, 5)):
            half = S * random.uniform(0.2, 8, 3)
            mesh = (box(half), sheet(half), ball(half[0] + S))[random.integers(3)]
            place = S * random.uniform(4, 13) * turn(random)[:3]
            self.objects.append(mesh @ rotation(turn(random)).T + place)
        half = S * random.uniform(0.5, 4, 3)
        foot = box(half * [1, 0.4, 0.4]) + half * [0.9, 0, 1.2]
        self.part = (box(half), ball(half[0] + S), np.concatenate([box(half), foot]))[random.integers(3)]
        # From outside through the scene and back, turning.
        places = [S * 40 * turn(random)[:3]] + [S * random.uniform(0, 20) * turn(random)[:3] for _ in range(8)]
        places[0] *= 40 * S / np.linalg.norm(places[0])
        self.hand = [(0.5 * n, *place, *turn(random)) for n, place in enumerate(places)]


def write_obj(path, triangles):
    with open(path, "w") as file:
        for corner in triangles.reshape(-1, 3):
            print("v", *(repr(float(x)) for x in corner), file=file)
        for n in range(len(triangles)):
            print("f", 3 * n + 1, 3 * n + 2, 3 * n + 3, file=file)


def make(seed):
    case = Case(seed)
    parts = []
    for n, mesh in enumerate(case.objects):
        write_obj(f"object_{n}.obj", mesh)
        parts.append({"name": f"object {n}", "mesh": f"object_{n}.obj", "units": "m"})
    json.dump({"voxel_size": "5mm", "parts": parts}, open("scene.json", "w"))
    write_obj("part.obj", case.part)
    with open("motion.csv", "w") as file:
        print("t_s,x_m,y_m,z_m,qw,qx,qy,qz", file=file)
        for row in case.hand:
            print(*(repr(float(x)) for x in row), sep=",", file=file)


def dot(a, b):
    return np.einsum("ij,ij->i", a, b)


def segment_distances(p, q, r, s):
    """Between the segments pq and rs, row by row."""
    u, v, w = q - p, s - r, p - r
    a, b, c, d, e = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    determinant = a * c - b * b
    parallel = determinant <= 1e-12 * a * c
    first = np.clip(np.where(parallel, 0, (b * e - c * d) / np.where(parallel, 1, determinant)), 0, 1)
    second = np.clip((b * first + e) / c, 0, 1)
    first = np.clip((b * second - d) / a, 0, 1)
    return np.linalg.norm(w + first[:, None] * u - second[:, None] * v, axis=1)


def corner_distances(p, t):
    """Between a place and the inside of a triangle, row by row; infinity where its foot lies outside."""
    u, v, w = t[:, 1] - t[:, 0], t[:, 2] - t[:, 0], p - t[:, 0]
    normal = np.cross(u, v)
    area2 = dot(normal, normal)
    beta, gamma = dot(np.cross(w, v), normal) / area2, dot(np.cross(u, w), normal) / area2
    inside = (beta >= 0) & (gamma >= 0) & (beta + gamma <= 1)
    return np.where(inside, np.abs(dot(w, normal)) / np.sqrt(area2), np.inf)


def distance(a, b):
    """Between two sets of triangles that do not cross."""
    def ball_around(t):
        middle = t.mean(axis=1)
        return middle, np.linalg.norm(t - middle[:, None], axis=2).max(axis=1)
    (middle_a, radius_a), (middle_b, radius_b) = ball_around(a), ball_around(b)
    apart = np.linalg.norm(middle_a[:, None] - middle_b, axis=2)
    reach = radius_a[:, None] + radius_b
    i, j = np.nonzero(apart - reach <= (apart + reach).min())
    a, b = a[i], b[j]
    found = [corner_distances(a[:, k], b) for k in range(3)] + [corner_distances(b[:, k], a) for k in range(3)]
    found += [segment_distances(a[:, k], a[:, (k + 1) % 3], b[:, m], b[:, (m + 1) % 3]) for k in range(3) for m in range(3)]
    return np.min(found)


def judge(seeds):
    slack, told, right, frames, touching = [], 0, 0, 0, 0
    for seed in seeds:
        case = Case(seed)
        rows = list(csv.DictReader(open(f"run_{seed}.csv")))
        proven = [row for row in rows if row["clearance_m"]]
        open_m = max(float(row["clearance_m"]) for row in proven)
        near = [row for row in proven if row["clearance_at_least"] == "0"]
        far = [row for row in proven if row["clearance_at_least"] == "1"]
        assert near and all(float(row["clearance_m"]) == open_m for row in far), seed
        # Evenly over the frames that are near, and some that are not.
        chosen = near[::max(1, len(near) // JUDGED)] + far[::max(1, len(far) // 8)]
        for row in chosen:
            pose = [float(row[f"part_{name}"]) for name in ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")]
            part = case.part @ rotation(pose[3:]).T + pose[:3]
            exact = [distance(part, mesh) for mesh in case.objects]
            claimed = float(row["clearance_m"])
            # 1e-9: rounding of vertices and of this file; the deviation that the bake states covers 2^-10 voxel.
            assert claimed <= min(exact) + 1e-9, (seed, row["t_s"], claimed, exact)
            frames += 1
            touching += int(row["contacts"]) > 0
            if 1.2 * S <= min(exact) < open_m:
                slack.append((min(exact) - claimed) / S)
            ordered = sorted(exact)
            if row["nearest_object"] and ordered[1] - ordered[0] > S:
                told += 1
                right += row["nearest_object"] == f"object {exact.index(ordered[0])}"
        without = [row for row in rows if not row["clearance_m"]]
        assert len(without) <= 0.01 * len(rows), (seed, len(without))
    median, high = np.quantile(slack, [0.5, 0.99])
    print(f"{frames} frames, {touching} in contact: none above the exact distance; slack of {len(slack)} in voxels: median "
          f"{median:.3f}, 99% {high:.3f}; object right {right} of {told}")
    assert frames > 40 * len(seeds) and touching > 5 * len(seeds) and len(slack) > 20 * len(seeds)
    assert median <= 0.4 and high <= 0.9
    assert told > 15 * len(seeds) and right >= 0.99 * told


if __name__ == "__main__":
    if sys.argv[1] == "make":
        make(int(sys.argv[2]))
    else:
        judge([int(seed) for seed in sys.argv[2:]])
