#!/usr/bin/python3
"""What a finer voxel costs and what it buys: time and memory of a bake against its geometric error.

Usage: bake_error.py [--bin FOLDER] [--short] [--json FILE] [--plot FILE.svg]

Runs geometry_bench with our bake and its peers over voxel sizes on the sample scene, the generated aircraft
bay and the models of ../shared/models. Prints a table; writes JSON and a plot.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import bench_scenes

bench_scenes.with_system_python()

import matplotlib  # noqa: E402

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402

ACROSS = (32, 64, 128, 256)
REPEAT = 3
TICKS_PERCENT = (2, 1, 0.5, 0.2, 0.1)
PROGRAMS = {"voxelize": "Forcelayer: whole bake, into the file",
            "mesh-to-volume-0.5": "meshToVolume, centres within 0.5 voxel",
            "mesh-to-volume-0.866": "meshToVolume, within 0.866 voxel",
            "vtk": "vtkVoxelModeller"}
# Proven between exact surfaces by two layers and a shell of the paper's covering radius, in voxels,
# where no touched voxel is missed (formats/voxmap_format.md; less the snap of 2^-10 voxel).
PROVEN_VOXELS = 2 - 1 - 3 ** 0.5 / 2 - 3 ** 0.5 / 2048


def measure_one(bin_folder, program, scene, across):
    command = [bin_folder / "geometry_bench", program, scene.path, "--voxels", str(across)]
    if scene.units:
        command += ["--units", scene.units]
    rows = [json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
            for _ in range(REPEAT)]
    best = {"scene": scene.name, **rows[0]}
    for key in ("wall_s", "cpu_s", "peak_rss_bytes"):
        best[key] = min(r[key] for r in rows)
    exact = best["missed_voxels"] == 0 and best["wrong_classes"] == 0
    best["proven_separation_m"] = PROVEN_VOXELS * best["voxel_size_m"] if exact else None
    return best


def measure(bin_folder, short):
    rows = []
    print(f"{'scene':9} {'program':21} {'across':>6} {'wall ms':>9} {'cpu ms':>8} {'MB':>5} {'missed':>7} "
          f"{'added':>7} {'wrong':>8} {'rms vox':>7} {'max vox':>7} {'rms mm':>8} {'proven mm':>9}")
    with tempfile.TemporaryDirectory() as name:
        scenes = [bench_scenes.sample_scene(), bench_scenes.aircraft_scene(pathlib.Path(name))]
        models = bench_scenes.model_scenes()
        scenes += [m for m in models if not short or m.name == "engine"]
        for scene in scenes:
            for across in ACROSS[1:3] if short else ACROSS:
                for program in PROGRAMS:
                    rows.append(measure_one(bin_folder, program, scene, across))
                    print_row(rows[-1])
    return rows


def rms_mm(r):
    return r["mid_surface"]["rms_voxels"] * r["voxel_size_m"] * 1e3


def print_row(r):
    mid, proven = r["mid_surface"], r["proven_separation_m"]
    print(f"{r['scene']:9} {r['program']:21} {r['voxels_across']:6} {r['wall_s'] * 1e3:9.1f} "
          f"{r['cpu_s'] * 1e3:8.1f} {r['peak_rss_bytes'] / 1e6:5.0f} "
          f"{r['missed_voxels'] / r['touched_voxels']:7.1%} {r['added_voxels'] / r['touched_voxels']:7.1%} "
          f"{r['wrong_classes']:8} {mid['rms_voxels']:7.3f} {mid['max_voxels']:7.2f} {rms_mm(r):8.3f} "
          f"{'-' if proven is None else format(proven * 1e3, '9.4f'):>9}", flush=True)


def plot(rows, machine):
    scenes = list(dict.fromkeys(r["scene"] for r in rows))
    figure, axes = pyplot.subplots(2, len(scenes), figsize=(2.6 * len(scenes) + 0.8, 6.4),
                                   sharex=True, sharey="row", squeeze=False)
    for column, scene in enumerate(scenes):
        for (program, label), marker in zip(PROGRAMS.items(), "os^D"):
            curve = [r for r in rows if r["scene"] == scene and r["program"] == program]
            x = [r["mid_surface"]["rms_voxels"] / r["voxels_across"] * 100 for r in curve]
            style = {"marker": marker, "ms": 4, "lw": 2 if program == "voxelize" else 1}
            axes[0][column].plot(x, [r["wall_s"] for r in curve], label=label, **style)
            axes[1][column].plot(x, [r["peak_rss_bytes"] / 1e6 for r in curve], **style)
        axes[0][column].set_title(scene, fontsize=10)
    figure.supxlabel("RMS error of the force layer's mid-surface, in percent of the longest side", fontsize=10,
                     y=0.105)
    for axis in axes.flat:
        axis.set(xscale="log", yscale="log")
        axis.grid(True, which="major", lw=0.4)
    axes[0][0].invert_xaxis()
    axes[0][0].set_xticks(TICKS_PERCENT, [f"{x:g}" for x in TICKS_PERCENT])
    axes[0][0].xaxis.set_minor_locator(ticker.NullLocator())
    axes[0][0].set_ylabel("time (s)")
    axes[1][0].set_ylabel("peak memory (MB)")
    figure.legend(*axes[0][0].get_legend_handles_labels(), loc="lower center", ncols=2, fontsize=8)
    figure.subplots_adjust(left=1.1 / figure.get_figwidth(), right=0.98, top=0.86, bottom=0.18, wspace=0.08)
    figure.suptitle("Finer voxels to the right; only Forcelayer misses and adds no voxel\n"
                    f"{machine['cores']} cores of {machine['cpu']}", fontsize=10)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], prog="bake_error.py")
    results = bench_scenes.results_folder()
    parser.add_argument("--bin", type=pathlib.Path, default=bench_scenes.ROOT / "build/release/bin")
    parser.add_argument("--short", action="store_true", help="fewer scenes and sizes")
    parser.add_argument("--json", type=pathlib.Path, default=results / "bake_error.json")
    parser.add_argument("--plot", type=pathlib.Path, default=results / "bake_error.svg")
    arguments = parser.parse_args()
    rows = measure(arguments.bin, arguments.short)
    bench_scenes.write_report("bake_error", rows, arguments.json)
    machine = json.loads(arguments.json.read_text())["machine"]
    bench_scenes.save_figure(plot(rows, machine), arguments.plot)


if __name__ == "__main__":
    main()
