"""Compares plain pictures of voxview with the voxels that they show, pixel by pixel.

Usage: voxview_check.py layer PICTURE.png PICTURE.json VOXEL_SIZE_M VOXELS.csv VALUE
       voxview_check.py cut   PICTURE.png PICTURE.json VOXEL_SIZE_M VOXELS.csv AXIS INDEX
       voxview_check.py change PICTURE.png PICTURE.json VOXEL_SIZE_M BEFORE.csv AFTER.csv

The pictures look along a world axis at a whole number of pixels a voxel. VOXELS.csv is what
`voxinfo export` writes: i,j,k,value of every non-free voxel.
"""

import json
import pathlib
import re
import sys

import numpy
from matplotlib import image

STYLE = pathlib.Path(__file__).resolve().parents[2] / "workbench/viewer/plan/style.h"
INTERIOR, SURFACE, PROXIMITY = 1, 2, 3


def color(name):
    """A color of workbench/viewer/plan/style.h as three bytes."""
    numbers = re.search(rf"k{name}Color = {{([^}}]*)}}", STYLE.read_text()).group(1)
    return numpy.round(255 * numpy.array([float(n) for n in numbers.split(",")]))


def read_voxels(path):
    return numpy.loadtxt(path, delimiter=",", skiprows=1, dtype=numpy.int64, ndmin=2)


class Picture:
    """A plain picture, one sample a voxel column: from the middle of its square of pixels."""

    def __init__(self, png, facts, voxel_size_m):
        self.facts = json.loads(pathlib.Path(facts).read_text())
        pixels = numpy.round(255 * image.imread(png)[:, :, :3])[::-1]  # lowest row first
        self.pitch = round(voxel_size_m / self.facts["metres_per_pixel"])
        assert abs(self.pitch * self.facts["metres_per_pixel"] / voxel_size_m - 1) < 1e-9
        self.pixels = pixels
        up, eye = numpy.array(self.facts["up"]), numpy.array(self.facts["to_eye"])
        right = numpy.cross(up, eye)
        self.right, self.up, self.eye = (numpy.round(v).astype(int) for v in (right, up, eye))
        # The target, a voxel corner, is in the middle of the picture.
        self.middle = numpy.round(numpy.array(self.facts["target_m"]) / voxel_size_m).astype(int)

    def pixel_of(self, voxels):
        """Column and row of the lowest pixel of each voxel's square; voxels are [n][3]."""
        height, width = self.pixels.shape[:2]

        def low(axis):
            along = voxels @ axis - self.middle @ axis
            return along - (axis.sum() < 0)  # the lower side of a voxel that is counted backwards

        return low(self.right) * self.pitch + width // 2, low(self.up) * self.pitch + height // 2

    def paint(self, voxels, colors):
        """The picture that these voxels should give, nearest to the eye on top."""
        expected = numpy.full(self.pixels.shape, 255.0)
        order = numpy.argsort(voxels @ self.eye, kind="stable")
        columns, rows = self.pixel_of(voxels)
        assert columns.min() >= 0 and rows.min() >= 0, "the picture does not hold the scene"
        assert columns.max() + self.pitch <= expected.shape[1]
        assert rows.max() + self.pitch <= expected.shape[0]
        for n in order:
            expected[rows[n]:rows[n] + self.pitch, columns[n]:columns[n] + self.pitch] = colors[n]
        return expected

    def compare(self, voxels, colors):
        expected = self.paint(voxels, colors)
        wrong = (expected != self.pixels).any(axis=2)
        shown = (expected != 255).any(axis=2).sum() // self.pitch ** 2
        print(f"{shown} columns of voxels in the picture, {wrong.sum()} wrong pixels")
        assert shown > 0, "nothing in the picture"
        assert not wrong.any(), f"first at {numpy.argwhere(wrong)[0]}"


def check_layer(picture, csv, value):
    """One layer alone: every column that holds such a voxel, and no other, has its color."""
    voxels = read_voxels(csv)
    name = {INTERIOR: "Interior", SURFACE: "ForceLayer", PROXIMITY: "Proximity"}[value]
    chosen = voxels[voxels[:, 3] == value][:, :3]
    picture.compare(chosen, numpy.tile(color(name), (len(chosen), 1)))


def check_cut(picture, csv, axis, index):
    """All three layers, cut above voxel `index`: the uppermost voxel that is left shows."""
    voxels = read_voxels(csv)
    left = voxels[voxels[:, axis] <= index]
    # Proximity over the force layer over interior: below the cut the outermost surface is seen.
    table = numpy.array([color("Interior"), color("ForceLayer"), color("Proximity")])
    picture.compare(left[:, :3], table[left[:, 3] - 1])


def check_change(picture, before, after):
    """The force-layer voxels of one map only, those of both left out, and their counts."""
    sets = [{tuple(v[:3]) for v in read_voxels(csv) if v[3] == SURFACE} for csv in (before, after)]
    added, removed = sorted(sets[1] - sets[0]), sorted(sets[0] - sets[1])
    counts = {"added": len(added), "removed": len(removed), "kept": len(sets[0] & sets[1])}
    assert picture.facts["change"] == counts, (picture.facts["change"], counts)
    assert added and removed
    colors = ([color("Added")] * len(added)) + ([color("Removed")] * len(removed))
    picture.compare(numpy.array(added + removed), numpy.array(colors))


def main():
    kind, png, facts, voxel_size_m = sys.argv[1], sys.argv[2], sys.argv[3], float(sys.argv[4])
    picture = Picture(png, facts, voxel_size_m)
    if kind == "layer":
        check_layer(picture, sys.argv[5], int(sys.argv[6]))
    elif kind == "cut":
        check_cut(picture, sys.argv[5], int(sys.argv[6]), int(sys.argv[7]))
    else:
        check_change(picture, sys.argv[5], sys.argv[6])


if __name__ == "__main__":
    main()
