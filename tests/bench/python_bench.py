#!/usr/bin/python3
"""Speed of `import forcelayer` beside plain loops in C++ (python_bench.cpp), in one run.

Usage: python_bench.py [--short] [--json FILE] [--bin FOLDER]

The sample scene at 5 mm; the sample part's shell, and one of a hundred times as many points; random poses along the
way of a pressing hand. Both sides take turns and answer the same poses; each figure is the least of the repetitions.
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy

import bench_scenes
from skipped import shell

DATA = bench_scenes.ROOT / "sample_data"
SHELLS = {1: 40000, 100: 2000}  # times as many points: poses
REPETITIONS = 9


def times_of_cpp(bin_folder, arguments):
    wall_s, cpu_s, _ = subprocess.run([bin_folder / "python_bench", *map(str, arguments)], check=True,
                                      capture_output=True, text=True).stdout.split()
    return float(wall_s), float(cpu_s)


def times_of_python(ask):
    wall_s, cpu_s = time.monotonic(), time.process_time()
    ask()
    return time.monotonic() - wall_s, time.process_time() - cpu_s


def least(*runs):
    return [min(values) for values in zip(*runs)]


def compare(name, threads, count, python, cpp, repetitions):
    python()
    ours, theirs = [float("inf")] * 2, [float("inf")] * 2
    for _ in range(repetitions):
        theirs = least(theirs, cpp())
        ours = least(ours, times_of_python(python))
    row = {"question": name, "threads": threads, "poses": count, "python_wall_s": ours[0], "python_cpu_s": ours[1],
           "cpp_wall_s": theirs[0], "cpp_cpu_s": theirs[1]}
    print(f"{name}, {threads} thread(s): Python {1e6 * ours[1] / count:.3f} us a pose, C++ "
          f"{1e6 * theirs[1] / count:.3f} us, speed {theirs[1] / ours[1]:.3f} of C++ by processor time, "
          f"{theirs[0] / ours[0]:.3f} by the clock", flush=True)
    return row


def path_of_hand(folder, bin_folder, scene, part):
    import forcelayer
    subprocess.run([bin_folder / "voxrun", scene, part, "--motion", DATA / "press.csv", "--as-fast-as-possible",
                    "--quiet", "--record", folder / "run.flr"], check=True)
    return forcelayer.replay(forcelayer.Scene(scene), forcelayer.Part(part), folder / "run.flr").frames


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "python_bench", bench_scenes.SHORT)
    sys.path.insert(0, str(arguments.bin.parent / "python"))
    import forcelayer

    repetitions, rows = 2 if arguments.short else REPETITIONS, []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        baked = folder / "scene.vox"
        bench_scenes.bake(arguments.bin, bench_scenes.sample_scene(), 0.005, baked)
        scene, frames = forcelayer.Scene(baked), None
        for denser, count in SHELLS.items():
            shell_file = shell(arguments.bin, folder, denser)
            part = forcelayer.Part(shell_file)
            if frames is None:
                frames = path_of_hand(folder, arguments.bin, baked, shell_file)
            at = numpy.linspace(0, len(frames) - 1, count).astype(int)
            poses = numpy.ascontiguousarray(frames["world_from_part"][at])
            poses.tofile(folder / "poses")
            for threads in sorted({1, os.cpu_count()}):
                for question, ask in (("query", scene.query), ("clearance", scene.clearance)):
                    row = compare(question, threads, count, lambda: ask(part, poses, threads=threads),
                                  lambda: times_of_cpp(arguments.bin, (baked, shell_file, folder / "poses", question,
                                                                       threads)), repetitions)
                    rows.append({"points": part.point_count, **row})
            hands = numpy.ascontiguousarray(frames["world_from_handle"][:4000])
            hands.tofile(folder / "hands")
            simulation = forcelayer.Simulation(scene, part)

            def run():
                simulation.start(hands[0])
                simulation.run(hands)

            def steps():
                simulation.start(hands[0])
                for hand in hands:
                    simulation.step(hand)

            for question, ask in (("run", run), ("step", steps)):
                row = compare(question, 1, len(hands), ask,
                              lambda: times_of_cpp(arguments.bin, (baked, shell_file, folder / "hands", "steps", 1)),
                              repetitions)
                rows.append({"points": part.point_count, **row})
    bench_scenes.write_report("python_bench", rows, arguments.json)


if __name__ == "__main__":
    main()
