#!/usr/bin/env python3
"""Holds what the benchmarks time and judge as `default` against what voxrun does by default.

Usage: default_path.py BIN_FOLDER [--only PROGRAM]

voxelize, pointshell and voxrun run as a user runs them who names no option but the voxel size. The benchmarks run small.
All are programs of the same objects as those that are timed, with the calls of query, field and model counted
(counted_calls.cpp). Exit status: 0 the same path, 1 not (a line says which benchmark, and how it differs), 2 wrong usage.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SAMPLES = ROOT / "sample_data"


def run(folder, *words):
    """Its calls: times by (step, call)."""
    calls = folder / "calls"
    calls.unlink(missing_ok=True)
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "FORCELAYER_CALLS": str(calls)})
    if done.returncode != 0:
        raise SystemExit(f"default_path.py: {words[0]}: {done.stderr.strip() or done.stdout[-500:]}")
    if not calls.exists():
        return {}
    lines = (line.split("\t") for line in calls.read_text().splitlines())
    return {(step, call): int(times) for step, call, times in lines}


def path_of(calls, steps):
    """The calls, without those that only count steps, of these kinds of steps."""
    return {call for step, call in calls if step in steps and call != "step"}


def differences(name, wanted, got):
    return [f"{name}: voxrun does '{call}', the benchmark does not" for call in sorted(wanted - got)] + [
        f"{name}: the benchmark does '{call}', voxrun does not" for call in sorted(got - wanted)]


class Paths:
    def __init__(self, bin_folder, folder):
        self.bin, self.folder = bin_folder, folder
        run(folder, bin_folder / "voxelize", SAMPLES / "bay.json", "--voxel-size", "5mm", "-o", "bay.vox", "--quiet")
        run(folder, bin_folder / "pointshell", SAMPLES / "part.obj", "--units", "mm", "--voxel-size", "5mm", "-o",
            "part.pshell", "--quiet")
        calls = run(folder, bin_folder / "voxrun_counted", "bay.vox", "part.pshell", "--motion", SAMPLES / "press.csv",
                    "--json", "run.json", "--quiet")
        self.wanted = path_of(calls, ("default",))
        self.queries = {call for call in self.wanted if call.startswith("query:")}
        frames = json.loads((folder / "run.json").read_text())["frames"]
        steps = calls.get(("default", "step"))
        if len(self.queries) != 1 or len(self.wanted) != 2 or steps != frames:
            raise SystemExit(f"default_path.py: voxrun itself: {frames} frames, {calls}")

    def bench(self, program, *words):
        return run(self.folder, self.bin / f"{program}_bench_counted", *words, "--json", "bench.json")

    def report(self):
        return json.loads((self.folder / "bench.json").read_text())["results"]

    def query(self):
        """The method whose percentiles are quoted: as many queries as it has frames, and no other does the same."""
        calls = self.bench("query", "--motion", "corner", "--from", 1000, "--largest", 1000, "--no-peers", "--seconds",
                           0.01, "--our-seconds", 0.02)
        (call,) = self.queries
        wanted = self.report()["rows"][0]["methods"]["all skipping"]["frames"]
        got = calls.get(("none", call), 0)
        return [] if got == wanted else [f"query: 'all skipping' has {wanted} frames, '{call}' was done {got} times"]

    def wrench(self):
        """The files and the field of the row that the README shows."""
        calls = self.bench("wrench", "--contact", "sphere on plane", "--s", 0.5, "--orientations", 1)
        rows = [size["contacts"].get("flush and smooth", {}) for size in self.report()]
        if not all("default, distances" in row for row in rows):
            return ["wrench: has no 'default, distances'"]
        timed = sum(row["default, distances"]["figures"]["frame, us"]["n"] for row in rows)
        return [f"wrench: voxrun does '{call}', no method of the benchmark does" for call in sorted(self.wanted)
                if calls.get(("none", call), 0) <= timed]

    def stability(self):
        """Every step of `default`, and nothing else in such a step."""
        wrong = []
        for words in (("rest", 2), ("table2", 3000), ("seats", 1), ("step", 500)):
            calls = self.bench("stability", *words)
            if calls.get(("default", "step"), 0) == 0:
                wrong.append(f"stability {words[0]}: no step of default")
            wrong += differences(f"stability {words[0]}", self.wanted, path_of(calls, ("default",)))
        return wrong


BENCHES = ("query", "wrench", "stability")


def main():
    words = sys.argv[1:]
    only = BENCHES
    if len(words) == 3 and words[1] == "--only" and words[2] in BENCHES:
        only, words = (words[2],), words[:1]
    if len(words) != 1:
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        paths = Paths(pathlib.Path(words[0]).resolve(), pathlib.Path(folder))
        wrong = [line for name in only for line in getattr(paths, name)()]
        print("\n".join(wrong) or f"{', '.join(only)}: {' and '.join(sorted(paths.wanted))}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
