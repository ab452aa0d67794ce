"""bore(): a pin in the bore of a plate, as meshes and as a scene manifest, for the tests of the commands."""

import json
import math

FACETS = 16
# Between two facets of the pin of 10 mm and the bore of 10.1 mm.
PLAY_MM = 0.1 * math.cos(math.pi / FACETS)


def ring(radius):
    return [(radius * math.cos(2 * math.pi * k / FACETS), radius * math.sin(2 * math.pi * k / FACETS))
            for k in range(FACETS)]


def square(half):
    sides = [max(abs(x), abs(y)) for x, y in ring(1)]
    return [(half * x / side, half * y / side) for (x, y), side in zip(ring(1), sides)]


def write(name, corners, faces):
    with open(name, "w", encoding="ascii") as obj:
        obj.writelines("v %.9g %.9g %.9g\n" % corner for corner in corners)
        obj.writelines("f %d %d %d\n" % tuple(n + 1 for n in face) for face in faces)


def bands(lower, upper):
    """Triangles between two rings of corners, by the numbers of their first ones."""
    for k in range(FACETS):
        after = (k + 1) % FACETS
        yield lower + k, lower + after, upper + after
        yield lower + k, upper + after, upper + k


def block(name, radius, low, high):
    """Writes a solid of that radius about z between two heights, mm."""
    corners = [(x, y, z) for z in (low, high) for x, y in ring(radius)] + [(0, 0, low), (0, 0, high)]
    faces = list(bands(0, FACETS))
    for k in range(FACETS):
        after = (k + 1) % FACETS
        faces += [(2 * FACETS, after, k), (2 * FACETS + 1, FACETS + k, FACETS + after)]
    write(name, corners, faces)


def bore():
    """Writes pin.obj, plate.obj (mm) and bore.json, in which the pin is where it is installed."""
    count = FACETS
    block("pin.obj", 10, 0, 60)
    rings = ring(10.1), square(50)
    corners = [(x, y, z) for corner in rings for z in (0, 40) for x, y in corner]
    inner_low, inner_high, outer_low, outer_high = (n * count for n in range(4))
    faces = [*bands(inner_high, inner_low), *bands(outer_low, outer_high), *bands(inner_low, outer_low),
             *bands(outer_high, inner_high)]
    write("plate.obj", corners, faces)
    # The pin's file has it elsewhere, in centimeters, and turned.
    with open("pin.obj", encoding="ascii") as obj:
        lines = obj.read().splitlines()
    with open("turned.obj", "w", encoding="ascii") as obj:
        for line in lines:
            if line.startswith("v"):
                x, y, z = (float(word) for word in line.split()[1:])
                line = "v %.9g %.9g %.9g" % (x / 10, -z / 10, (y - 70) / 10)
            obj.write(line + "\n")
    half = math.sqrt(0.5)
    with open("bore.json", "w", encoding="ascii") as manifest:
        json.dump({"parts": [{"name": "plate", "mesh": "plate.obj", "units": "mm"},
                             {"name": "pin", "mesh": "turned.obj", "units": "cm", "translation": [0, "70mm", 0],
                              "rotation": [half, -half, 0, 0]}]}, manifest)
