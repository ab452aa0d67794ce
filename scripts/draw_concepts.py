#!/usr/bin/python3
"""Draws the figures of docs/concepts.md, in two dimensions, from the definitions that the page explains.

    scripts/draw_concepts.py [FOLDER]        default: docs/figures
"""
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Circle, Polygon, Rectangle

matplotlib.rcParams.update({"font.size": 10, "svg.hashsalt": "forcelayer", "svg.fonttype": "none", "font.family": "sans-serif"})
COLOR = {1: "#8c9aa8", 2: "#f4a261", 3: "#fbe3c8"}  # interior, surface (the force layer), proximity
NAME = {1: "1 interior", 2: "2 surface: the force layer", 3: "3 proximity"}
MESH, PART, GOOD, BAD = "#1d3557", "#2a9d8f", "#2a9d8f", "#c1121f"

# Distances from the mesh in voxels, as voxelize chooses them by default (formats/voxmap_format.md, section 10).
INTERIOR = 1 + 888 / 1024  # value 1 ends here
ZERO_FORCE = INTERIOR + 1  # the force begins here
GUARD = INTERIOR - 0.2  # no shell point gets nearer
COVERING_RADIUS = np.sqrt(3) / 2


def distance_from(polygon, points):
    """Distances of points (n, 2) from the outline of a polygon (m, 2), and whether each point is inside of it."""
    nearest = np.full(len(points), np.inf)
    inside = np.zeros(len(points), bool)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0)):
        along = b - a
        t = np.clip(((points - a) @ along) / (along @ along), 0, 1)
        nearest = np.minimum(nearest, np.linalg.norm(points - a - t[:, None] * along, axis=1))
        crosses = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            x = a[0] + (points[:, 1] - a[1]) * along[0] / along[1]
        inside ^= crosses & (points[:, 0] < x)
    return nearest, inside


def voxel_values(polygon, width, height):
    """The two-bit value of each voxel (width, height) around a closed polygon, in the Euclidean metric."""
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5, indexing="ij")
    nearest, inside = distance_from(polygon, np.column_stack([x.ravel(), y.ravel()]))
    values = np.where(inside | (nearest < INTERIOR), 1, 0).reshape(width, height)
    for value in (2, 3):  # each layer is the neighbors of all that lies within it, over faces and corners
        near = np.zeros_like(values, bool)
        padded = np.pad(values > 0, 1)
        for dx in range(3):
            for dy in range(3):
                near |= padded[dx:dx + width, dy:dy + height]
        values[near & (values == 0)] = value
    return values


def shell_of(polygon, spacing):
    """Points along the outline of a polygon, at most `spacing` apart, with inward unit normals."""
    points, normals = [], []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0)):
        length = np.linalg.norm(b - a)
        count = int(np.ceil(length / spacing))
        for n in range(count):
            points.append(a + (b - a) * (n / count))
            normals.append(np.array([-(b - a)[1], (b - a)[0]]) / length)
    return np.array(points), np.array(normals)


def picture(width, height, x, y):
    figure, axes = plt.subplots(figsize=(width, height))
    axes.set_xlim(*x)
    axes.set_ylim(*y)
    axes.set_aspect("equal")
    axes.axis("off")
    return figure, axes


def draw_voxels(axes, values):
    for i, j in np.ndindex(values.shape):
        axes.add_patch(Rectangle((i, j), 1, 1, facecolor=COLOR.get(values[i, j], "white"), edgecolor="#d5dbe1", lw=0.5))


def save(figure, folder, name):
    figure.savefig(folder / f"{name}.svg", bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)


def draw_layers(folder):
    bracket = np.array([[2.2, -4], [4.0, 6.2], [10.3, 4.9], [11.0, 7.9], [1.6, 9.8], [-2.6, -4]])
    figure, axes = picture(7.6, 4.4, (0, 22), (0, 13))
    values = voxel_values(bracket, 15, 13)
    draw_voxels(axes, values)
    axes.add_patch(Polygon(bracket, closed=True, fill=False, edgecolor=MESH, lw=2))
    axes.text(6.1, 7.1, "mesh", color=MESH)
    for n, value in enumerate((1, 2, 3)):
        axes.add_patch(Rectangle((15.6, 9.6 - 1.3 * n), 0.8, 0.8, facecolor=COLOR[value], edgecolor="#d5dbe1"))
        axes.text(16.7, 9.7 - 1.3 * n, NAME[value], fontsize=9, va="bottom")
    axes.add_patch(Rectangle((15.6, 5.7), 0.8, 0.8, facecolor="white", edgecolor="#d5dbe1"))
    axes.text(16.7, 5.8, "0 free", fontsize=9, va="bottom")
    save(figure, folder, "layers")


def draw_shell(folder):
    part = np.array([[1, 1], [9, 1], [9, 3.6], [5.4, 4.4], [4.2, 7], [1, 7]])
    points, normals = shell_of(part, 1.5)
    figure, axes = picture(6, 4.4, (-0.5, 11.5), (-0.2, 8.2))
    axes.add_patch(Polygon(part, closed=True, facecolor="#e3f4f1", edgecolor=PART, lw=2))
    for p in points:
        axes.add_patch(Circle(p, COVERING_RADIUS, facecolor=PART, alpha=0.12, edgecolor="none"))
    for p, n in zip(points, normals):
        axes.annotate("", p + 0.75 * n, p, arrowprops={"arrowstyle": "->", "color": "#52606d", "lw": 0.9})
    axes.plot(*points.T, "o", ms=4, color=MESH)
    axes.annotate("a shell point and\nits inward normal", points[3], (7.3, -0.1), fontsize=9, arrowprops={"arrowstyle": "-", "lw": 0.6})
    center = points[8]
    axes.add_patch(Circle(center, COVERING_RADIUS, fill=False, edgecolor=PART, lw=1.2, ls="--"))
    axes.annotate("covering radius: every point of the\nsurface is this near to a shell point", center + [0.8, 0.2], (6.0, 6.6), fontsize=9,
                  arrowprops={"arrowstyle": "-", "lw": 0.6})
    save(figure, folder, "shell")


def draw_standoff(folder):
    figure, axes = plt.subplots(figsize=(7, 3.2))
    axes.axvspan(-0.6, 0, color=MESH, alpha=0.85)
    axes.axvspan(0, INTERIOR, color=COLOR[1], alpha=0.55)
    axes.axvspan(INTERIOR, ZERO_FORCE, color=COLOR[2], alpha=0.7)
    axes.axvspan(ZERO_FORCE, ZERO_FORCE + 1, color=COLOR[3], alpha=0.8)
    d = np.linspace(GUARD, 4.6, 200)
    axes.plot(d, np.maximum(0, ZERO_FORCE - d), color=BAD, lw=2)
    axes.axvline(GUARD, color=GOOD, lw=2, ls="--")
    axes.text(GUARD - 0.06, 1.32, "guard: no shell point\ngets nearer", color=GOOD, ha="right", va="top", fontsize=9)
    axes.text(ZERO_FORCE + 0.06, 0.42, "the force begins at\nthe standoff", color=BAD, fontsize=9)
    axes.text(-0.3, 0.7, "solid", color="white", rotation=90, ha="center", va="center")
    axes.set_xlim(-0.6, 4.6)
    axes.set_ylim(0, 1.4)
    axes.set_xlabel("distance of a shell point from the mesh, voxels")
    axes.set_ylabel("force of one point\n(in units of its stiffness)")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.tight_layout()
    save(figure, folder, "standoff")


def draw_guard(folder):
    figure, axes = picture(7, 3.3, (0, 16), (0, 7.2))
    axes.add_patch(Rectangle((0, 0), 16, 1.2, facecolor=MESH))
    axes.axhline(1.2 + GUARD, color=GOOD, ls="--", lw=1.5)
    axes.text(0.1, 1.3 + GUARD, "guard", color=GOOD, fontsize=9)
    shape = np.array([[0, 0], [2.6, 0.9], [2.0, 3.0], [-0.6, 2.1]])
    start, wanted = np.array([2.4, 3.9]), np.array([12.2, 1.4])
    lowest = 1.2 + GUARD
    fraction = (start[1] - lowest) / (start[1] - wanted[1])  # its lowest corner reaches the guard's distance there
    kept = start + fraction * (wanted - start)
    for place, color, alpha, words in ((start, PART, 1, "at the last frame"), (kept, PART, 1, "kept: tested and free"),
                                       (wanted, BAD, 0.45, "where the hand pulls")):
        axes.add_patch(Polygon(shape + place, closed=True, facecolor=color, alpha=0.25 * alpha, edgecolor="none"))
        axes.add_patch(Polygon(shape + place, closed=True, fill=False, edgecolor=color, alpha=alpha, lw=1.6, ls="-" if alpha == 1 else ":"))
        axes.text(*(place + [1.0, 3.15]), words, ha="center", fontsize=9, color=color)
    axes.annotate("", wanted + [1, 1.5], start + [1, 1.5], arrowprops={"arrowstyle": "->", "color": "#52606d", "lw": 1, "ls": "--"})
    axes.text(0.2, 0.45, "scene", color="white")
    save(figure, folder, "guard")


def draw_seat(folder):
    figure, axes = picture(7, 3.0, (0, 16), (0, 6.4))
    for y in (0, 4.4):
        axes.add_patch(Rectangle((1.5, y), 6.5, 1.9, facecolor=MESH))
    axes.text(1.7, 0.75, "bore", color="white")
    for x, words in ((1.5, "installed: gaps below the standoff"), (9.6, "free: the separation is guaranteed")):
        axes.add_patch(Rectangle((x, 2.05), 5.4, 2.2, facecolor=PART, alpha=0.3, edgecolor=PART, lw=1.6))
        axes.text(x + 2.7, 3.15, "pin", ha="center", va="center", color="#14524a")
        axes.text(x + 2.7, -0.1 if x < 5 else 1.35, words, ha="center", va="top" if x < 5 else "bottom", fontsize=9)
    axes.annotate("", (9.5, 5.4), (8.1, 5.4), arrowprops={"arrowstyle": "->", "lw": 1.2})
    axes.text(9.7, 5.25, "the seat ends when the pin no longer touches\nwhat it touched as installed", fontsize=9, va="center")
    axes.set_ylim(-0.6, 6.4)
    save(figure, folder, "seat")


def draw_clearance(folder):
    wall = np.array([[0, 0], [5.2, 0], [5.2, 3.1], [6.4, 3.1], [6.4, 0], [14, 0], [14, -3], [0, -3]])
    along = np.linspace(0, 14, 561)
    exact, _ = distance_from(wall, np.column_stack([along, np.full_like(along, 4.6)]))
    exact = np.minimum(exact, 4.6)
    # As voxcheck walks: the distance at a look covers what can be reached before the next look.
    looks, t = [0.0], 0.0
    while t < 14:
        here = np.interp(t, along, exact)
        t = min(14, t + max(0.35, 0.5 * (here - 1.0)))
        looks.append(t)
    looks = np.array(looks)
    at = np.interp(looks, along, exact) - 0.15  # what voxels and points prove is a little less
    bound = np.max([at_n - np.abs(along - t_n) for at_n, t_n in zip(at, looks)], axis=0)
    figure, axes = plt.subplots(figsize=(7, 3))
    axes.plot(along, exact, color=MESH, lw=1.6, label="exact distance (not computed)")
    axes.plot(along, bound, color=PART, lw=1.6, label="proven: never above it, between the looks too")
    axes.plot(looks, at, "o", ms=4, color=PART, label="poses that are looked at")
    axes.axhline(1, color=BAD, lw=1, ls="--", label="required clearance")
    axes.set_ylim(0, 5.2)
    axes.set_xlim(0, 14)
    axes.set_xlabel("length along the path")
    axes.set_ylabel("clearance")
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, 1.12), framealpha=0.95)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.tight_layout()
    save(figure, folder, "clearance")


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[1] / "docs/figures")
    folder.mkdir(parents=True, exist_ok=True)
    for draw in (draw_layers, draw_shell, draw_standoff, draw_guard, draw_seat, draw_clearance):
        draw(folder)


if __name__ == "__main__":
    main()
