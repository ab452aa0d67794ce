#!/usr/bin/python3
"""Draws what stability_bench and motion_bench measured, beside their JSON.

Usage: plot_stability.py FOLDER     (tests/bench/results/CPU, or any folder with these files)

stability_map.json    -> stability_map.svg      quiet, calming and unstable settings
stability_device.json -> stability_device.svg   measured boundary, bound and defaults
motion.json           -> motion_error.svg       error of motion over the step
Files that are not there are left out. Exit status: 0 done, 1 file failure, 2 wrong usage.
"""

import json
import os
import pathlib
import sys

SYSTEM_PYTHON = "/usr/bin/python3"  # where Debian's python3-matplotlib is

try:
    import matplotlib
except ImportError:
    if os.path.realpath(sys.executable) != os.path.realpath(SYSTEM_PYTHON):
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, *sys.argv])
    sys.exit("plot_stability.py: matplotlib is missing; install the package python3-matplotlib")

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "forcelayer"  # the same bytes from the same figures
from matplotlib import pyplot  # noqa: E402  (the backend is chosen first)
from matplotlib.patches import Patch  # noqa: E402

CELLS = {".": ("quiet", "#009e73"), "~": ("moves less and less", "#f0e442"),
         "X": ("does not calm", "#d55e00")}
MODELS = {"paper": ("#d55e00", "s"), "default": ("#0072b2", "o")}
STIFFNESSES = ["10", "100", "1e3", "1e4", "1e5", "1e6"]


def draw_map(results):
    figure, grid = pyplot.subplots(2, 3, figsize=(9, 6), sharex=True, sharey=True)
    for row, (model, maps) in zip(grid, results.items()):
        for axes, one in zip(row, maps):
            masses = [f"{line['mass_kg']:g}" for line in one["rows"]]
            for y, line in enumerate(one["rows"]):
                for x, cell in enumerate(line["cells"]):
                    axes.add_patch(pyplot.Rectangle((x - 0.5, y - 0.5), 1, 1, edgecolor="white",
                                                    facecolor=CELLS[cell][1]))
            axes.set_xlim(-0.5, len(STIFFNESSES) - 0.5)
            axes.set_ylim(-0.5, len(masses) - 0.5)
            axes.set_xticks(range(len(STIFFNESSES)), STIFFNESSES)
            axes.set_yticks(range(len(masses)), masses)
            axes.set_title(f"{model}, {one['rate_hz']:g} Hz", fontsize=10)
    for axes in grid[-1]:
        axes.set_xlabel("coupling stiffness, N/m")
    for axes in grid[:, 0]:
        axes.set_ylabel("mass, kg")
    figure.legend(handles=[Patch(color=color, label=label) for label, color in CELLS.values()],
                  loc="lower center", ncols=3, frameon=False)
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    return figure


def draw_device(results):
    titles = {"press_n_per_m": ("part pressed on a plane", "stiffness, N/m"),
              "twist_nm_per_rad": ("bar turned in a slot", "stiffness, N m/rad")}
    figure, grid = pyplot.subplots(1, 2, figsize=(9, 4.4))
    for axes, (name, rows) in zip(grid, results.items()):
        loose = [row for row in rows if row["grip"] == "loose" and row["model"] == "default"]
        delays = [1e3 * row["delay_s"] for row in loose]
        axes.plot(delays, [row["bound"] for row in loose], "k-", label="bound")
        for model, (color, marker) in MODELS.items():
            for grip, style in (("loose", "--"), ("firm", ":")):
                mine = [row for row in rows if row["grip"] == grip and row["model"] == model]
                axes.plot([1e3 * row["delay_s"] for row in mine],
                          [row["quiet_to"] or float("nan") for row in mine], style, color=color,
                          marker=marker, mfc="none", label=f"{model}, {grip} grip: quiet up to")
        axes.plot(delays, [row["default"] for row in loose], "x", color=MODELS["default"][0],
                  markersize=9, label="default model's own stiffness")
        axes.set_yscale("log")
        axes.set_xlabel("delay, ms")
        axes.set_ylabel(titles[name][1])
        axes.set_title(titles[name][0], fontsize=10)
        axes.grid(alpha=0.3)
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=3, frameon=False, fontsize=8)
    figure.tight_layout(rect=(0, 0.12, 1, 1))
    return figure


def draw_motion(results):
    experiments = [name for name in results if name != "drift"]
    figure, grid = pyplot.subplots(1, len(experiments), figsize=(2.6 * len(experiments), 3.4))
    for axes, name in zip(grid, experiments):
        for model, row in results[name].items():
            color, marker = MODELS[model]
            order = "exact" if row["order"] is None else f"order {row['order']:.2f}"
            axes.loglog([1e3 * step for step in row["step_s"]],
                        [max(error, 1e-17) for error in row["error"]],
                        marker=marker, mfc="none", color=color, label=f"{model}: {order}")
        axes.set_title(name, fontsize=10)
        axes.set_xlabel("step, ms")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=7)
    grid[0].set_ylabel("error, m (spin: rad)")
    figure.tight_layout()
    return figure


PLOTS = {"stability_map.json": (draw_map, "stability_map.svg"),
         "stability_device.json": (draw_device, "stability_device.svg"),
         "motion.json": (draw_motion, "motion_error.svg")}


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    folder = pathlib.Path(sys.argv[1])
    try:
        for source, (draw, target) in PLOTS.items():
            if not (folder / source).exists():
                continue
            results = json.loads((folder / source).read_text(encoding="utf-8"))["results"]
            figure = draw(results)
            figure.savefig(folder / target, metadata={"Date": None})
            print(f"wrote {folder / target}")
    except (OSError, ValueError, KeyError) as error:
        print(f"plot_stability.py: {folder}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
