#!/usr/bin/python3
"""Draws a run over time: force, torque, depth, points and contacts, step time.

Usage: plot_run.py TRACE.csv [-o RUN.svg]     (also .png or .pdf; default: TRACE.svg beside it)

Reads the CSV that `voxrun --trace` writes. Exit status: 0 done, 1 file failure, 2 wrong usage,
4 no such trace.
"""

import argparse
import csv
import math
import os
import pathlib
import sys

SYSTEM_PYTHON = "/usr/bin/python3"  # where Debian's python3-matplotlib is

try:
    import matplotlib
except ImportError:
    if os.path.realpath(sys.executable) != os.path.realpath(SYSTEM_PYTHON):
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, *sys.argv])
    sys.exit("plot_run.py: matplotlib is missing; install the package python3-matplotlib")

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402  (the backend is chosen first)

COLUMNS = (["t_s"] + [f"{frame}_{n}" for frame in ("handle", "part")
                      for n in ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")]
           + [f"force_{n}_n" for n in "xyz"] + [f"torque_{n}_nm" for n in "xyz"]
           + ["points_proximity", "points_surface", "points_interior", "contacts", "depth_m",
              "guard_cuts", "step_ns"])
AXIS_LOOKS = {"x": ("#0072b2", "-"), "y": ("#d55e00", "--"), "z": ("#009e73", "-.")}
LARGEST_POINTS = 2000  # of a curve: more look alike on a page


class TraceError(Exception):
    """A fault of the trace, in one line."""


def read_trace(path):
    """Columns of the trace by name, as lists of numbers."""
    with open(path, newline="", encoding="ascii", errors="replace") as file:
        rows = csv.reader(file)
        header = next(rows, [])
        missing = [name for name in COLUMNS if name not in header]
        if missing:
            raise TraceError(f"{path}: line 1: no column '{missing[0]}'; "
                             "give the CSV that voxrun --trace wrote")
        columns = {name: [] for name in COLUMNS}
        for number, row in enumerate(rows, start=2):
            try:
                if len(row) != len(header):
                    raise ValueError("a row of another length")
                for name, cell in zip(header, row):
                    if name in columns:
                        columns[name].append(float(cell))
            except ValueError as error:
                raise TraceError(f"{path}: line {number}: {error}") from None
    if not columns["t_s"]:
        raise TraceError(f"{path}: no row follows the header")
    return columns


def magnitudes(*components):
    return [math.sqrt(sum(c * c for c in values)) for values in zip(*components)]


def stretch_mm(trace):
    """Distance of the part's frame from where the hand holds it. The grip is that of the first
    row, at which the part starts without stretch."""
    def rows(frame):
        names = ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")
        return list(zip(*(trace[f"{frame}_{n}"] for n in names)))

    handles, parts = rows("handle"), rows("part")
    grip = rotated(conjugate(handles[0][3:]), [p - h for p, h in zip(parts[0], handles[0])][:3])
    result = []
    for handle, part in zip(handles, parts):
        target = [h + g for h, g in zip(handle, rotated(handle[3:], grip))]
        result.append(1000 * math.dist(target, part[:3]))
    return result


def conjugate(q):
    return q[0], -q[1], -q[2], -q[3]


def rotated(q, v):
    """v turned by the unit quaternion q (w, x, y, z)."""
    w, u = q[0], q[1:]
    t = [2 * (u[1] * v[2] - u[2] * v[1]), 2 * (u[2] * v[0] - u[0] * v[2]),
         2 * (u[0] * v[1] - u[1] * v[0])]
    return [v[0] + w * t[0] + u[1] * t[2] - u[2] * t[1],
            v[1] + w * t[1] + u[2] * t[0] - u[0] * t[2],
            v[2] + w * t[2] + u[0] * t[1] - u[1] * t[0]]


def thinned(times, values):
    """The lowest and the highest of every group of rows, so that no peak is lost."""
    stride = 2 * max(1, len(values) // LARGEST_POINTS)
    if stride == 2:
        return times, values
    kept = []
    for start in range(0, len(values), stride):
        group = range(start, min(start + stride, len(values)))
        kept += sorted({min(group, key=values.__getitem__), max(group, key=values.__getitem__)})
    return [times[n] for n in kept], [values[n] for n in kept]


def percentile(values, fraction):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, math.ceil(fraction * len(ordered)) - 1)]


def plot_vector(axes, trace, names, unit, what):
    time_s = trace["t_s"]
    length = magnitudes(*(trace[name] for name in names))
    for name, axis in zip(names, "xyz"):
        color, dashes = AXIS_LOOKS[axis]
        axes.plot(*thinned(time_s, trace[name]), dashes, color=color, lw=0.9, label=axis)
    axes.plot(*thinned(time_s, length), color="black", lw=1.2, label="magnitude")
    axes.set_ylabel(f"{what}\n({unit})")
    axes.set_title(f"greatest {max(length):.4g} {unit}", loc="right", fontsize=8)


def plot_depth(axes, trace):
    depth, stretch = [1000 * d for d in trace["depth_m"]], stretch_mm(trace)
    axes.plot(*thinned(trace["t_s"], depth), color="black", lw=1.2, label="deepest contact")
    # On a scale of its own: it is tens of times the depth, which would look like nothing.
    beside = axes.twinx()
    beside.plot(*thinned(trace["t_s"], stretch), "--", color="#d55e00", lw=1)
    beside.set_ylabel("stretch (mm)", color="#d55e00")
    axes.plot([], [], "--", color="#d55e00", lw=1, label="coupling stretch (right)")
    axes.set_ylabel("depth\n(mm)")
    axes.set_title(f"greatest depth {max(depth):.4g} mm, stretch {max(stretch):.4g} mm",
                   loc="right", fontsize=8)


def plot_points(axes, trace):
    time_s = trace["t_s"]
    for name, color, dashes, label in (
            ("points_proximity", "#e6ab02", ":", "proximity"),
            ("points_surface", "#56b4e9", "--", "force layer"),
            ("contacts", "black", "-", "contacts")):
        axes.plot(*thinned(time_s, trace[name]), dashes, color=color, lw=1.1, label=label)
    inside = [t for t, n in zip(time_s, trace["points_interior"]) if n > 0]
    cuts = [t for t, n in zip(time_s, trace["guard_cuts"]) if n > 0]
    if inside:
        axes.plot(inside, [0] * len(inside), "D", color="#8b008b", ms=3, clip_on=False,
                  label="penetration")
    if cuts:
        axes.plot(cuts, [0] * len(cuts), "^", color="#d55e00", ms=3, clip_on=False,
                  label="guard cut")
    axes.set_ylabel("points")
    axes.set_title(f"{len(inside)} penetration frames, {len(cuts)} frames cut by the guard",
                   loc="right", fontsize=8)


def plot_step_time(axes, trace):
    step_us = [ns / 1000 for ns in trace["step_ns"]]
    axes.plot(*thinned(trace["t_s"], step_us), ".", color="#555555", ms=1.5, label="step")
    marks = [("p50", percentile(step_us, 0.5)), ("p99", percentile(step_us, 0.99)),
             ("p99.9", percentile(step_us, 0.999)), ("max", max(step_us))]
    if min(step_us) > 0:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        axes.yaxis.set_minor_formatter(ticker.NullFormatter())
    axes.set_ylabel("step time\n(us)")
    axes.set_title(", ".join(f"{name} {value:.3g} us" for name, value in marks), loc="right",
                   fontsize=8)


def plot_run(trace, title):
    figure, all_axes = pyplot.subplots(5, 1, sharex=True, figsize=(9, 9.5),
                                       constrained_layout=True)
    plot_vector(all_axes[0], trace, [f"force_{n}_n" for n in "xyz"], "N", "force on the hand")
    plot_vector(all_axes[1], trace, [f"torque_{n}_nm" for n in "xyz"], "N m", "torque on the hand")
    plot_depth(all_axes[2], trace)
    plot_points(all_axes[3], trace)
    plot_step_time(all_axes[4], trace)
    for axes in all_axes:
        axes.grid(True, lw=0.3)
        axes.margins(x=0.01)
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), fontsize=7, ncol=5, frameon=False,
                    borderpad=0.2)
    all_axes[4].set_xlabel("time (s)")
    figure.suptitle(title, fontsize=10)
    return figure


def save(figure, path):
    """Writes beside the target and renames, so that no half-written picture is seen."""
    matplotlib.rcParams.update({"svg.hashsalt": "forcelayer", "svg.fonttype": "none"})
    unfinished = path.with_name(f".{path.name}.unfinished{path.suffix}")
    try:
        figure.savefig(unfinished, dpi=130,
                       metadata={"Date": None} if path.suffix == ".svg" else None)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], prog="plot_run.py")
    parser.add_argument("trace", type=pathlib.Path, metavar="TRACE.csv")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="picture to write: .svg, .png, .pdf")
    arguments = parser.parse_args()
    output = arguments.output or arguments.trace.with_suffix(".svg")
    if output.suffix not in (".svg", ".png", ".pdf"):
        parser.error(f"{output}: the picture must end in .svg, .png or .pdf")
    try:
        trace = read_trace(arguments.trace)
        save(plot_run(trace, arguments.trace.name), output)
    except TraceError as error:
        print(f"plot_run.py: {error}", file=sys.stderr)
        return 4
    except OSError as error:
        print(f"plot_run.py: {error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
