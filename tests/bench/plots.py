#!/usr/bin/python3
"""Draws the plots that the pages show, from the CSV files of a folder and beside them.

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
    "scalar, no skipping": dict(color="#bdbdbd", marker="o", linestyle=":", label="the same without vectors"),
    "OpenVDB ValueAccessor": dict(color="#d95f0e", marker="s", label="OpenVDB ValueAccessor, same tree"),
    "OpenVDB level set, trilinear": dict(color="#b30000", marker="s", label="OpenVDB level set, trilinear"),
    "FCL meshes, contacts": dict(color="#31a354", marker="^", label="FCL meshes, all contacts"),
    "FCL meshes, distance": dict(color="#006d2c", marker="^", label="FCL meshes, distance"),
}


def query(rows, _):
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
    "default as voxrun runs it": dict(color="#00acc1", marker="h", label="the same as voxrun runs it: load shared"),
    "default, Euclidean layers": dict(color="#4292c6", marker="s", label="Forcelayer: Euclidean layers (--lean)"),
    "default, Chebyshev layers": dict(color="#9ecae1", marker="v", label="Forcelayer: Chebyshev layers"),
    "paper: tangent plane, N/10": dict(color="#969696", marker="P", label="the paper's model"),
    "dense float distances, our query": dict(color="#fd8d3c", marker="D", label="dense float distances, our query"),
    "dense float distances, default's slope": dict(color="#d94801", marker="d", label="dense float distances, default's slope"),
    "exact closest points, our query": dict(color="#b30000", marker="*", label="exact closest points, our query"),
    "OpenVDB level set, as people use it": dict(color="#756bb1", marker="^", label="OpenVDB level set, as people use it"),
    "FCL contacts": dict(color="#74c476", marker="<", label="FCL contacts"),
    "FCL distance": dict(color="#006d2c", marker=">", label="FCL distance"),
    "Bullet contacts": dict(color="#252525", marker="X", label="Bullet contacts"),
}
NOTICEABLE_FORCE = 0.07  # Pang, Tan and Durlach 1991 (wrench.md)


def spreads(rows):
    """The figures of wrench.csv, by contacts, method, voxel size and name."""
    figures = {}
    for r in rows:
        figures.setdefault((r["contacts"], r["method"]), {}).setdefault(r["voxel_m"], {})[r["figure"]] = r
    return figures


def quartile_bars(force):
    """Around the medians, percent, as errorbar() takes them."""
    return [[100 * (f["p50"] - f["p25"]) for f in force], [100 * (f["p75"] - f["p50"]) for f in force]]


def wrench(rows, _):
    figures = spreads(rows)
    figure, axes = pyplot.subplots(1, len(bench_csv.WRENCH_GROUPS), figsize=(11, 5.6), sharey=True)
    for axis, group in zip(axes, bench_csv.WRENCH_GROUPS):
        for method, look in WRENCH_LOOKS.items():
            sizes = sorted(figures.get((group, method), {}).items(), reverse=True)
            if not sizes:
                continue
            force = [of["force"] for _, of in sizes]
            at = [of["frame, us"]["p50"] for _, of in sizes]
            error = [100 * f["p50"] for f in force]
            axis.errorbar(at, error, yerr=quartile_bars(force), fmt="none", ecolor=look["color"], elinewidth=0.7, alpha=0.6)
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


# The methods of the kinds of files that voxelize writes.
FILE_METHODS = {"full": "default, distances", "lean": "default, Euclidean layers", "chebyshev": "default, Chebyshev layers"}


def wrench_files(rows, read):
    """Time of a bake against error of the force, by pair of meshes and kind of file."""
    figures, pairs = spreads(read("wrench")), unique(rows, "pair")
    figure, axes = pyplot.subplots(1, len(pairs), figsize=(11, 3.9), sharey=True, squeeze=False)
    for axis, pair in zip(axes[0], pairs):
        for kind, method in FILE_METHODS.items():
            look = WRENCH_LOOKS[method]
            curve = [r for r in rows if (r["pair"], r["kind"]) == (pair, kind) and r["voxel_m"] in figures.get((pair, method), {})]
            curve.sort(key=lambda r: -r["voxel_m"])
            force = [figures[pair, method][r["voxel_m"]]["force"] for r in curve]
            x, y = values(curve, "bake_cpu_s", 1e3), [100 * f["p50"] for f in force]
            axis.errorbar(x, y, yerr=quartile_bars(force), color=look["color"], marker=look["marker"], ms=4, elinewidth=0.7,
                          label=look["label"])
            for r, at, error in zip(curve, x, y):
                if kind == "full":
                    axis.annotate(f"{1e3 * r['voxel_m']:g} mm", (at, error), textcoords="offset points", xytext=(4, -10), fontsize=7)
        axis.axhline(100 * NOTICEABLE_FORCE, color="black", lw=0.8, ls=":")
        axis.set(xscale="log", yscale="log", title=pair, xlabel="bake (ms of processor time)")
        axis.xaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axes[0][0].set_ylabel("error of the force (percent)")
    legend_below(figure, axes[0][:1], 3, 0.07)
    return figure


def clearance(rows, read):
    """Slack of the proven clearance by exact distance; and against the time of a bake, by voxel size."""
    bakes = [r for r in read("wrench_files") if r["kind"] == "full"]
    figure, axes = pyplot.subplots(1, 2 if bakes else 1, figsize=(11 if bakes else 6, 3.8), squeeze=False)
    # Bands with an end; the whole band beyond 1.2 voxels is for the second plot.
    bands = [r for r in rows if r["scenes"] == "all" and r["to_voxels"] is not None]
    label = [f"{r['from_voxels']:g} - {r['to_voxels']:g}" for r in bands]
    for n, (name, key) in enumerate((("claimed in a frame", "slack"), ("most that the files prove", "provable"),
                                     ("were all points exact", "by_points"))):
        known = [(i, r) for i, r in enumerate(bands) if r[f"{key}_median"] is not None]
        place = [i + 0.18 * (n - 1) for i, _ in known]
        median, p99 = ([r[f"{key}_{q}"] for _, r in known] for q in ("median", "p99"))
        axes[0][0].vlines(place, median, p99, color=f"C{n}", lw=1)
        axes[0][0].plot(place, median, "o", color=f"C{n}", ms=5, label=f"{name}: median, line to 99%")
    axes[0][0].set(xlabel="exact distance (voxels)", ylabel="slack: exact less proven (voxels)", ylim=(0, 1.9))
    plain(axes[0][0].xaxis, range(len(bands)), label)
    axes[0][0].legend(loc="upper left")
    if bakes:
        (slack,) = [r["slack_median"] for r in rows if r["scenes"] == "all" and r["from_voxels"] == 1.2 and r["to_voxels"] is None]
        for n, pair in enumerate(unique(bakes, "pair")):
            curve = [r for r in bakes if r["pair"] == pair]
            axes[0][1].plot(values(curve, "bake_cpu_s"), values(curve, "voxel_m", 1e3 * slack), marker="os^vD"[n % 5], ms=4, label=pair)
        axes[0][1].set(xscale="log", yscale="log", xlabel="bake (s of processor time)",
                       ylabel="median slack beyond 1.2 voxels (mm)")
        axes[0][1].xaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        plain(axes[0][1].yaxis, values(curve, "voxel_m", 1e3 * slack),
              [f"{1e3 * slack * r['voxel_m']:.2g}, voxels of {1e3 * r['voxel_m']:g} mm" for r in curve])
        axes[0][1].set_xlim(left=min(values(bakes, "bake_cpu_s")) / 6)
        axes[0][1].legend(loc="lower left")
    figure.tight_layout()
    return figure


def narrow_gaps(rows, _):
    """Room that a part needs in a gap, by standoff: from where some pass to where all do."""
    figure, axis = pyplot.subplots(figsize=(7, 4.2))
    standoffs = {"full": 2.87, "lean": 2.73}  # of two layers (voxmap_format.md)
    def standoff(row):
        return standoffs.get(row["map"]) or float(row["map"].split()[1])
    for n, (case, covering) in enumerate(dict.fromkeys((r["case"], r["covering_voxels"]) for r in rows)):
        curve = sorted((r for r in rows if (r["case"], r["covering_voxels"]) == (case, covering)), key=standoff)
        x = [standoff(r) + 0.02 * (n - 1.5) for r in curve]
        axis.vlines(x, values(curve, "some_pass_voxels"), values(curve, "all_pass_voxels"), color=f"C{n}", lw=1.5)
        axis.plot(x, values(curve, "all_pass_voxels"), "osv^"[n % 4], color=f"C{n}", ms=5, label=f"{case}, covering radius {covering:g}")
    far = max(map(standoff, rows))
    axis.plot([0.9, far], [1.8, 2 * far], color="0.5", ls=":", label="twice the standoff")
    axis.set(xlabel="standoff (voxels)", ylabel="room: gap less part (voxels)",
             title="Markers: all pass from there; lines down to where none passes")
    axis.legend()
    figure.tight_layout()
    return figure


BAKE_LOOKS = {"voxelize": ("Forcelayer: whole bake, into the file", "o"),
              "chebyshev": ("with --metric chebyshev", "v"),
              "mesh-to-volume-0.5": ("meshToVolume, centers within 0.5 voxel", "s"),
              "mesh-to-volume-0.866": ("meshToVolume, within 0.866 voxel", "^"), "vtk": ("vtkVoxelModeller", "D")}


def bake_error(rows, _):
    scenes = unique(rows, "scene")
    figure, axes = pyplot.subplots(1, len(scenes), figsize=(11, 3.8), sharex=True, sharey=True, squeeze=False)
    for axis, scene in zip(axes[0], scenes):
        for program, (label, marker) in BAKE_LOOKS.items():
            curve = [r for r in rows if (r["scene"], r["program"]) == (scene, program)]
            axis.plot([100 * r["rms_voxels"] / r["voxels"] for r in curve], values(curve, "wall_s"), marker=marker, ms=4,
                      lw=2 if program in ("voxelize", "chebyshev") else 1, label=label)
        axis.set(xscale="log", yscale="log", title=scene)
        plain(axis.xaxis, (2, 1, 0.5, 0.2))
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axes[0][0].invert_xaxis()
    axes[0][0].set_ylabel("time (s)")
    figure.supxlabel("RMS error of the force layer's mid-surface, percent of the longest side", y=0.15, fontsize=9)
    legend_below(figure, axes[0][:1], 3, 0.14)
    return figure


def bake_growth(rows, _):
    figure, axes = pyplot.subplots(2, 2, figsize=(9, 6.2))
    curves = [("triangles", "triangles", scene) for scene in unique(rows, "scene")]
    curves += [("resolution", "voxels", scene) for scene in unique(rows, "scene")]
    for series, x, scene in curves:
        curve = [r for r in rows if (r["series"], r["scene"]) == (series, scene)]
        for axis, key, factor in zip(axes[:, int(x == "voxels")], ("wall_s", "peak_bytes"), (1, 1e-6)):
            if curve:
                axis.plot(values(curve, x), values(curve, key, factor), marker="o", ms=3,
                          label="aircraft bay at 2 mm" if x == "triangles" else scene)
    for axis in axes.flat:
        axis.set(xscale="log", yscale="log")
        axis.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        axis.legend()
    for line in axes:
        count = [r["triangles"] for r in rows if r["series"] == "triangles"]
        plain(line[0].xaxis, count, [f"{n / 1e6:.2g} M" for n in count])
        plain(line[1].xaxis, [2 ** n for n in range(7, 13)])
        line[0].set_xlabel("triangles")
        line[1].set_xlabel("voxels across the longest side")
    for axis, label in zip(axes, ("whole command (s)", "peak memory (MB)")):
        axis[0].set_ylabel(label)
    figure.tight_layout()
    return figure


def bake_streams(rows, _):
    figure, axis = pyplot.subplots(figsize=(6, 3.4))
    count = values(rows, "triangles")
    axis.plot(count, values(rows, "peak_bytes", 1e-6), marker="o", color="#08519c", label="peak memory")
    axis.plot(count, values(rows, "on_disk_bytes", 1e-6), marker="s", color="#9ecae1", linestyle="--",
              label="snapped triangles in the temporary file")
    axis.set(xscale="log", xlabel="triangles of the scene", ylabel="MB", ylim=(0, None))
    plain(axis.xaxis, count, [f"{n / 1e6:.3g} M" for n in count])
    axis.legend()
    figure.tight_layout()
    return figure


def cores(rows, _):
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


def trajectory_label(row):
    if row["model"] == "paper":
        return "paper"
    words = ["default"]
    if row["stiffness_factor"] != 1:
        words.append(f"stiffness x {row['stiffness_factor']:g}")
    if row["voxel_m"] != 0.005:
        words.append(f"voxels of {1e3 * row['voxel_m']:g} mm")
    return ", ".join(words)


def trajectory(rows, _):
    motions, labels = unique(rows, "motion"), list(dict.fromkeys(map(trajectory_label, rows)))
    figure, axes = pyplot.subplots(1, len(motions), figsize=(10, 4.2), sharey=True, squeeze=False)
    for axis, motion in zip(axes[0], motions):
        for n, label in enumerate(labels):
            curve = [r for r in rows if r["motion"] == motion and trajectory_label(r) == label]
            if curve:
                axis.plot(values(curve, "rate_hz"), values(curve, "error_m", 1e3), marker="os^vDX"[n % 6], ms=4,
                          lw=2 if n == 0 else 1, color=f"C{n}", label=label)
        axis.set(xscale="log", yscale="log", title=motion, xlabel="rate (Hz)")
        plain(axis.xaxis, unique(rows, "rate_hz"))
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axes[0][0].set_ylabel("RMS distance from the path at 1 MHz (mm)")
    legend_below(figure, axes[0], 3, 0.1)
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


# Each gets the rows of the file of its name, and a way to read those of another of the same machine.
PLOTS = (query, wrench, wrench_files, bake_error, bake_growth, bake_streams, cores, trajectory, clearance, narrow_gaps)


def main():
    for folder in map(pathlib.Path, sys.argv[1:] or sorted(bench_csv.RESULTS.iterdir())):
        for plot in PLOTS:
            source = folder / f"{plot.__name__}.csv"
            if source.exists():
                def read(name, folder=folder):
                    other = folder / f"{name}.csv"
                    return bench_csv.Table(other).rows if other.exists() else []
                figure = plot(read(plot.__name__), read)
                save(figure, source.with_suffix(".svg"))
                pyplot.close(figure)


if __name__ == "__main__":
    main()
