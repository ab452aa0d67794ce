#!/usr/bin/python3
"""How near the time left that a progress line tells comes to the truth.

Usage: progress.py [--short] [--json FILE] [--bin FOLDER] [CASE...]

Each command runs on a terminal with one thread. Time is the processor's, so that other work on the machine counts for
nothing: at each line from a tenth on, the time left at the pace so far, as the line tells it, over what it then took.
"""

import os
import pathlib
import pty
import re
import subprocess
import sys
import tempfile

import bench_scenes

TICKS_S = os.sysconf("SC_CLK_TCK")
SHOWN = re.compile(r"\x1b\[K[a-z ]+? +(\d+)%")
LEAST_SHARE = 0.03  # of the whole, that is still to come: less is told in whole seconds, as none
BEGUN = {"pointshell": 0.0, "voxelize": 0.09}  # what was done until then counts for no pace: reading


def used_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_S


def lines_of(command):
    """[(processor seconds, share)] of a command's progress line, and its seconds in all."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=theirs)
    os.close(theirs)
    lines, words = [], ""
    while True:
        try:
            words = os.read(ours, 65536).decode(errors="replace")
        except OSError:  # its end
            break
        try:
            at_s = used_s(process.pid)
        except (OSError, IndexError):
            continue
        lines += [(at_s, int(share) / 100) for share in SHOWN.findall(words)]
    os.close(ours)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{command}: {words}")
    return lines, usage.ru_utime + usage.ru_stime


def told_over_true(lines, all_s, begun):
    """At each line that tells a time."""
    begun_s = max((at_s for at_s, share in lines if share <= begun), default=0)
    ratios, rest = [], 1 - begun
    for at_s, share in lines:
        done = share - begun
        if done < 0.1 * rest + 0.005 or all_s - at_s < LEAST_SHARE * all_s:
            continue
        ratios.append((at_s - begun_s) * (1 - share) / done / (all_s - at_s))
    return ratios


def cases(folder):
    data, models = bench_scenes.ROOT / "sample_data", bench_scenes.MODELS
    shells = [("bunny", models / "scan/stanford-bunny.obj", "m", "0.5mm"),
              ("dragon", models / "scan/dragon-100k.obj", "m", "7mm"),
              ("teapot", models / "scan/teapot.obj", "m", "15mm"),
              ("counter", models / "cad/counter.unitsmm.stl", "mm", "1.2mm"),
              ("plate", models / "cad/plate_holes.stl", "mm", "0.8mm"),
              ("block", models / "cad/large_block.stl", "mm", "12mm"),
              ("as1", models / "cad/as1-oc-214.stp", None, "1.5mm"),
              ("engine", models / "cad/2CylinderEngine.glb", None, "8m"),
              ("gearbox", data / "gearbox.glb", None, "1mm"),
              ("pin", f"{data / 'gearbox.glb'}#Pin", None, "0.2mm"),
              ("part", data / "part.obj", "mm", "0.5mm")]
    for kind, options in (("", ()), (" --effort fast", ("--effort", "fast")),
                          (" --method voxel-centers", ("--method", "voxel-centers"))):
        for name, path, units, size in shells:
            yield "pointshell", name + kind, [path, "--voxel-size", size, "-o", folder / "o.pshell", *options,
                                              *(("--units", units) if units else ())]
    scenes = [("bay", data / "bay.json", None, "0.5mm"), ("gearbox", data / "gearbox.glb", None, "0.06mm"),
              ("bunny", models / "scan/stanford-bunny.obj", "m", "0.08mm"),
              ("counter", models / "cad/counter.unitsmm.stl", "mm", "0.15mm"),
              ("engine", models / "cad/2CylinderEngine.glb", None, "0.5m")]
    for kind, options in (("", ()), (" --lean", ("--lean",)), (" --metric chebyshev", ("--metric", "chebyshev"))):
        for name, path, units, size in scenes:
            yield "voxelize", name + kind, [path, "--voxel-size", size, "-o", folder / "o.vox", *options,
                                            *(("--units", units) if units else ())]


def main():
    arguments = bench_scenes.arguments(sys.modules[__name__], "progress", bench_scenes.SHORT,
                                       ("case", {"nargs": "*", "help": "names, all by default"}))
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for program, case, words in cases(pathlib.Path(name)):
            if not pathlib.Path(str(words[0]).partition("#")[0]).exists():
                continue
            if arguments.case and case.split()[0] not in arguments.case or arguments.short and " " in case:
                continue
            lines, all_s = lines_of([str(w) for w in (arguments.bin / program, *words, "--threads", 1)])
            ratios = told_over_true(lines, all_s, BEGUN[program])
            if not ratios:
                continue
            within = sum(0.5 <= ratio <= 2 for ratio in ratios) / len(ratios)
            rows.append({"program": program, "case": case, "cpu_s": all_s, "lines": len(ratios), "least": min(ratios),
                         "greatest": max(ratios), "within_two": within})
            print(f"{program} {case}: {all_s:.1f} s, {len(ratios)} lines, told over true {min(ratios):.2f} to "
                  f"{max(ratios):.2f}, {100 * within:.0f}% within a factor of two", flush=True)
    bench_scenes.write_report("progress", rows, arguments.json)


if __name__ == "__main__":
    main()
