#!/usr/bin/python3
"""How the time of a frame grows with the points of the shell and with the patch in contact: fitted exponents.

Usage: frame_growth.py [QUERY.json [JSON [SVG]]]

Measures nothing: it reads what query_bench measured. From 10^4 points on, by motion: the exponent of
median time over points, all skipping and none; and over all motions and sizes the exponent of time
over points in the band of the force layer, where there are at least a hundred.
"""

import json
import math
import pathlib
import sys

import bench_scenes

bench_scenes.with_system_python()

import matplotlib  # noqa: E402
import numpy as np  # noqa: E402

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

LEAST_POINTS = 10 ** 4
LEAST_PATCH = 100
WAYS = ("all skipping", "no skipping")


def fit(x, y):
    """(exponent, factor) of y = factor * x^exponent, and the largest ratio between the two."""
    exponent, log_factor = np.polyfit(np.log(x), np.log(y), 1)
    off = np.abs(np.log(y) - (exponent * np.log(x) + log_factor)).max()
    return {"exponent": float(exponent), "factor": math.exp(log_factor), "off_by_at_most": math.exp(off),
            "from": float(min(x)), "to": float(max(x))}


def time_us(row, way):
    return row["methods"][way]["frame_ns"]["p50"] / 1e3


def study(rows):
    fits = []
    for motion in dict.fromkeys(row["motion"] for row in rows):
        large = [row for row in rows if row["motion"] == motion and row["points"] >= LEAST_POINTS]
        if len(large) < 2:
            continue
        for way in WAYS:
            fits.append({"what": "points", "motion": motion, "method": way,
                         **fit([row["points"] for row in large], [time_us(row, way) for row in large])})
    patches = [row for row in rows if row["mean_points_in_band"] >= LEAST_PATCH]
    if len(patches) >= 2:
        fits.append({"what": "patch", "motion": "all", "method": "all skipping",
                     **fit([row["mean_points_in_band"] for row in patches],
                           [time_us(row, "all skipping") for row in patches])})
    return fits


def plot(rows, fits, machine):
    figure, axes = pyplot.subplots(1, 2, figsize=(10, 4.4), sharey=True)
    for n, motion in enumerate(dict.fromkeys(row["motion"] for row in rows)):
        of_motion = [row for row in rows if row["motion"] == motion]
        found = [f for f in fits if f["motion"] == motion and f["method"] == "all skipping"]
        label = f"{motion}: points^{found[0]['exponent']:.2f}" if found else motion
        axes[0].plot([row["points"] for row in of_motion], [time_us(row, "all skipping") for row in of_motion],
                     marker="o", ms=4, lw=1, color=f"C{n}", label=label)
        near = [row for row in of_motion if row["mean_points_in_band"] > 0]
        axes[1].plot([row["mean_points_in_band"] for row in near], [time_us(row, "all skipping") for row in near],
                     marker="o", ms=4, ls="", color=f"C{n}")
    for f in (f for f in fits if f["what"] == "patch"):
        x = np.array([f["from"], f["to"]])
        axes[1].plot(x, f["factor"] * x ** f["exponent"], color="0.4", lw=1,
                     label=f"patch^{f['exponent']:.2f}, off by {f['off_by_at_most']:.1f} at most")
    for axis in axes:
        axis.set(xscale="log", yscale="log")
        axis.grid(True, which="major", lw=0.4)
        axis.legend(fontsize=8)
    axes[0].set(xlabel="points of the shell (exponents from 10^4 on)", ylabel="contact query, median of a frame (us)")
    axes[1].set(xlabel="points in the band of the force layer")
    figure.suptitle(f"Growth of a frame's time, all skipping: one core of {machine['cpu']}, {machine['date'][:10]}",
                    fontsize=10)
    figure.subplots_adjust(left=0.08, right=0.99, top=0.9, bottom=0.13, wspace=0.05)
    return figure


def main():
    results = bench_scenes.results_folder()
    query = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else results / "query.json"
    path = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else query.with_name("frame_growth.json")
    picture = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else path.with_suffix(".svg")
    report = json.loads(query.read_text())
    rows = report["results"]["rows"]
    fits = study(rows)
    for f in fits:
        print(f"{f['motion']:10} {f['method']:13} time ~ {f['what']}^{f['exponent']:.2f} from {f['from']:.0f} to "
              f"{f['to']:.0f}, off by {f['off_by_at_most']:.2f} at most")
    bench_scenes.write_report("frame_growth", fits, path)
    bench_scenes.save_figure(plot(rows, fits, report["machine"]), picture)


if __name__ == "__main__":
    main()
