"""Shared by the Python benchmarks: scenes, voxelize in a process of its own, and their reports."""

import argparse
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MODELS = ROOT.parent / "shared" / "models"


class Scene:
    """A scene to bake: its name, the file, the unit where the file has none, the longest side."""

    def __init__(self, name, path, units, longest_m):
        self.name, self.path, self.units, self.longest_m = name, path, units, longest_m


def model_scenes():
    """Those of the models that are there."""
    listed = [Scene("bunny", MODELS / "scan/stanford-bunny.obj", "m", 0.15569),
              Scene("dragon", MODELS / "scan/dragon-100k.obj", "m", 2.0),
              Scene("counter", MODELS / "cad/counter.unitsmm.stl", "mm", 0.3048),
              Scene("engine", MODELS / "cad/2CylinderEngine.glb", None, 745.0)]
    return [scene for scene in listed if scene.path.exists()]


def sample_scene():
    return Scene("sample", ROOT / "sample_data/bay.json", None, 1.2)


def aircraft_scene(folder, polygons=593409):
    """The generated bay, written into `folder`."""
    subprocess.run(["/usr/bin/python3", ROOT / "scripts/make_aircraft_bay.py", folder, "--polygons",
                    str(polygons)], check=True)
    return Scene("aircraft", folder / "aircraft_bay.json", None, 8.0)


def bake(bin_folder, scene, voxel_size_m, output, repeat=1, options=()):
    """The report of voxelize with more options, and `wall_s`, `cpu_s` and `peak_rss_bytes` of the whole process: the
    least of the repetitions, since other work on the machine only ever adds time."""
    report, usage = output.with_suffix(".report.json"), output.with_suffix(".usage.json")
    command = [sys.executable, ROOT / "tests/bench/measured_run.py", usage,
               bin_folder / "voxelize", scene.path, "-o", output, "--quiet", "--json", report,
               "--voxel-size", f"{voxel_size_m:.9g}m"]
    if scene.units:
        command += ["--units", scene.units]
    command += options
    best = None
    for _ in range(repeat):
        subprocess.run(command, check=True)
        used, facts = json.loads(usage.read_text()), json.loads(report.read_text())
        if best is None:
            best = {**facts, **used}
        for key in ("wall_s", "cpu_s"):
            best[key] = min(best[key], used[key])
        for stage, seconds in facts["seconds"].items():
            best["seconds"][stage] = min(best["seconds"][stage], seconds)
    return best


def _cpu_model():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(": ", 1)[1]
    return "unknown"


def results_folder():
    """tests/bench/results/<machine>: the processor's name, and whether it lacks AVX-512."""
    name = re.sub(r"[^a-z0-9]+", "-", _cpu_model().lower()).strip("-")
    wide = platform.machine() != "x86_64" or "avx512f" in pathlib.Path("/proc/cpuinfo").read_text()
    return ROOT / "tests/bench/results" / (name if wide else f"{name}-avx2")


SHORT = ("--short", {"action": "store_true", "help": "fewer scenes, sizes and repetitions"})
REPEAT = ("--repeat", {"type": int, "default": 3, "help": "repetitions, of which the least time counts"})


def arguments(script, report, *options):
    """The command line of a Python benchmark: --bin, --json, and these (flags, keywords) beside them."""
    parser = argparse.ArgumentParser(description=script.__doc__.split("\n")[0], prog=sys.argv[0].rpartition("/")[2])
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--json", type=pathlib.Path, default=ROOT / f"build/bench/{report}.json")
    for flag, keywords in options:
        parser.add_argument(flag, **keywords)
    return parser.parse_args()


def _command():
    """This run's command, without files and folders: where a figure was written says nothing of it."""
    words, rest = [pathlib.Path(sys.argv[0]).name], iter(sys.argv[1:])
    for word in rest:
        if word in ("--json", "--bin", "--out"):
            next(rest, None)
        elif "/" not in word:
            words.append(word)
    return " ".join(words)


def write_report(benchmark, results, path):
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2 ** 30
    machine = {"cpu": _cpu_model(), "cores": os.cpu_count(), "memory_gib": round(memory),
               "system": f"{platform.system()} {platform.machine()}",
               "date": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"benchmark": benchmark, "command": _command(), "machine": machine,
                                "results": results}, indent=1) + "\n")
    print(f"wrote {path}")
