#!/usr/bin/python3
"""Draws run time against error of the contact wrench from wrench.json: the Pareto front, by voxel size.

Usage: plot_wrench.py [JSON [SVG]]
"""

import json
import math
import pathlib
import sys

import bench_scenes

bench_scenes.with_system_python()

import matplotlib  # noqa: E402

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402

MARKERS = "osv^DXP*<>hp"
GROUPS = ("flush and smooth", "corners and wedges", "mesh pairs")
NOTICEABLE_FORCE = 7  # percent: the least of the published range (METHOD.md)


def front(points):
    """The points that no other beats in both time and error, in the order of time."""
    best, least = [], math.inf
    for point in sorted(points):
        if point[1] < least:
            best.append(point)
            least = point[1]
    return best


def plot(report):
    sizes = report["results"]
    groups = [group for group in GROUPS if group in sizes[0]["contacts"]]
    figure, axes = pyplot.subplots(1, len(groups), figsize=(4.6 * len(groups) + 0.6, 5), sharey=True, squeeze=False)
    axes = axes[0]
    for axis, group in zip(axes, groups):
        methods = sizes[0]["contacts"][group]
        every = []
        for name, marker in zip(methods, MARKERS):
            rows = [(size["s"] * 10, size["contacts"][group][name]) for size in sizes]
            rows = [(mm, r) for mm, r in rows if r["force_error"] is not None]
            x = [r["frame_us"]["p50"] for _, r in rows]
            y = [100 * r["force_error"] for _, r in rows]
            every += list(zip(x, y))
            line, = axis.plot(x, y, marker=marker, ms=5, lw=1, label=name)
            for (mm, _), at in zip(rows, zip(x, y)):
                axis.annotate(f"{mm:g} mm", at, textcoords="offset points", xytext=(4, 4), fontsize=6,
                              color=line.get_color())
        pareto = front(every)
        axis.step([p[0] for p in pareto], [p[1] for p in pareto], where="post", color="0.6", lw=4, alpha=0.5,
                  zorder=0, label="not beaten in both")
        axis.axhline(NOTICEABLE_FORCE, color="0.4", lw=0.8, ls=":")
        axis.set(xscale="log", yscale="log", title=group, xlabel="time of a frame, median (us, one core)")
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        axis.grid(True, which="major", lw=0.4)
    axes[0].set_ylabel("error of the force vector (percent, one gain and offset fitted)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncols=4, fontsize=8)
    figure.suptitle(f"Contact wrench: time against error, dotted: the least that a hand can notice\n"
                    f"{report['machine']['cpu']}, {report['machine']['date'][:10]}", fontsize=10)
    figure.subplots_adjust(left=0.07, right=0.99, top=0.86, bottom=0.22, wspace=0.04)
    return figure


def main():
    path = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else bench_scenes.results_folder() / "wrench.json"
    picture = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else path.with_suffix(".svg")
    bench_scenes.save_figure(plot(json.loads(path.read_text())), picture)


if __name__ == "__main__":
    main()
