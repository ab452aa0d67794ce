#!/usr/bin/python3
"""Draws what a denser shell costs and buys from cover.json: points, time and error over the covering radius.

Usage: plot_cover.py [JSON [SVG]]
"""

import json
import pathlib
import sys

import bench_scenes

bench_scenes.with_system_python()

import matplotlib  # noqa: E402

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402

STYLES = {"surface": ("o", "-"), "fast": ("s", "--"), "voxel centres": ("X", "")}
COLOURS = {"paper": "#d55e00", "default": "#0072b2"}
GROUPS = ("flush and smooth", "corners and wedges")
PAPER_RADIUS = 3 ** 0.5 / 2


def plot(report):
    figure, axes = pyplot.subplots(1, 4, figsize=(14, 4.4))
    for method, (marker, dashes) in STYLES.items():
        rows = sorted((r for r in report["results"] if r["method"] == method),
                      key=lambda r: r["covering_radius_voxels"])
        x = [r["covering_radius_voxels"] for r in rows]
        axes[0].plot(x, [r["points"] for r in rows], marker=marker, ls=dashes, color="0.3", label=method)
        for model, colour in COLOURS.items():
            style = {"marker": marker, "ls": dashes, "color": colour, "label": f"{model}, {method}"}
            axes[1].plot(x, [r[model]["frame_us"]["p50"] for r in rows], **style)
            for axis, group in zip(axes[2:], GROUPS):
                axis.plot(x, [100 * r[model][group]["force_error"] for r in rows], **style)
    labels = ("points of the five shells", "time of a frame, median (us, one core)",
              *(f"force error, {group} (percent)" for group in GROUPS))
    for axis, label in zip(axes, labels):
        axis.axvline(PAPER_RADIUS, color="0.6", lw=0.8, ls=":")
        axis.set(xscale="log", yscale="log", xlabel="covering radius (voxels)", ylabel=label)
        axis.set_xticks((0.35, 0.5, 0.7, 1, 1.5), ("0.35", "0.5", "0.7", "1", "1.5"))
        axis.xaxis.set_minor_locator(ticker.NullLocator())
        axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        axis.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 3, 5, 7)))
        axis.yaxis.set_minor_locator(ticker.NullLocator())
        axis.grid(True, which="major", lw=0.3)
    axes[0].legend(fontsize=8)
    figure.legend(*axes[1].get_legend_handles_labels(), loc="lower center", ncols=6, fontsize=8)
    figure.suptitle("Point shells at 5 mm: what a denser one costs and buys; dotted: the paper's covering radius\n"
                    f"{report['machine']['cpu']}, {report['machine']['date'][:10]}", fontsize=10)
    figure.subplots_adjust(left=0.055, right=0.99, top=0.86, bottom=0.24, wspace=0.33)
    return figure


def main():
    path = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else bench_scenes.results_folder() / "cover.json"
    picture = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else path.with_suffix(".svg")
    bench_scenes.save_figure(plot(json.loads(path.read_text())), picture)


if __name__ == "__main__":
    main()
