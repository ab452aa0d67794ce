#!/usr/bin/env python3
"""Fuzzes the readers with libFuzzer (clang) and keeps account.

    scripts/fuzz.py                       every target for a minute
    scripts/fuzz.py --seconds 600 stl om  these for ten minutes each
    scripts/fuzz.py --differential 20000  two readers of baked files over so many mutated ones
    scripts/fuzz.py --frames 100000000    random faults in a device's readings, for so many frames
    scripts/fuzz.py --clock 1000000       faults of files, threads and plugin, for so many frames at 1 kHz
    scripts/fuzz.py --table               prints what all campaigns add up to

As many targets as there are cores run at once (--at-once). A target's seconds are of processor time, so
that a busy machine's ten minutes are ten minutes.
New inputs that reach new code stay in build/fuzz/corpus, so that campaigns add up; figures go to
tests/fuzz/campaigns.json. A crash, a hang (60 s for one input), work that is out of proportion to the
input (tests/fuzz/work.h) or more than 2 GiB of memory is left in build/fuzz/found, named on stderr, and
makes the status 1.
"""
import argparse
import concurrent.futures
import datetime
import json
import os
import math
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
FUZZ = ROOT / "tests" / "fuzz"
BUILD = ROOT / "build" / "fuzz"
CAMPAIGNS = FUZZ / "campaigns.json"
FRAMES = FUZZ / "fault_frames.json"
CLOCK = FUZZ / "fault_clock.json"
RELEASE = ROOT / "build" / "release"


def targets():
    return sorted(folder.name for folder in (FUZZ / "corpus").iterdir() if folder.is_dir())


def build(names):
    subprocess.run(["cmake", "--preset", "fuzz"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", BUILD, "--target", *(f"fuzz_{name}" for name in names)],
                   cwd=ROOT, check=True)


def fuzz(name, seconds):
    """One campaign of one target: its figures."""
    grown, found = BUILD / "corpus" / name, BUILD / "found" / name
    grown.mkdir(parents=True, exist_ok=True)
    found.mkdir(parents=True, exist_ok=True)
    before = set(found.iterdir())
    used_s, executions, edges, new = 0.0, 0, 0, []
    # libFuzzer counts by the clock; what other programs took of it is asked for again.
    while used_s < seconds and not new:
        said, run_s = run_counted(
            [BUILD / "bin" / f"fuzz_{name}", grown, FUZZ / "corpus" / name, f"-max_total_time={math.ceil(seconds - used_s)}",
             "-timeout=60", "-report_slow_units=60", "-rss_limit_mb=2048", "-malloc_limit_mb=1024", "-max_len=65536",
             "-print_final_stats=1", f"-artifact_prefix={found}/"])
        stats = dict(re.findall(r"stat::(\w+):\s+(\d+)", said))
        covered = re.findall(r"cov: (\d+) ", said)
        if "number_of_executed_units" not in stats:
            raise RuntimeError(f"fuzz_{name} ended without figures:\n{said[-2000:]}")
        used_s += run_s
        executions += int(stats["number_of_executed_units"])
        edges = max(edges, int(covered[-1]) if covered else 0)
        new = sorted(str(path) for path in set(found.iterdir()) - before)
    for path in new:
        print(f"{name}: found {path}\n{said[-3000:]}", file=sys.stderr)
    return {"date": datetime.date.today().isoformat(), "target": name, "seconds": seconds,
            "cpu_seconds": round(used_s, 1), "executions": executions, "edges": edges,
            "inputs": len(list(grown.iterdir())), "found": len(new)}


def run_counted(command):
    """A program's words on stderr, and the processor time that it took, whatever runs beside it."""
    with tempfile.TemporaryFile() as stderr:
        child = os.posix_spawn(command[0], [str(word) for word in command], os.environ,
                               file_actions=[(os.POSIX_SPAWN_DUP2, stderr.fileno(), 2)])
        used = os.wait4(child, 0)[2]
        stderr.seek(0)
        return stderr.read().decode(errors="replace"), used.ru_utime + used.ru_stime


def children_cpu_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def since_last_find(own):
    """The campaigns of one target after the last that found something."""
    finds = [i for i, campaign in enumerate(own) if campaign["found"]]
    return own[finds[-1] + 1:] if finds else own


def table(campaigns):
    lines = ["| target | campaigns | CPU seconds | without a find since | executions | edges reached | inputs kept |",
             "|---|---|---|---|---|---|---|"]
    for name in sorted({campaign["target"] for campaign in campaigns}):
        own = [campaign for campaign in campaigns if campaign["target"] == name]
        lines.append(f"| {name} | {len(own)} | {sum(c['cpu_seconds'] for c in own):.0f} "
                     f"| {sum(c['cpu_seconds'] for c in since_last_find(own)):.0f} "
                     f"| {sum(c['executions'] for c in own):,} | {max(c['edges'] for c in own):,} "
                     f"| {own[-1]['inputs']:,} |")
    return "\n".join(lines)


def committed(log):
    return json.loads(log.read_text()) if log.exists() else []


def build_release(names):
    subprocess.run(["cmake", "--preset", "release"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", RELEASE, "--target", *names], cwd=ROOT, check=True)


def add_campaign(campaign):
    CAMPAIGNS.write_text(json.dumps(committed(CAMPAIGNS) + [campaign], indent=1) + "\n")


def differential(files):
    """A campaign of the two readers, from a seed that no other had: whether they differed."""
    build_release(["baked_verdicts"])
    begin_s = children_cpu_s()
    run = subprocess.run([sys.executable, FUZZ / "differential.py", RELEASE / "bin" / "baked_verdicts", "--files",
                          str(files), "--seed", str(int(time.time()))], stdout=subprocess.PIPE, text=True, check=False)
    print(run.stdout, end="", flush=True)
    figures = re.search(r"(\d+) files, (\d+) accepted by both, (\d+) reasons to refuse, (\d+) differ", run.stdout)
    if not figures:
        return 1
    used_s = round(children_cpu_s() - begin_s, 1)
    add_campaign({"date": datetime.date.today().isoformat(), "target": "differential", "seconds": used_s,
                  "cpu_seconds": used_s, "executions": int(figures[1]), "edges": 0, "inputs": int(figures[2]),
                  "found": int(figures[4])})
    return run.returncode


def fault_frames(frames, program, log, piece, at_once):
    """Frames with faults, in pieces that add up; whether a promise was broken."""
    build_release([program])
    first, pieces = int(time.time()), math.ceil(frames / piece)

    def run(n):
        model = "paper" if n % 10 == 9 else "default"
        ran = subprocess.run([RELEASE / "bin" / program, "--frames", str(min(piece, frames - n * piece)), "--seed",
                              str(first + n), "--model", model], stdout=subprocess.PIPE, text=True, check=False)
        if not ran.stdout:
            sys.exit(f"{program} --seed {first + n} --model {model} ended with status {ran.returncode}")
        return ran.stdout

    broken = 0
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        for said in pool.map(run, range(pieces)):
            campaign = {"date": datetime.date.today().isoformat(), **json.loads(said)}
            broken += campaign["broken"]
            log.write_text(json.dumps(committed(log) + [campaign], indent=1) + "\n")
            print(said, end="", flush=True)
    return 1 if broken else 0


def sums(campaigns, keys):
    return " | ".join(f"{sum(c[key] for c in campaigns):,}" for key in keys)


def table_of_clock(campaigns):
    lines = ["| model | frames | seconds | with a force | faults of the plugin | processes stopped | cores busy | readers stalled "
             "| files moved | files changed | plugins ended | loop late | trips | promises broken |", "|" + "---|" * 14]
    for model in sorted({campaign["model"] for campaign in campaigns}):
        own = [campaign for campaign in campaigns if campaign["model"] == model]
        lines.append(f"| `{model}` | " + sums(own, (
            "frames", "seconds", "with_force", "plugin_faults", "stops", "busy", "stalls", "harmless", "files_changed",
            "plugins_ended", "late", "trips", "broken")) + " |")
    return "\n".join(lines)


def table_of_frames(campaigns):
    lines = ["| faults in | frames | of them faulty | with a force | trips | promises broken |", "|---|---|---|---|---|---|"]
    for model in sorted({campaign["model"] for campaign in campaigns}):
        own = [campaign for campaign in campaigns if campaign["model"] == model]
        lines.append(f"| readings, `--model {model}` | " + sums(own, ("frames", "faulty", "with_force", "trips", "broken"))
                     + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", help="of tests/fuzz/corpus; all if none is named")
    parser.add_argument("--seconds", type=int, default=60, help="of processor time, for each target")
    parser.add_argument("--at-once", type=int, default=os.cpu_count(), help="targets (default: one for each core)")
    parser.add_argument("--differential", type=int, default=0, metavar="FILES", help="this alone")
    parser.add_argument("--frames", type=int, default=0, help="this alone")
    parser.add_argument("--clock", type=int, default=0, metavar="FRAMES", help="this alone")
    parser.add_argument("--table", action="store_true", help="only print what all campaigns add up to")
    arguments = parser.parse_args()
    names = arguments.targets or targets()
    unknown = sorted(set(names) - set(targets()))
    if unknown:
        parser.error(f"no such target: {', '.join(unknown)}; there are {', '.join(targets())}")

    found = 0
    if arguments.differential:
        found = differential(arguments.differential)
    elif arguments.frames:
        found = fault_frames(arguments.frames, "fault_frames", FRAMES, 5_000_000, arguments.at_once)
    elif arguments.clock:  # each waits for its clock most of the time
        found = fault_frames(arguments.clock, "fault_clock", CLOCK, 40_000, 2 * os.cpu_count())
    elif not arguments.table:
        build(names)
        with concurrent.futures.ThreadPoolExecutor(arguments.at_once) as pool:
            for running in concurrent.futures.as_completed([pool.submit(fuzz, name, arguments.seconds) for name in names]):
                campaign = running.result()
                found += campaign["found"]
                add_campaign(campaign)
                print(f"{campaign['target']}: {campaign['executions']:,} executions, {campaign['edges']:,} edges, "
                      f"{campaign['found']} found", flush=True)
    print("\n\n".join((table(committed(CAMPAIGNS)), table_of_frames(committed(FRAMES)), table_of_clock(committed(CLOCK)))))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
