#!/usr/bin/env python3
"""Studies of parts of the shared models, and their verdicts confirmed pose by pose by FCL.

Usage: verdicts.py [--short] [--folder FOLDER] [--json FILE]

Each study is one command, `forcelayer study`; it stays in the folder and is resumed there. verdict_bench then measures
the meshes at each pose of its path. The short form takes the parts of the STEP assembly alone.
"""

import json
import pathlib
import subprocess
import sys

import bench_scenes

ENGINE, AS1 = "cad/2CylinderEngine.glb", "cad/as1-oc-214.stp"
ROD, HEAD, VALVE_COVER = "node0/rod_123-699_0_Parts_1", "node0/node13/body_4", "node0/node13/body_5"

# name, file, part, unit, voxel, clearance, where the hand pulls it, what is taken out before
CASES = [
    ("nut on the rod", AS1, "as1/rod-assembly_1/nut_1", None, "1mm", "0.5mm", "40mm,0,0", []),
    ("other nut on the rod", AS1, "as1/rod-assembly_1/nut_2", None, "1mm", "0.5mm", "-40mm,0,0", []),
    ("nut of a bracket", AS1, "as1/l-bracket-assembly_1/nut-bolt-assembly_1/nut_3", None, "1mm", "0.5mm", "0,0,-40mm", []),
    ("valve cover", ENGINE, VALVE_COVER, "mm", "2mm", "1mm", "120mm,0,0", []),
    ("piston with pin, rod off", ENGINE, "node0/node4", "mm", "2mm", "1mm", "200mm,0,0", [ROD]),
    ("piston with pin, head and rod off", ENGINE, "node0/node4", "mm", "2mm", "1mm", "200mm,0,0",
     [ROD, HEAD, VALVE_COVER]),
]


def judge(args, case):
    name, file, part, unit, voxel, clearance, pull, without = case
    folder = args.folder / name.replace(",", "").replace(" ", "_")
    left_out = [word for node in without for word in ("--without", node)] + (["--units", unit] if unit else [])
    assembly = f"{bench_scenes.MODELS / file}#{part}"
    study = subprocess.run([args.bin / "forcelayer", "study", assembly, "--voxel-size", voxel, f"--pull={pull}", "--clearance",
                            clearance, *left_out, "--no-pictures", "--quiet", "-o", folder, "--json", folder / "answer.json"],
                           check=False).returncode
    if study not in (0, 6):
        sys.exit(f"{name}: the study ended with status {study}")
    answer = json.loads((folder / "answer.json").read_text())
    report = folder / "verdict_bench.json"
    confirmed = subprocess.run([args.bin / "verdict_bench", assembly, "--check", folder / "verdict.json", "--path",
                                folder / "path.csv", "--voxel-size", voxel, *left_out, "--json", report],
                               check=False).returncode
    if confirmed not in (0, 1):
        sys.exit(f"{name}: verdict_bench ended with status {confirmed}")
    least = answer["check"]["least_clearance"]
    return {"case": name, "file": pathlib.Path(file).name, **json.loads(report.read_text())["results"][0],
            "study": answer["verdict"], "object": least["object"], "t_s": least["t_s"],
            "words": answer["words"].split("\n")[0]}


def main():
    args = bench_scenes.arguments(sys.modules[__name__], "verdicts", bench_scenes.SHORT, (
        "--folder", {"type": pathlib.Path, "default": bench_scenes.ROOT / "build/bench/verdicts", "help": "of the studies"}))
    args.folder.mkdir(parents=True, exist_ok=True)
    results = []
    for case in CASES:
        if not (bench_scenes.MODELS / case[1]).exists() or (args.short and case[1] != AS1):
            print(f"{case[0]} left out")
            continue
        results.append(judge(args, case))
        print(results[-1])
    bench_scenes.write_report("verdicts", results, args.json)
    if any(row["contradictions"] for row in results):
        sys.exit(1)


if __name__ == "__main__":
    main()
