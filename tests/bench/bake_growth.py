#!/usr/bin/python3
"""How the time and memory of a bake grow: with triangles, and with 1/s.

Usage: bake_growth.py [--bin FOLDER] [--short] [--repeat N] [--json FILE] [--plot FILE.svg]

Bakes the generated aircraft bay at 2 mm (4000 voxels across) with 150 thousand to 10.5 million
triangles, then the bay of 593,409 and the models of ../shared/models at 128 to 4096 voxels across,
every bake a process of its own; --short: up to 1.2 million triangles and 1024 voxels. Prints a table with the exponents of growth; writes JSON and a plot.
"""

import argparse
import json
import math
import pathlib
import tempfile

import bench_scenes

bench_scenes.with_system_python()

import matplotlib  # noqa: E402

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402

POLYGONS = (150000, 300000, 593409, 1200000, 2500000, 5000000, 10500000)
POLYGONS_VOXEL_M = 0.002
ACROSS = (128, 256, 512, 1024, 2048)
ACROSS_AIRCRAFT = (*ACROSS, 4096)
PAPER = {"voxel_size_m": 0.005, "triangles": 593409, "seconds": 70, "megabytes": 21}


def row(series, scene, voxel_size_m, facts):
    seconds = facts["seconds"]
    return {"series": series, "scene": scene.name, "voxel_size_m": voxel_size_m,
            "voxels_across": max(facts["dims"]) - 2 * (facts["layers"] + 1), "triangles": facts["triangles"],
            "wall_s": facts["wall_s"], "cpu_s": facts["cpu_s"], "read_s": seconds["read"],
            "bake_s": seconds["total"] - seconds["read"],
            "peak_rss_bytes": facts["peak_rss_bytes"], "file_bytes": facts["file_bytes"],
            "surface_voxels": facts["counts"]["surface"]}


def measure(bin_folder, repeat, short):
    rows = []

    def add(series, scene, voxel_size_m, output):
        rows.append(row(series, scene, voxel_size_m, bench_scenes.bake(
            bin_folder, scene, voxel_size_m, output, repeat)))
        print_row(rows[-1])

    print_header()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        output = folder / "growth.vox"
        for polygons in POLYGONS[:4] if short else POLYGONS:
            scene = bench_scenes.aircraft_scene(folder / "bay", polygons)
            add("triangles", scene, POLYGONS_VOXEL_M, output)
        scene = bench_scenes.aircraft_scene(folder / "bay")
        add("paper", scene, PAPER["voxel_size_m"], output)
        for across in ACROSS_AIRCRAFT[:4] if short else ACROSS_AIRCRAFT:
            add("resolution", scene, scene.longest_m / across, output)
        for scene in bench_scenes.model_scenes():
            for across in ACROSS[:4] if short else ACROSS:
                add("resolution", scene, scene.longest_m / across, output)
    return rows


def print_header():
    print(f"{'series':10} {'scene':9} {'triangles':>10} {'voxels':>7} {'wall ms':>9} {'cpu ms':>9} "
          f"{'read ms':>8} {'MB peak':>8} {'MB file':>8}")


def print_row(r):
    print(f"{r['series']:10} {r['scene']:9} {r['triangles']:10} {r['voxels_across']:7.0f} "
          f"{r['wall_s'] * 1e3:9.0f} {r['cpu_s'] * 1e3:9.0f} {r['read_s'] * 1e3:8.0f} "
          f"{r['peak_rss_bytes'] / 1e6:8.1f} {r['file_bytes'] / 1e6:8.2f}", flush=True)


def exponent(rows, x, y):
    """Slope between the last two rows, on logarithmic axes: where fixed costs count least."""
    a, b = rows[-2:]
    return math.log(b[y] / a[y]) / math.log(b[x] / a[x])


def series_of(rows):
    """Rows of every curve, by (series, scene)."""
    curves = {}
    for r in rows:
        if r["series"] != "paper":
            curves.setdefault((r["series"], r["scene"]), []).append(r)
    return curves


def print_summary(rows):
    for (series, scene), curve in series_of(rows).items():
        x = "triangles" if series == "triangles" else "voxels_across"
        print(f"{scene} against {x}: CPU time ~ x^{exponent(curve, x, 'cpu_s'):.2f}, memory ~ "
              f"x^{exponent(curve, x, 'peak_rss_bytes'):.2f}, file ~ "
              f"x^{exponent(curve, x, 'file_bytes'):.2f}")
    by_count = {r["triangles"]: r for r in rows if r["series"] == "triangles"}
    paper = next(r for r in rows if r["series"] == "paper")
    small, large = by_count[POLYGONS[2]], by_count[max(by_count)]
    each = [r["cpu_s"] / r["triangles"] * 1e9 for r in (paper, small, large)]
    print(f"{paper['triangles']} polygons at 5 mm: {paper['wall_s']:.2f} s, "
          f"{paper['file_bytes'] / 1e6:.1f} MB, peak {paper['peak_rss_bytes'] / 1e6:.0f} MB "
          f"(paper: {PAPER['seconds']} s, {PAPER['megabytes']} MB)")
    print(f"CPU time a triangle: {each[0]:.0f} ns there; at 2 mm {each[1]:.0f} ns of "
          f"{small['triangles']} and {each[2]:.0f} ns of {large['triangles']} triangles "
          f"(ratio {each[2] / each[0]:.2f} and {each[2] / each[1]:.2f})")


def plot(rows, machine):
    figure, axes = pyplot.subplots(2, 2, figsize=(9, 6.4), layout="constrained")
    for (series, scene), curve in series_of(rows).items():
        column = 0 if series == "triangles" else 1
        x = [r["triangles" if column == 0 else "voxels_across"] for r in curve]
        label = "aircraft bay at 2 mm" if column == 0 else scene
        axes[0][column].plot(x, [r["wall_s"] for r in curve], marker="o", ms=3, label=label)
        axes[1][column].plot(x, [r["peak_rss_bytes"] / 1e6 for r in curve], marker="o", ms=3,
                             label=label)
    for line in axes:
        for axis in line:
            axis.set(xscale="log", yscale="log")
            axis.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
            axis.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
            axis.yaxis.set_minor_locator(ticker.NullLocator())
            axis.grid(True, which="major", lw=0.4)
            axis.legend(fontsize=8)
        line[1].set_xticks(ACROSS_AIRCRAFT, [str(n) for n in ACROSS_AIRCRAFT], minor=False)
        line[1].xaxis.set_minor_locator(ticker.NullLocator())
        line[0].set_xticks(POLYGONS, [f"{n / 1e6:.2g} M" for n in POLYGONS], minor=False)
        line[0].xaxis.set_minor_locator(ticker.NullLocator())
        line[0].set_xlabel("triangles")
        line[1].set_xlabel("voxels across the longest side (~ 1/s)")
    for axis in axes[0]:
        axis.set_ylabel("whole command (s)")
    for axis in axes[1]:
        axis.set_ylabel("peak memory (MB)")
    figure.suptitle(f"voxelize on {machine['cores']} cores of {machine['cpu']}", fontsize=10)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], prog="bake_growth.py")
    results = bench_scenes.results_folder()
    parser.add_argument("--bin", type=pathlib.Path, default=bench_scenes.ROOT / "build/release/bin")
    parser.add_argument("--short", action="store_true", help="fewer sizes, each once")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--json", type=pathlib.Path, default=results / "bake_growth.json")
    parser.add_argument("--plot", type=pathlib.Path, default=results / "bake_growth.svg")
    arguments = parser.parse_args()
    rows = measure(arguments.bin, 1 if arguments.short else arguments.repeat, arguments.short)
    print_summary(rows)
    bench_scenes.write_report("bake_growth", rows, arguments.json)
    machine = json.loads(arguments.json.read_text())["machine"]
    bench_scenes.save_figure(plot(rows, machine), arguments.plot)


if __name__ == "__main__":
    main()
