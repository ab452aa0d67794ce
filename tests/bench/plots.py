#!/usr/bin/python3
"""Draws plots from the CSV files of a folder and beside them.

Usage: plots.py [FOLDER...]     (by default every folder of tests/bench/results)

Plots whose file is not there are left out.
"""

import io
import math
import pathlib
import re
import sys

import matplotlib

import bench_csv

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.hashsalt": "forcelayer",  # the same bytes from the same figures
                            "svg.fonttype": "none", "font.size": 9, "legend.fontsize": 8, "axes.titlesize": 10,
                            "axes.grid": True, "axes.grid.which": "major", "grid.linewidth": 0.4})
from matplotlib import pyplot, ticker  # noqa: E402  (the backend is chosen first)


def plain(axis, ticks, labels=None):
    """These ticks alone, without exponents."""
    axis.set_major_locator(ticker.FixedLocator(ticks))
    axis.set_major_formatter(ticker.FixedFormatter(labels or [f"{t:g}" for t in ticks]))


def values(rows, key, factor=1.0):
    return [math.nan if row[key] is None else factor * row[key] for row in rows]


def unique(rows, key):
    return list(dict.fromkeys(row[key] for row in rows))


def legend_below(figure, axes, columns, bottom):
    """One legend of all axes below them."""
    handles = {label: handle for axis in axes for handle, label in zip(*axis.get_legend_handles_labels())}
    figure.legend(handles.values(), handles.keys(), loc="lower center", ncols=columns, frameon=False)
    figure.tight_layout(rect=(0, bottom, 1, 1))


# Ours in one hue, peers in others; in the order of the legend.
QUERY_LOOKS = {
    "all skipping": dict(color="#08519c", marker="o", linewidth=2.4, label="Forcelayer"),
    "no skipping": dict(color="#9ecae1", marker="o", linestyle="--", label="Forcelayer, every point looked at"),
    "OpenVDB ValueAccessor": dict(color="#d95f0e", marker="s", label="OpenVDB ValueAccessor, same tree"),
    "FCL meshes, contacts": dict(color="#31a354", marker="^", label="FCL meshes, all contacts"),
    "FCL meshes, distance": dict(color="#006d2c", marker="^", label="FCL meshes, distance"),
}


def query(rows):
    figure, axes = pyplot.subplots(figsize=(8, 4.2))
    for method, look in QUERY_LOOKS.items():
        curve = [r for r in rows if r["motion"] == "wall" and r["method"] == method]
        if curve:
            axes.plot(values(curve, "points"), values(curve, "p50_us"), markersize=5, **look)
    axes.axhline(1000, color="black", linewidth=0.8)
    axes.text(110, 1100, "1 ms: a frame")
    axes.set(xscale="log", yscale="log", xlabel="points of the shell", ylabel="contact query, median of a frame (us)",
             title="A sphere slides and turns on a wall, one core")
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    figure.tight_layout()
    return figure


# Ours in blue; peers that share our query in orange and red, mesh colliders in green.
WRENCH_LOOKS = {
    "default, distances": dict(color="#08519c", marker="o", label="Forcelayer: stored distances (default)"),
    "default as voxrun runs it": dict(color="#00acc1", marker="h", label="the same as voxrun runs it"),
    "default, Euclidean layers": dict(color="#4292c6", marker="s", label="Forcelayer: Euclidean layers (--kind lean)"),
    "default, Chebyshev layers": dict(color="#9ecae1", marker="v", label="Forcelayer: Chebyshev layers"),
    "paper: tangent plane, N/10": dict(color="#969696", marker="P", label="the paper's model"),
    "dense float distances, our query": dict(color="#fd8d3c", marker="D", label="dense float distances, our query"),
    "OpenVDB level set, as people use it": dict(color="#756bb1", marker="^", label="OpenVDB level set, as people use it"),
    "FCL contacts": dict(color="#74c476", marker="<", label="FCL contacts"),
    "FCL distance": dict(color="#006d2c", marker=">", label="FCL distance"),
}
NOTICEABLE_FORCE = 0.07  # Pang, Tan and Durlach 1991 (README.md)


GROUPS = ("flush and smooth", "corners and wedges", "mesh pairs")


def wrench(rows):
    figures = {}
    for r in rows:
        figures.setdefault((r["contacts"], r["method"]), {}).setdefault(r["voxel_m"], {})[r["figure"]] = r
    figure, axes = pyplot.subplots(1, len(GROUPS), figsize=(11, 5.6), sharey=True)
    for axis, group in zip(axes, GROUPS):
        for method, look in WRENCH_LOOKS.items():
            sizes = sorted(figures.get((group, method), {}).items(), reverse=True)
            if not sizes:
                continue
            force = [of["force"] for _, of in sizes]
            at = [of["frame, us"]["p50"] for _, of in sizes]
            error = [100 * f["p50"] for f in force]
            axis.errorbar(at, error, yerr=[[100 * (f["p50"] - f["p25"]) for f in force], [100 * (f["p75"] - f["p50"]) for f in force]],
                          fmt="none", ecolor=look["color"], elinewidth=0.7, alpha=0.6)
            axis.plot(at, error, color=look["color"], lw=2 if method == "default, distances" else 1)
            axis.plot([], [], color=look["color"], marker=look["marker"], ms=5, label=look["label"])
            for (voxel_m, _), x, y in zip(sizes, at, error):
                axis.plot(x, y, ls="", marker=look["marker"], color=look["color"], ms=3 + 2.5 * math.log2(voxel_m / 0.00125) / 1.5)
        axis.axhline(100 * NOTICEABLE_FORCE, color="black", lw=1, ls=":", label="least noticeable difference, 7%")
        axis.set(xscale="log", yscale="log", title=group, xlabel="time of a frame, one core (us)")
        axis.xaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axes[0].set_ylabel("error of the force (percent of the true force)")
    sizes = ", ".join(f"{1e3 * v:g}" for v in sorted({r["voxel_m"] for r in rows}, reverse=True))
    figure.suptitle(f"Medians, bars are quartiles; voxels of {sizes} mm, the large marker is the coarse one", fontsize=9)
    legend_below(figure, axes, 3, 0.17)
    return figure


def cores(rows):
    figure, axis = pyplot.subplots(figsize=(8, 4.2))
    counts = unique(rows, "threads")
    axis.plot(counts, counts, color="black", linewidth=0.8, label="as many times as threads")
    for n, task in enumerate(unique(rows, "task")):
        curve = [r for r in rows if (r["task"], r["stage"]) == (task, "whole")]
        axis.plot(values(curve, "threads"), [curve[0]["wall_s"] / r["wall_s"] for r in curve], marker="os^vDXPh*"[n % 9], ms=4,
                  color=f"C{n}", linestyle=":" if task.startswith("query") else "-", label=task)
    axis.set(xscale="log", yscale="log", xlabel="threads", ylabel="times as fast as one thread")
    plain(axis.xaxis, counts)
    plain(axis.yaxis, counts)
    axis.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    figure.tight_layout()
    return figure


def save(figure, path):
    """As SVG without what Matplotlib writes for editors: groups, names, indentation, digits."""
    for axes in figure.axes:
        axes.minorticks_off()
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    small = re.sub(r"<!--.*?-->|<metadata>.*?</metadata>|^\s+|(?<=<g) id=\"[^\"]*\"", "", text.getvalue(),
                   flags=re.DOTALL | re.MULTILINE)
    for _ in range(4):
        small = re.sub(r"<g>\s*(<(?:path|use)[^>]*/>\s*)*</g>\s*", lambda group: group[0][3:].rstrip()[:-4].lstrip(), small)
    def rounded(tag):
        return re.sub(r"-?\d+\.\d{2,}", lambda number: f"{float(number[0]):.1f}", tag[0])
    path.write_text(re.sub(r"<[^>]*>", rounded, small))
    print(f"wrote {path}")


PLOTS = (query, wrench, cores)  # each gets the rows of the file of its name


def main():
    for folder in map(pathlib.Path, sys.argv[1:] or sorted(bench_csv.RESULTS.iterdir())):
        for plot in PLOTS:
            source = folder / f"{plot.__name__}.csv"
            if source.exists():
                figure = plot(bench_csv.Table(source).rows)
                save(figure, source.with_suffix(".svg"))
                pyplot.close(figure)


if __name__ == "__main__":
    main()
