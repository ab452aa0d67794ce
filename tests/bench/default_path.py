#!/usr/bin/env python3
"""Holds what the benchmarks time and judge as `default` against what voxrun does by default.

Usage: default_path.py BIN_FOLDER [--only PROGRAM]

voxelize, pointshell and voxrun run as a user runs them who names no option but the voxel size. The benchmarks run small.
All are programs of the same objects as those that are timed, with the calls of query, field and model counted
(counted_calls.cpp). The paper's model, where a benchmark runs it, is held against voxrun --model paper on a file of
voxelize --kind paper. Exit status: 0 the same path, 1 not (a line says which benchmark, and how it differs), 2 wrong
usage.
"""

import collections
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import bench_loop

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SAMPLES = ROOT / "sample_data"


def counted(folder, work):
    """The calls of the programs that work() runs: times by (step, call)."""
    calls = folder / "calls"
    calls.unlink(missing_ok=True)
    os.environ["FORCELAYER_CALLS"] = str(calls)
    work()
    times_of = collections.Counter()
    for line in calls.read_text().splitlines() if calls.exists() else ():
        step, call, times = line.split("\t")
        times_of[step, call] += int(times)
    return times_of


def run(folder, *words):
    """Its calls."""
    def work():
        done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"default_path.py: {words[0]}: {done.stderr.strip() or done.stdout[-500:]}")
    return counted(folder, work)


def path_of(calls, steps):
    """The calls, without those that only count steps, of these kinds of steps."""
    return {call for step, call in calls if step in steps and call != "step"}


def differences(name, wanted, got):
    return [f"{name}: voxrun does '{call}', the benchmark does not" for call in sorted(wanted - got)] + [
        f"{name}: the benchmark does '{call}', voxrun does not" for call in sorted(got - wanted)]


class Paths:
    def __init__(self, bin_folder, folder):
        self.bin, self.folder = bin_folder, folder
        for vox, options in (("bay.vox", ()), ("chebyshev.vox", ("--kind", "paper"))):
            run(folder, bin_folder / "voxelize", SAMPLES / "bay.json", "--voxel-size", "5mm", "-o", vox, "--quiet", *options)
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
        calls = run(folder, bin_folder / "voxrun_counted", "chebyshev.vox", "part.pshell", "--model", "paper", "--motion",
                    SAMPLES / "press.csv", "--json", "run.json", "--quiet")
        self.of_paper = path_of(calls, ("paper",))

    def judged(self, name, calls):
        """Every step of `default`, and nothing else in such a step; of the paper's model too, where there is one."""
        if calls["default", "step"] == 0:
            return [f"{name}: no step of default"]
        wrong = differences(name, self.wanted, path_of(calls, ("default",)))
        if calls["paper", "step"] > 0:
            wrong += differences(f"{name}, paper", self.of_paper, path_of(calls, ("paper",)))
        return wrong

    def commands(self):
        """A folder of the commands, with voxrun's calls counted."""
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        for name, program in (("voxelize", "voxelize"), ("pointshell", "pointshell"), ("voxrun", "voxrun_counted")):
            (folder / name).symlink_to(self.bin / program)
        return folder

    def bench(self, program, *words):
        return run(self.folder, self.bin / f"{program}_bench_counted", *words, "--json", "bench.json")

    def report(self):
        return json.loads((self.folder / "bench.json").read_text())["results"]

    def query(self):
        """The method whose percentiles are quoted: as many queries as it has frames, and no other does the same."""
        calls = self.bench("query", "--motion", "corner", "--from", 1000, "--largest", 1000, "--no-peers", "--seconds",
                           0.01, "--our-seconds", 0.02)
        (call,) = self.queries
        (wanted,) = (row["frames"] for row in self.report() if row["method"] == "all skipping")
        got = calls.get(("none", call), 0)
        return [] if got == wanted else [f"query: 'all skipping' has {wanted} frames, '{call}' was done {got} times"]

    def wrench(self):
        """The files and the field of the row that the README shows, and the step's own wrench beside that of the field."""
        calls = self.bench("wrench", "--contact", "sphere on plane", "--contact", "cone base on plane", "--s", 0.5, "--orientations", 1)
        report = self.report()
        (hand,) = report["wrench_hand_cases"]
        if hand["cases"] != 2 or hand["passed"] > 0 or hand["restless"] > 0 or hand["three_contacts"] == 0 or hand["off_max"] > 1e-3:
            return [f"wrench: the step's wrench at rest is not that of the field: {hand}"]
        timed = [row["n"] for row in report["wrench"] if row["contacts"] == "flush and smooth"
                 and row["method"] == "default, distances" and row["figure"] == "frame, us"]
        if not timed:
            return ["wrench: has no 'default, distances'"]
        return [f"wrench: voxrun does '{call}', no method of the benchmark does" for call in sorted(self.wanted)
                if calls.get(("none", call), 0) <= sum(timed)]

    def stability(self):
        wrong = []
        for words in (("rest", 2), ("table2", 3000), ("seats", 1), ("step", 500)):
            wrong += self.judged(f"stability {words[0]}", self.bench("stability", *words))
        return wrong

    def assembly(self):
        """The pegs; those of a map with a standoff differ by that alone."""
        calls = self.bench("assembly", "peg", 1, "--short")
        got = {call.replace("map of 0 layers", "map of 2 layers") for call in path_of(calls, ("default",))}
        return differences("assembly", self.wanted, got)

    def loop(self):
        out = self.folder / "loop"
        out.mkdir()
        return self.judged("loop", counted(self.folder, lambda: bench_loop.run(self.commands(), out, 0.02)))


BENCHES = ("query", "wrench", "stability", "assembly", "loop")


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
