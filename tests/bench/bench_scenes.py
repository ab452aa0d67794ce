"""What the Python benchmarks share: scenes, voxelize in a process of its own, and their reports."""

import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import time

SYSTEM_PYTHON = "/usr/bin/python3"  # where Debian's python3-matplotlib and python3-numpy are
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MODELS = ROOT.parent / "shared" / "models"


def with_system_python():
    """Starts the script again under Debian's Python where this one has no matplotlib."""
    try:
        import matplotlib  # noqa: F401
        import numpy  # noqa: F401
    except ImportError:
        if os.path.realpath(sys.executable) != os.path.realpath(SYSTEM_PYTHON):
            os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, *sys.argv])
        sys.exit("install the packages python3-matplotlib and python3-numpy")


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
    subprocess.run([SYSTEM_PYTHON, ROOT / "scripts/make_aircraft_bay.py", folder, "--polygons",
                    str(polygons)], check=True)
    return Scene("aircraft", folder / "aircraft_bay.json", None, 8.0)


def bake(bin_folder, scene, voxel_size_m, output, repeat=1):
    """The report of voxelize, with `wall_s`, `cpu_s` and `peak_rss_bytes` of the whole process: the
    least of the repetitions, since other work on the machine only ever adds time."""
    report, usage = output.with_suffix(".report.json"), output.with_suffix(".usage.json")
    command = [sys.executable, ROOT / "tests/bench/measured_run.py", usage,
               bin_folder / "voxelize", scene.path, "-o", output, "--quiet", "--json", report,
               "--voxel-size", f"{voxel_size_m:.9g}m"]
    if scene.units:
        command += ["--units", scene.units]
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
    """tests/bench/results/<cpu>, named as bench_report.cpp names it."""
    return ROOT / "tests/bench/results" / re.sub(r"[^a-z0-9]+", "-", _cpu_model().lower()).strip("-")


def readme_folder(readme_text):
    """tests/bench/results/<cpu> of the machine whose plots a README shows."""
    folders = set(re.findall(r"\(tests/bench/(results/[^/)]+)/[^)]+\.svg\)", readme_text))
    if len(folders) != 1:
        sys.exit(f"the README shows plots of {len(folders)} machines, not one")
    return ROOT / "tests/bench" / folders.pop()


def _command():
    """This run's command, without files and folders: where a figure was written says nothing of it."""
    words, rest = [pathlib.Path(sys.argv[0]).name], iter(sys.argv[1:])
    for word in rest:
        if word in ("--json", "--plot", "--bin", "--collisions"):
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


def save_figure(figure, path):
    import matplotlib
    matplotlib.rcParams.update({"svg.hashsalt": "forcelayer", "svg.fonttype": "none"})
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)
    print(f"wrote {path}")
