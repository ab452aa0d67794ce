#!/usr/bin/python3
"""The cost of distances and objects in a bake: processor time and bytes of each kind of map.

Usage: bake_full.py [--bin FOLDER] [--short] [--repeat N] [--json FILE]

Bakes the models of ../shared/models, the sample bay and the generated aircraft bay (593,409 triangles at 5 mm and 10.5
million at 2 mm) to lean Chebyshev, lean and full files, every bake a process of its own, the kinds in turn; --short
bakes the models at one size, and the largest bay to the two kinds that the README names. Prints a table and writes JSON.
"""

import pathlib
import sys
import tempfile

import bench_scenes

KINDS = {"lean, chebyshev": ("--kind", "paper"), "lean": ("--kind", "lean"), "full": ()}
SAMPLE_VOXEL_M, PAPER_VOXEL_M, LARGE_VOXEL_M = 0.005, 0.005, 0.002
LARGE = 10500000


def scenes(folder, short):
    """Pairs of a scene and its voxel size."""
    for scene in bench_scenes.model_scenes():
        for across in (512,) if short else (128, 512, 1024, 2048) if scene.name == "counter" else (128, 512, 1024):
            yield scene, scene.longest_m / across
    yield bench_scenes.sample_scene(), SAMPLE_VOXEL_M
    yield bench_scenes.aircraft_scene(folder / "bay"), PAPER_VOXEL_M
    yield bench_scenes.aircraft_scene(folder / "large_bay", LARGE), LARGE_VOXEL_M


def measure(bin_folder, repeat, short):
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for scene, voxel_size_m in scenes(folder, short):
            kinds = {}
            for _ in range(1 if voxel_size_m == LARGE_VOXEL_M else repeat):
                for kind, options in KINDS.items():
                    if short and voxel_size_m == LARGE_VOXEL_M and kind == "lean":
                        continue
                    facts = bench_scenes.bake(bin_folder, scene, voxel_size_m, folder / "kind.vox", options=options)
                    old = kinds.setdefault(kind, facts)
                    for key in ("wall_s", "cpu_s"):
                        old[key] = min(old[key], facts[key])
            lean = kinds["lean, chebyshev"]
            for kind, facts in kinds.items():
                rows.append({
                    "scene": scene.name, "voxels": round(scene.longest_m / voxel_size_m), "triangles": facts["triangles"],
                    "voxel_m": voxel_size_m, "kind": kind, "wall_s": facts["wall_s"], "cpu_s": facts["cpu_s"],
                    "peak_bytes": facts["peak_rss_bytes"], "file_bytes": facts["file_bytes"]})
                print(f"{scene.name:9} {rows[-1]['voxels']:5} {kind:16} {facts['cpu_s']:8.3f} s "
                      f"{facts['cpu_s'] / lean['cpu_s']:6.2f}   {facts['file_bytes'] / 1e6:9.3f} MB "
                      f"{facts['file_bytes'] / lean['file_bytes']:6.2f}", flush=True)
    return rows


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "bake_full", bench_scenes.SHORT, bench_scenes.REPEAT)
    results = measure(arguments.bin, arguments.repeat, arguments.short)
    bench_scenes.write_report("bake_full", results, arguments.json)


if __name__ == "__main__":
    main()
