#!/usr/bin/env python3
"""The meshes that assembly_bench writes: closed, and of the volumes that their formulas give, computed here anew.

Usage: assembly_meshes.py BIN_FOLDER. Exit status: 0 they are, 1 not, 2 wrong usage.
"""

import collections
import math
import pathlib
import subprocess
import sys
import tempfile

FACES = 96
POLYGON = math.sin(2 * math.pi / FACES) / (2 * math.pi / FACES)  # area of the polygon within a circle over the circle's
PITCH, MAJOR = 2.5, 10.0
HEIGHT = math.sqrt(3) / 2 * PITCH


def mean_square(play):
    """The mean of the thread's squared radius over a pitch: crest, root and the two flanks."""
    high, low = MAJOR + play / 2, MAJOR - 5 / 8 * HEIGHT + play / 2
    return high ** 2 / 8 + low ** 2 / 4 + 5 / 8 * (high ** 2 + high * low + low ** 2) / 3


def wanted(name):
    words = name.split("_")
    if name == "peg":
        return math.pi * 25 * 30 * POLYGON
    if name == "bolt_m20":
        return math.pi * mean_square(0) * 30 * POLYGON
    if words[0] == "nut":
        return (6 * 15 ** 2 * math.tan(math.pi / 6) - math.pi * mean_square(int(words[2][:-2]) / 1e3) * POLYGON) * 10
    clearance, chamfer = int(words[1][:-2]) / 1e3, int(words[3][:-2]) / 1e3
    inner = (5 + clearance / 2) / math.cos(math.pi / FACES)
    cone = chamfer * (3 * inner ** 2 + 3 * inner * chamfer + chamfer ** 2) / 3 - inner ** 2 * chamfer
    return math.pi * POLYGON * ((20 ** 2 - inner ** 2) * 20 - cone)


def facts(path):
    """Edges without one of the opposite direction, and the volume, mm^3."""
    places, triangles = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[0] == "v":
            places.append(tuple(map(float, words[1:])))
        else:
            triangles.append([int(word) - 1 for word in words[1:]])
    edges, volume = collections.Counter(), 0.0
    for triangle in triangles:
        a, b, c = (places[i] for i in triangle)
        edges.update(((a, b), (b, c), (c, a)))
        volume += sum(a[i] * (b[i - 2] * c[i - 1] - b[i - 1] * c[i - 2]) for i in range(3)) / 6
    return sum(edges[b, a] != count for (a, b), count in edges.items()), volume


def main():
    if len(sys.argv) != 2:
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    wrong, seen = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([pathlib.Path(sys.argv[1]) / "assembly_bench", "meshes", folder], check=True)
        for path in sorted(pathlib.Path(folder).glob("*.obj")):
            seen += 1
            open_edges, volume = facts(path)
            expected = wanted(path.stem)
            # The helix meets its polygon's chords aslant: a ten-thousandth.
            if open_edges or abs(volume / expected - 1) > 2e-4:
                wrong += 1
                print(f"{path.stem}: {open_edges} open edges, {volume:.2f} mm^3 instead of {expected:.2f}")
    print(f"{seen} meshes, {wrong} wrong")
    return 1 if wrong or seen < 20 else 0


if __name__ == "__main__":
    sys.exit(main())
