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


WRENCH_LOOKS = {"default": "o", "default, Euclidean layers": "p", "default, distances": "*",
                "level field": "v", "paper: tangent plane, N/10": "s", "shell in a trilinear level set": "^",
                "FCL mesh contacts": "D", "Bullet mesh contacts": "X"}
NOTICEABLE_FORCE = 0.07  # the least of the published range (wrench.md)


def front(points):
    """The points that no other beats in both time and error, in the order of time."""
    best = []
    for point in sorted(points):
        if not best or point[1] < best[-1][1]:
            best.append(point)
    return best


def wrench(rows):
    groups = unique(rows, "contacts")
    figure, axes = pyplot.subplots(1, len(groups), figsize=(11, 4.8), sharey=True, squeeze=False)
    for axis, group in zip(axes[0], groups):
        every = []
        for method, marker in WRENCH_LOOKS.items():
            points = [r for r in rows if (r["contacts"], r["method"]) == (group, method) and r["force_error"] is not None]
            if not points:
                continue
            x, y = values(points, "frame_p50_us"), values(points, "force_error", 100)
            every += zip(x, y)
            look = {"marker": marker, "color": f"C{list(WRENCH_LOOKS).index(method)}", "ls": ""}
            axis.plot(x, y, lw=1, color=look["color"])
            finest = min(values(rows, "voxel_m"))
            for row, *at in zip(points, x, y):
                axis.plot(*at, **look, **({"label": method} if row["voxel_m"] == finest else {"mfc": "white"}))
        pareto = front(every)
        axis.step([p[0] for p in pareto], [p[1] for p in pareto], where="post", color="0.6", lw=4, alpha=0.5, zorder=0,
                  label="not beaten in both")
        axis.axhline(100 * NOTICEABLE_FORCE, color="0.4", lw=0.8, ls=":", label="the least that a hand notices")
        axis.set(xscale="log", yscale="log", title=group, xlabel="median time of a frame (us, one core)")
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axes[0][0].set_ylabel("error of the force (percent of the true force)")
    figure.suptitle("Voxels of 5 mm (filled) and 10 mm (open)", fontsize=9)
    legend_below(figure, axes[0], 4, 0.13)
    return figure


BAKE_LOOKS = {"voxelize": ("Forcelayer: whole bake, into the file", "o"),
              "mesh-to-volume-0.5": ("meshToVolume, centers within 0.5 voxel", "s"),
              "mesh-to-volume-0.866": ("meshToVolume, within 0.866 voxel", "^"), "vtk": ("vtkVoxelModeller", "D")}


def bake_error(rows):
    scenes = unique(rows, "scene")
    figure, axes = pyplot.subplots(1, len(scenes), figsize=(11, 3.8), sharex=True, sharey=True, squeeze=False)
    for axis, scene in zip(axes[0], scenes):
        for program, (label, marker) in BAKE_LOOKS.items():
            curve = [r for r in rows if (r["scene"], r["program"]) == (scene, program)]
            axis.plot([100 * r["rms_voxels"] / r["voxels"] for r in curve], values(curve, "wall_s"), marker=marker, ms=4,
                      lw=2 if program == "voxelize" else 1, label=label)
        axis.set(xscale="log", yscale="log", title=scene)
        plain(axis.xaxis, (2, 1, 0.5, 0.2))
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axes[0][0].invert_xaxis()
    axes[0][0].set_ylabel("time (s)")
    figure.supxlabel("RMS error of the force layer's mid-surface, percent of the longest side", y=0.08, fontsize=9)
    legend_below(figure, axes[0][:1], 4, 0.06)
    return figure


def bake_growth(rows):
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


def bake_streams(rows):
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


def trajectory_label(row):
    if row["model"] == "paper":
        return "paper"
    words = ["default"]
    if row["stiffness_factor"] != 1:
        words.append(f"stiffness x {row['stiffness_factor']:g}")
    if row["voxel_m"] != 0.005:
        words.append(f"voxels of {1e3 * row['voxel_m']:g} mm")
    return ", ".join(words)


def trajectory(rows):
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


PLOTS = (query, wrench, bake_error, bake_growth, bake_streams, trajectory)


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
