#!/usr/bin/env python3
"""Seats whose ways out are known by construction, and what the commands say about them.

    seat_campaign.py BIN_FOLDER exact|files|pull|plan [--seed N] [--seeds N] [--kind NAME] [--way NAME] [--keep FOLDER]

A seat has voxels of 0.5 to 4 mm, walls of 0.05 to 4 voxels, ribs (the part's own walls) of 0.1 to 4 voxels and gaps of 0.02 to
1 voxel, in any attitude and place between the voxels. "Flat" are ways through a wall, face to face: what shell points must feel.
Other blocked ways end at an edge or a stud, which they may miss.

    exact  voxcheck --exact: the meshes decide, and are never wrong
    files  voxcheck --felt-seat: no flat way is clear
    pull   voxrun --pull, 60 voxels: nothing goes through flat; how deep parts are that are levered off, says voxcheck --exact
    plan   voxplan --exact: a path where there is one, and voxcheck --exact agrees

Prints counts, and a line for each wrong answer. Exit status 1: a promise above is broken. A way out that is not clear (files),
held (pull) or not found (plan) is counted, and breaks none.
"""
import argparse
import collections
import csv
import itertools
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

WAY_VOXELS = 60
PULLED_VOXELS = 55  # a part that was pulled so far came along
LEVERED_DEGREES = 5  # a part that was levered off a wall tilted more


def solid(*boxes):
    """The boundary of a union of boxes: vertices and triangles, without a gap, outwards."""
    planes = [sorted({corner[axis] for box in boxes for corner in box}) for axis in range(3)]
    middles = [[(a + b) / 2 for a, b in zip(line, line[1:])] for line in planes]
    filled = {cell for cell in itertools.product(*(range(len(m)) for m in middles))
              if any(all(low[a] < middles[a][cell[a]] < high[a] for a in range(3)) for low, high in boxes)}
    numbers, triangles = {}, []
    for cell in sorted(filled):
        for axis, side in itertools.product(range(3), range(2)):
            beside = list(cell)
            beside[axis] += 2 * side - 1
            if tuple(beside) in filled:
                continue
            corners = []
            for du, dv in (0, 0), (1, 0), (1, 1), (0, 1):
                at = list(cell)
                at[axis] += side
                at[(axis + 1) % 3] += du
                at[(axis + 2) % 3] += dv
                corners.append(numbers.setdefault(tuple(at), len(numbers)))
            if side == 0:
                corners.reverse()
            triangles += [(corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3])]
    return [tuple(planes[axis][at[axis]] for axis in range(3)) for at in numbers], triangles


def frame(inner, outer, low, high):
    """Four walls around the z axis."""
    return [((-outer, -outer, low), (-inner, outer, high)), ((inner, -outer, low), (outer, outer, high)),
            ((-inner, -outer, low), (inner, -inner, high)), ((-inner, inner, low), (inner, outer, high))]


# Each kind: meshes of part and scene in voxels, ways out, blocked flat ways, other blocked ways. w: the thickness of the scene's
# walls, t: that of the part's, g: the gap, s: a size of 3 to 6.
def clip_on_edge(w, t, g, s):
    a, b = w / 2 + g, w / 2 + g + t
    part = solid(((-b, -10, -20), (-a, 10, g)), ((a, -10, -20), (b, 10, g)), ((-b, -10, g), (b, 10, g + t)))
    return part, solid(((-w / 2, -30, -40), (w / 2, 30, 0))), "+z +y -y", "+x -x", "-z"


def tab_in_slot(w, t, g, s):
    i, o = t / 2 + g, t / 2 + g + w
    slot = solid(((-o, -15, -8), (-i, 15, 8)), ((i, -15, -8), (o, 15, 8)), ((-o, -15, -8 - w), (o, 15, -8)))
    return solid(((-t / 2, -9, -8 + g), (t / 2, 9, 10))), slot, "+z +y -y", "+x -x", "-z"


def cover_on_pot(w, t, g, s):
    h, i = s + 4, s + 4 + g
    w = min(w, h - 1)
    pot = solid(*frame(h - w, h, -20, -g), ((-h, -h, -20 - w), (h, h, -20)))
    return solid(*frame(i, i + t, -6, 0), ((-i - t, -i - t, 0), (i + t, i + t, t))), pot, "+z", "+x -x +y -y", "-z"


def cover_over_studs(w, t, g, s):
    h, i = s + 5, s + 5 + g
    studs = [((x, y, -10), (x + w, y + w, -g)) for x in (-h, h - w) for y in (-h, h - w)]
    return (solid(*frame(i, i + t, -6, 0), ((-i - t, -i - t, 0), (i + t, i + t, t))),
            solid(*studs, ((-h - 4, -h - 4, -12), (h + 4, h + 4, -10))), "+z", "", "+x -x +y -y -z")


def dovetail(w, t, g, s):
    neck, head = s / 2, s + 3  # the lips cover 3.5 voxels of the head and more
    part = solid(((-head, -9, -3), (head, 9, 0)), ((-neck, -9, 0), (neck, 9, 8)))
    i, o, n, low, top = head + g, head + g + w, neck + g, -3 - g, g + w
    rail = solid(((-o, -15, low - w), (o, 15, low)), ((-o, -15, low), (-i, 15, top)), ((i, -15, low), (o, 15, top)),
                 ((-i, -15, g), (-n, 15, top)), ((n, -15, g), (i, 15, top)))
    return part, rail, "+y -y", "+z -z +x -x", ""


def bayonet(w, t, g, s):
    """Two lugs behind a plate. It comes out upwards after a quarter turn, and downwards."""
    h, hole, lug = s / 3, s / 2 + g, s + 5  # corners of the shaft turn within the hole
    part = solid(((-h, -h, -g - t), (h, h, 12)), ((-h, -lug, -g - t), (h, lug, -g)))
    far, slot, reach = lug + 8, h + g, lug + g
    plate = solid(((-far, hole, 0), (far, far, w)), ((-far, -far, 0), (far, -hole, w)),
                  ((-far, slot, 0), (-hole, hole, w)), ((hole, slot, 0), (far, hole, w)),
                  ((-far, -hole, 0), (-hole, -slot, w)), ((hole, -hole, 0), (far, -slot, w)),
                  ((-far, -slot, 0), (-reach, slot, w)), ((reach, -slot, 0), (far, slot, w)))
    return part, plate, "-z turn", "+z", "+x -x +y -y"


def hook_behind_flange(w, t, g, s):
    part = solid(((g, -9, -g - t), (g + t, 9, 10)), ((-s, -9, -g - t), (g + t, 9, -g)))
    return part, solid(((-20, -15, 0), (0, 15, w))), "+x -z +y -y", "+z", "-x"


def pin_in_bore(w, t, g, s):
    return solid(((-s, -s, -12), (s, s, 12))), solid(*frame(s + g, s + g + w, -8, 8)), "+z -z", "+x -x +y -y", ""


def plate_between_sheets(w, t, g, s):
    i, o = t / 2 + g, t / 2 + g + w
    sheets = solid(((-14, -14, i), (14, 14, o)), ((-14, -14, -o), (14, 14, -i)), ((-16, -14, -o), (-14, 14, o)))
    return solid(((-10, -10, -t / 2), (10, 10, t / 2))), sheets, "+x +y -y", "+z -z", "-x"


def fin_before_tab(w, t, g, s):
    """A foot that is pressed into the floor, by 0.02 to 1 voxel, and a fin before a tab of that floor. w, t: times as thick."""
    deep = 0.02 * 50 ** ((s - 3) / 3)
    w, t = deep * w, deep * t
    near, far = 2 + t, 2 + t + g
    part = solid(((-14, -4, -deep), (-10, 2, 8)), ((-14, -4, 6), (near, 13, 8)), ((2, 5, 1), (near, 13, 6)))
    return part, solid(((-40, -40, -8), (40, 40, 0)), ((far, 3, 0), (far + w, 15, 4))), "+z -x +y -y", "+x", "-z"


KINDS = [clip_on_edge, tab_in_slot, cover_on_pot, cover_over_studs, dovetail, bayonet, hook_behind_flange, pin_in_bore,
         plate_between_sheets]
EXACT_KINDS = [*KINDS, fin_before_tab]  # the files know no overlap as closely as the meshes


class Seat:
    """Files of one seat in the current folder, and its ways: (name, "out", "flat" or "edges")."""

    def __init__(self, kind, seed):
        r = random.Random(f"{kind.__name__} {seed}")
        evenly = lambda low, high: math.exp(r.uniform(math.log(low), math.log(high)))  # by ratio
        self.voxel_mm = evenly(0.5, 4)
        self.wall, self.rib, self.gap = evenly(0.05, 4), evenly(0.1, 4), evenly(0.02, 1)
        part, scene, out, flat, edges = kind(self.wall, self.rib, self.gap, r.uniform(3, 6))
        w, x, y, z = [r.gauss(0, 1) for _ in range(4)] if seed % 3 else (1, 0, 0, 0)
        norm = math.hypot(w, x, y, z)
        w, x, y, z = w / norm, x / norm, y / norm, z / norm
        self.rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                     (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                     (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
        self.shift_mm = [self.voxel_mm * r.uniform(-1, 1) for _ in range(3)]
        self.ways = [(name, what) for names, what in ((out, "out"), (flat, "flat"), (edges, "edges")) for name in names.split()]
        self.name = (f"{kind.__name__} {seed}, voxels of {self.voxel_mm:.3f} mm, wall {self.wall:.3f}, rib {self.rib:.3f}, "
                     f"gap {self.gap:.3f}")
        for name, (corners, triangles) in ("part", part), ("scene", scene):
            with open(name + ".obj", "w", encoding="ascii") as obj:
                for corner in corners:
                    p = self.turned([self.voxel_mm * c for c in corner])
                    obj.write("v %.17g %.17g %.17g\n" % tuple(c + s for c, s in zip(p, self.shift_mm)))
                obj.writelines("f %d %d %d\n" % tuple(c + 1 for c in t) for t in triangles)

    def turned(self, vector):
        return tuple(sum(row[a] * vector[a] for a in range(3)) for row in self.rows)

    def direction(self, way):
        return self.turned([(1 if way[0] == "+" else -1) if axis == way[1] else 0 for axis in "xyz"])

    def write_path(self, way):
        """Straight; `turn` is a quarter turn about the seat's z axis and then up."""
        poses = [(0, (0, 0, 0))]
        if way == "turn":
            poses = [(math.radians(3 * n), (0, 0, 0)) for n in range(31)]
        up = self.direction("+z" if way == "turn" else way)
        poses.append((poses[-1][0], [WAY_VOXELS * self.voxel_mm * c for c in up]))
        axis = self.direction("+z")
        with open("path.csv", "w", encoding="ascii") as path:
            path.write("t_s,x_m,y_m,z_m,qw,qx,qy,qz\n")
            for t, (angle, moved) in enumerate(poses):
                # The seat's axis stays where it is: p = moved + shift - R shift.
                s, c, n = self.shift_mm, math.cos(angle), axis
                along = sum(a * b for a, b in zip(n, s))
                across = (n[1] * s[2] - n[2] * s[1], n[2] * s[0] - n[0] * s[2], n[0] * s[1] - n[1] * s[0])
                p = [moved[a] + s[a] - (c * s[a] + math.sin(angle) * across[a] + (1 - c) * along * n[a]) for a in range(3)]
                q = [math.cos(angle / 2)] + [math.sin(angle / 2) * a for a in n]
                path.write(",".join("%.17g" % v for v in [t, *(1e-3 * v for v in p), *q]) + "\n")


class Campaign:
    def __init__(self, folder, mode):
        self.folder, self.mode = pathlib.Path(folder).resolve(), mode
        self.counts, self.wrong, self.broken = collections.Counter(), [], 0
        self.deepest = 0.0

    def run(self, program, *words):
        """Whether the answer is yes (status 0) or no (6); None, and the counted error, where it is neither."""
        ran = subprocess.run([self.folder / program, *map(str, words)], capture_output=True, text=True, check=False)
        if ran.returncode in (0, 6, 7):  # 7: it comes out, and overlaps its neighbor as installed
            return ran.returncode != 6
        self.counts["refused: " + ran.stderr.strip()[:150]] += 1
        return None

    def bake(self, seat):
        size = ("--units", "mm", "--voxel-size", f"{seat.voxel_mm}mm", "--quiet", "-o")
        return self.run("voxelize", "scene.obj", *size, "s.vox") and self.run("pointshell", "part.obj", *size, "p.pshell")

    def check(self, seat, path, *how):
        return self.run("voxcheck", "s.vox", "p.pshell", path, "--seat", "0,0,0m", "--clearance", f"{2 * seat.voxel_mm}mm",
                        "--quiet", "--json", "check.json", *how)

    def check_exactly(self, seat, path):
        return self.check(seat, path, "--exact", "scene.obj", "--part", "part.obj", "--units", "mm")

    def depth_voxels(self, seat):
        found = json.loads(pathlib.Path("check.json").read_text(encoding="utf-8")).get("violations", [])
        return max((1e3 * v.get("depth_m", 0) / seat.voxel_mm for v in found), default=0)

    def note(self, seat, way, what, answer, wrong, broken):
        self.counts[f"{what}: {answer}"] += 1
        if wrong:
            self.wrong.append(f"{what}: {answer}: {seat.name}, {way}")
        self.broken += broken

    def check_way(self, seat, way, what):
        seat.write_path(way)
        exact = self.mode == "exact"
        clear = self.check_exactly(seat, "path.csv") if exact else self.check(seat, "path.csv", "--felt-seat")
        if clear is None:
            self.broken += exact
            self.wrong.append(f"{what}: refused: {seat.name}, {way}")
            return
        wrong = clear != (what == "out")
        self.note(seat, way, what, "clear" if clear else "not clear", wrong and (exact or what != "edges"),
                  wrong and (exact or what == "flat"))

    def pull(self, seat, way, what):
        direction = seat.direction(way)
        target = ",".join("%.9gmm" % (WAY_VOXELS * seat.voxel_mm * c) for c in direction)
        pathlib.Path("way.csv").unlink(missing_ok=True)
        if self.run("voxrun", "s.vox", "p.pshell", "--pull", target, "--as-fast-as-possible", "--save-path", "way.csv") is None:
            return
        with open("way.csv", encoding="ascii") as rows:
            rows = list(csv.DictReader(rows))
        along = sum((float(rows[-1][k]) - float(rows[0][k])) * d for k, d in zip(("x_m", "y_m", "z_m"), direction))
        came = 1e3 * along > PULLED_VOXELS * seat.voxel_mm
        answer, went_flat = "came" if came else "held", False
        if came and what != "out":
            tilt = math.degrees(max(2 * math.acos(min(1, abs(float(row["qw"])))) for row in rows))
            answer = "levered off" if tilt >= LEVERED_DEGREES else "went through"
            went_flat = what == "flat" and tilt < LEVERED_DEGREES
            self.check_exactly(seat, "way.csv")
            depth = self.depth_voxels(seat)
            self.deepest = max(self.deepest, depth)
            way += f", tilted by {tilt:.0f} degrees, {depth:.2f} voxel deep"
        self.note(seat, way, what, answer, came != (what == "out"), went_flat)

    def plan(self, seat):
        may = any(what == "out" for _, what in seat.ways)
        found = self.run("voxplan", "s.vox", "p.pshell", "--seat", "0,0,0m", "--clearance", f"{2 * seat.voxel_mm}mm", "--exact",
                         "scene.obj", "--part", "part.obj", "--units", "mm", "--time", "20s", "-o", "plan.csv", "--quiet")
        if found is None:
            return
        agrees = not found or self.check_exactly(seat, "plan.csv")
        self.note(seat, "", "plan", "found" if found else "none", found != may or not agrees, not agrees)

    def try_seat(self, kind, seed, only):
        seat = Seat(kind, seed)
        if not self.bake(seat):
            return
        if self.mode == "plan":
            return self.plan(seat)
        for way, what in seat.ways:
            if only not in (None, way) or (way == "turn" and self.mode == "pull"):
                continue
            if self.mode == "pull":
                self.pull(seat, way, what)
            else:
                self.check_way(seat, way, what)

    def report(self):
        for answer in sorted(self.counts):
            print(f"{self.counts[answer]:6d}  {answer}")
        if self.deepest:
            print(f"deepest: {self.deepest:.3f} voxel")
        print("\n".join(self.wrong))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("mode", choices=["exact", "files", "pull", "plan"])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--kind", choices=[kind.__name__ for kind in EXACT_KINDS])
    parser.add_argument("--way")
    parser.add_argument("--keep", help="leave the files of the last seat here")
    given = parser.parse_args()
    campaign = Campaign(given.folder, given.mode)
    kinds = [kind for kind in (EXACT_KINDS if given.mode == "exact" else KINDS) if given.kind in (None, kind.__name__)]
    with tempfile.TemporaryDirectory() as scratch:
        os.makedirs(given.keep or scratch, exist_ok=True)
        os.chdir(given.keep or scratch)
        for seed, kind in itertools.product(range(given.seed, given.seed + given.seeds), kinds):
            campaign.try_seat(kind, seed, given.way)
        os.chdir("/")
    campaign.report()
    return 1 if campaign.broken else 0


if __name__ == "__main__":
    sys.exit(main())
