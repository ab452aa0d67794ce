#!/usr/bin/python3
"""Cost and gain of a finer voxel: time and memory of a bake against its geometric error.

Usage: bake_error.py [--bin FOLDER] [--short] [--json FILE]

Runs geometry_bench with our bake and its peers over voxel sizes on the sample scene, the generated aircraft
bay and the models of ../shared/models. Prints a table; writes JSON.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import bench_scenes

ACROSS = (32, 64, 128, 256)
REPEAT = 3
PROGRAMS = {"voxelize": "Forcelayer: whole bake, into the file",
            "chebyshev": "the same with --metric chebyshev",
            "mesh-to-volume-0.5": "meshToVolume, centers within 0.5 voxel",
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


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "bake_error", bench_scenes.SHORT)
    bench_scenes.write_report("bake_error", measure(arguments.bin, arguments.short), arguments.json)


if __name__ == "__main__":
    main()
