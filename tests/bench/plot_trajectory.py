#!/usr/bin/python3
"""Draws the trajectory error of contact over rate, stiffness and voxel size from trajectory.json.

Usage: plot_trajectory.py [JSON [SVG]]
"""

import json
import pathlib
import sys

import bench_scenes

bench_scenes.with_system_python()

import matplotlib  # noqa: E402

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402


def label_of(row):
    if row["model"] == "paper":
        return "paper"
    words = ["default"]
    if row["stiffness_factor"] != 1:
        words.append(f"stiffness x {row['stiffness_factor']:g}")
    if row["voxel_size_m"] != 0.005:
        words.append(f"voxels of {1e3 * row['voxel_size_m']:g} mm")
    return ", ".join(words)


def plot(report):
    rows = report["results"]
    motions = list(dict.fromkeys(r["motion"] for r in rows))
    labels = list(dict.fromkeys(label_of(r) for r in rows))
    figure, axes = pyplot.subplots(1, len(motions), figsize=(3.7 * len(motions), 4.4), sharey=True, squeeze=False)
    for axis, motion in zip(axes[0], motions):
        for row in (r for r in rows if r["motion"] == motion):
            n = labels.index(label_of(row))
            axis.plot(row["rates_hz"], [1e3 * e for e in row["error_m"]], marker="os^vDX"[n % 6], ms=4,
                      lw=2 if n == 0 else 1, color=f"C{n}", label=label_of(row))
        axis.set(xscale="log", yscale="log", title=motion, xlabel="rate (Hz)")
        axis.set_xticks(row["rates_hz"], [f"{r:g}" for r in row["rates_hz"]])
        axis.xaxis.set_minor_locator(ticker.NullLocator())
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        axis.grid(True, which="major", lw=0.4)
    axes[0][0].set_ylabel("RMS distance from the trajectory at 1 MHz (mm)")
    handles = {label: handle for axis in axes[0] for handle, label in zip(*axis.get_legend_handles_labels())}
    figure.legend(handles.values(), handles.keys(), loc="lower center", ncols=3, fontsize=8)
    figure.suptitle("Where a part in contact goes, beside the same model at a thousandth of the usual step\n"
                    f"{report['machine']['cpu']}, {report['machine']['date'][:10]}", fontsize=10)
    figure.subplots_adjust(left=0.08, right=0.99, top=0.84, bottom=0.26, wspace=0.06)
    return figure


def main():
    path = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else bench_scenes.results_folder() / "trajectory.json"
    picture = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else path.with_suffix(".svg")
    bench_scenes.save_figure(plot(json.loads(path.read_text())), picture)


if __name__ == "__main__":
    main()
