#!/usr/bin/env python3
"""The figures of the project's README, of results/summary.md and of the page of limits: where each comes from, its stated interval, and whether a new run lies in it.

Usage: readme_figures.py FOLDER    says of each whether the CSV files of FOLDER lie inside (scripts/bench.sh ends with it)
       readme_figures.py --check   whether every figure of the README has an entry, and every entry a committed value

FIGURES is the list. A time of one machine says little of another's, so times are compared as ratios to another program or
another kind of file in the same run, and the times themselves are shown beside. Exit status: 0 done or all there, 1 an
entry is missing (a line says which), 2 wrong usage.
"""

import dataclasses
import math
import pathlib
import re
import sys

import bench_csv

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
README, LIMITS, SUMMARY = ROOT / "README.md", ROOT / "docs/limits.md", ROOT / "tests/bench/results/summary.md"
BENCHMARKS = ROOT / "docs/benchmarks.md"


# Intervals. Each is a function of a figure and of its committed row: the lowest and the highest value, and what to call it.

def factor(most):
    """For a ratio of times."""
    def interval(figure, row):
        value = figure.value(row)
        return value / most, value * most, f"a factor of {most:g}"
    return interval


def median(figure, row):
    """For the median over cases: the order-statistic interval that wrench_bench gives; a new run's own must meet it. Of fewer
    than six cases there is none, and a factor of 2 stands for it."""
    if row["median_low"] is None:
        return factor(2)(figure, row)
    return row["median_low"], row["median_high"], f"95% of the median, {row['n']} cases"


def of_new_median(row):
    return (row["p50"],) * 2 if row["median_low"] is None else (row["median_low"], row["median_high"])


median.of_new = of_new_median


def exact(_figure, row, value=None):
    """For bytes and seeded counts: bake, seed and rounding leave a thousandth."""
    return value / 1.001, value * 1.001, "the same"


def same(figure, row):
    return exact(figure, row, figure.value(row))


def between(low, high, words):
    return lambda _figure, _row: (low, high, words)


def tail(k, n, p):
    """The probability of at most k events in n."""
    if p <= 0 or p >= 1:
        return 1.0 if p <= 0 or k >= n else 0.0
    logs = (math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1) + i * math.log(p) + (n - i) * math.log1p(-p)
            for i in range(k + 1))
    return math.fsum(math.exp(value) for value in logs)


def fraction_95(k, n):
    """Clopper and Pearson's interval of a fraction."""
    def where(count, wanted):
        low, high = 0.0, 1.0
        for _ in range(50):
            middle = (low + high) / 2
            low, high = (middle, high) if tail(count, n, middle) > wanted else (low, middle)
        return low
    return 0.0 if k == 0 else where(k - 1, 0.975), 1.0 if k == n else where(k, 0.025)


def binomial(events, of):
    """For a fraction of independent trials; a new run's own interval must meet it."""
    def interval(_figure, row):
        low, high = fraction_95(row[events], row[of])
        return low, high, f"95%, {row[of]} trials"
    interval.of_new = lambda row: fraction_95(row[events], row[of])
    return interval


@dataclasses.dataclass
class Figure:
    readme: str             # words beside it: a row of the summary, or words of the README's or the limits' text
    name: str               # which of the row's figures
    part: str               # of bench.sh
    file: str
    where: dict             # keys of its row
    column: str
    interval: object
    over: dict = None       # the row that it is divided by: `where` with these keys changed
    over_column: str = None
    greatest: bool = False  # of all rows that `where` finds
    mean: bool = False      # of them
    of_machine: bool = False  # a time or a count that says nothing of another machine

    def rows(self, folder):
        path = folder / f"{self.file}.csv"
        return bench_csv.Table(path).rows if path.exists() else []

    def row(self, folder, changed=None):
        wanted = {**self.where, **(changed or {})}
        found = [r for r in self.rows(folder) if all(r.get(key) == value for key, value in wanted.items())
                 and r.get(self.column) is not None]
        if found and (self.greatest or self.mean):
            values = [r[self.column] for r in found]
            return {**found[0], self.column: max(values) if self.greatest else sum(values) / len(values)}
        return found[-1] if found else None

    def of(self, folder):
        """Its row, with what it is divided by under "base"; None where the run did not measure it."""
        row = self.row(folder)
        if row is None:
            return None
        base = self.row(folder, self.over) if self.over else row if self.over_column else None
        if (self.over or self.over_column) and base is None:
            return None
        return {**row, "base": base[self.over_column or self.column] if base else 1}

    def value(self, row):
        return row[self.column] / row["base"]


def query(readme, motion, method, name):
    return Figure(readme, name, "query", "query", {"motion": motion, "points": 10 ** 6, "method": "all skipping"}, "p50_us",
                  factor(1.6), over={"method": method})


def bake_of(readme, triangles):
    where = {"scene": "aircraft", "triangles": triangles}
    full, lean = {**where, "kind": "full"}, {**where, "kind": "lean, chebyshev"}
    return [Figure(readme, "processor time over that of `--kind paper`", "bake", "bake_full", full, "cpu_s", factor(1.6),
                   over={"kind": "lean, chebyshev"}),
            Figure(readme, "bytes", "bake", "bake_full", full, "file_bytes", same),
            Figure(readme, "bytes, `--kind paper`", "bake", "bake_full", lean, "file_bytes", same)]


def force(readme, contacts):
    def of(method, name, figure, interval, **more):
        return Figure(readme, name, "wrench", "wrench", {"voxel_m": 0.005, "contacts": contacts, "method": method, "figure": figure},
                      "p50", interval, **more)
    ours, peers = "default, distances", (("default, Chebyshev layers", "`--kind paper`"),
                                         ("dense float distances, our query", "dense floats"), ("FCL distance", "FCL distance"))
    return [of(ours, "error", "force", median), of(ours, "error, raw", "raw force", median),
            *(of(method, f"error, {name}", "force", median) for method, name in peers),
            *(of(ours, f"time over that of {name}", "frame, us", factor(1.6), over={"method": method}) for method, name in peers)]


def gap(readme, kind, case, low, high):
    return Figure(readme, "room that every part passed, voxels", "gaps", "narrow_gaps",
                  {"map": kind, "case": case, "covering_voxels": 0.866}, "all_pass_voxels", between(low, high, SHORT_GAPS))


WALL, ALL = "contact query, 10^6 points against a wall", "contact query, 10^6 points all in contact"
ENGINE = "bake of the engine, 1024 voxels across, whole command"
LARGE, PAPER = "bake of 10.5 million triangles, 4,000 voxels across", "bake of the paper's 593,409 polygons at 5 mm"
FRAMES, REST = "frames with a point behind the force layer, of a million in contact", "presses that come to rest"
HAND = "force error on a hand, 5 mm voxels"
LOOP = "30 minutes at 1 kHz, all cores busy: late frames"
CORES = "8 threads instead of 1: times as fast"
ENGINE_ROW = {"model": "engine", "voxels": 1024, "kind": "full"}
SHORT_GAPS = "by half a voxel in the short form"

FIGURES = [
    query(WALL, "wall", "OpenVDB ValueAccessor", "time over that of `ValueAccessor`"),
    query(WALL, "wall", "FCL meshes, contacts", "time over that of FCL"),
    query(ALL, "everything", "OpenVDB ValueAccessor", "time over that of `ValueAccessor`"),
    Figure(ENGINE, "time over that of `vdb_tool`", "bake", "bake_kinds", ENGINE_ROW, "command_s", factor(1.6),
           over_column="vdb_tool_s"),
    Figure(ENGINE, "time over that of `--kind paper`", "bake", "bake_kinds", ENGINE_ROW, "command_s", factor(1.6),
           over={"kind": "lean, chebyshev"}),
    *bake_of(LARGE, 10500000), *bake_of(PAPER, 593409),
    *force("force error, smooth contacts, 5 mm voxels", "flush and smooth"), *force("force error, mesh pairs, 5 mm voxels", "mesh pairs"),
    *(Figure(HAND, f"median at rest, {contacts}", "wrench", "wrench_hand",
             {"voxel_m": 0.005, "covering_voxels": 0.8661, "contacts": contacts, "motion": "at rest"}, "p50", factor(1.6))
      for contacts in ("flush and smooth", "corners and wedges", "mesh pairs")),
    Figure(FRAMES, "trials of `default` with one", "stability", "stability", {"campaign": "table2", "model": "default"},
           "penetrating_trials", binomial("penetrating_trials", "trials"), over_column="trials"),
    Figure(FRAMES, "trials of the paper's model with one", "stability", "stability",
           {"campaign": "table2", "model": "paper, braking"}, "penetrating_trials", binomial("penetrating_trials", "trials"),
           over_column="trials"),
    Figure(REST, "fraction of `default`", "stability", "stability", {"campaign": "rest", "model": "default"}, "quiet",
           binomial("quiet", "trials"), over_column="trials"),
    Figure(REST, "fraction of the paper's model", "stability", "stability", {"campaign": "rest", "model": "paper"}, "quiet",
           binomial("quiet", "trials"), over_column="trials"),
    *(Figure(CORES, task, "cores", "cores", {"task": task, "stage": "whole", "threads": 1}, "wall_s", same, over={"threads": 8},
             of_machine=True)
      for task in ("voxelize: aircraft", "pointshell: dragon", "pointshell: counter", "query: everything")),
    Figure(LOOP, "late frames", "loop", "loop", {"figure": "deadline_misses"}, "value", same, of_machine=True),
    Figure(LOOP, "wake-up p99", "loop", "loop", {"figure": "wakeup_p99_us"}, "value", same, of_machine=True),
    Figure("0.133 voxel in narrow gaps", "least guarantee, voxels", "gaps", "narrow_gaps", {"map": "lean", "case": "block in slot"},
           "guaranteed_voxels", between(0.132, 0.134, "to the rounding of poses")),
    Figure("0.4677 mm (0.0935 voxel)", "least guarantee, m", "stability", "stability",
           {"campaign": "cases", "case": "slide-stairs", "model": "paper"}, "guaranteed_m", between(0.0004677, 0.0004678, "to the rounding of poses")),
    gap("5.7 voxels for a block in a slot", "full", "block in slot", 5.6, 6.0), gap("5.8 voxels for a peg in a hole", "full", "peg in hole", 5.7, 6.0),
    gap("5.6 voxels in a slot", "lean", "block in slot", 5.5, 6.0), gap("6.0 voxels in a hole", "lean", "peg in hole", 5.9, 6.1),
    gap("2.6 voxels in a slot", "standoff 1.3", "block in slot", 2.5, 3.0), gap("2.8 voxels in a hole", "standoff 1.3", "peg in hole", 2.7, 3.0),
    Figure("goes at most 0.8 voxel into an object. In 203 pairs of installed part and scene, edges were at most 0.5 voxel deep", "deepest edge, voxels", "stability",
           "stability_seats", {"covering_voxels": 0.86603}, "edge_depth_voxels", between(0, 0.8, "at most that"), greatest=True),
    Figure("the exact meshes overlapped in 25% of the poses", "mean of the pairs", "stability", "stability_seats",
           {"covering_voxels": 0.86603}, "touching", between(0.05, 0.45, "a fifth; a pair is from 0% to 95%"), mean=True),
    Figure("1.3% at corners and wedges", "force error", "wrench", "wrench",
           {"voxel_m": 0.005, "contacts": "corners and wedges", "method": "default, distances", "figure": "force"}, "p50", median),
    Figure("0.60% at smooth contacts", "force error", "wrench", "wrench",
           {"voxel_m": 0.005, "contacts": "flush and smooth", "method": "default, distances", "figure": "force"}, "p50", median),
    Figure("more than 99% of the hand's motion", "fraction of the motion (10th percentile)", "stability", "stability",
           {"campaign": "cases", "case": "slide-plane", "model": "default"}, "progress_p10", between(0.98, 1.02, "two hundredths")),
]


def number(value):
    return f"{value:.4g}"


def compare(folder):
    """Says of each figure whether a run's is in its interval; how many are outside."""
    outside = missing = 0
    said = None
    for figure in FIGURES:
        if figure.readme != said:
            said = figure.readme
            print(f"  {said}")
        committed, new = figure.of(bench_csv.newest(figure.file)), figure.of(folder)
        label = f"    {figure.name}: "
        if new is None:
            missing += 1
            print(f"{label}not measured here ({'the' if figure.part != 'loop' else 'by name only: the'} part is `{figure.part}`)")
            continue
        value = figure.value(new)
        if figure.of_machine:
            missing += 1
            print(f"{label}{number(value)}, committed {number(figure.value(committed))}: not comparable between machines")
            continue
        low, high, words = figure.interval(figure, committed)
        least, most = figure.interval.of_new(new) if hasattr(figure.interval, "of_new") else (value, value)
        inside = least <= high and most >= low
        outside += not inside
        times = ""
        if figure.column.endswith(("_us", "_s")):
            times = f"; {number(new[figure.column])} {figure.column.rsplit('_', 1)[1]} here, {number(committed[figure.column])} committed"
        print(f"{label}{'inside' if inside else 'OUTSIDE'}: {number(value)}, stated {number(figure.value(committed))}, "
              f"{number(low)} to {number(high)} ({words}){times}")
    print(f"{outside} of {len(FIGURES)} figures outside of their intervals, {missing} not measurable here")
    return outside


def table_rows(text):
    """The cells of each row of the tables with a number in them: of the README, those of its results."""
    lines = (line for line in text.splitlines() if line.startswith("| "))
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if re.search(r"\d", line)]


def results_of(readme):
    return readme[readme.index("## Results"):].split("\n## ")[0]


PROSE = re.compile(r"\b\d+(?:\.\d+)?%?(?= voxels?\b| us\b| MB\b| percent\b)|\b\d+(?:\.\d+)?%")


def uncovered_rows(text):
    for row, *_ in table_rows(text):
        if not any(row.startswith(figure.readme) for figure in FIGURES):
            yield f"the summary's row '{row}'"


def differing_results(rows_of_page, summary):
    """Rows of a page that are not parts of a row of the summary: all of the README's results, and of the page of benchmarks those
    that name a row of the summary."""
    rows = {row: " | ".join(cells) for row, *cells in table_rows(summary)}
    for row, *cells in rows_of_page:
        said = next((text for name, text in rows.items() if name == row or name.startswith(f"{row}, ")), "")
        for cell in cells:
            if cell not in said:
                yield f"'{row}': the summary does not say '{cell}'"


def rows_by_figure(text):
    """The rows of the tables of the page of benchmarks whose first column is a figure of the summary."""
    return [row for table in re.split(r"\n\n", text) if table.startswith("| figure |") for row in table_rows(table)]


def uncovered_prose(text):
    """Figures of a page's text without an entry."""
    entries = {figure.readme for figure in FIGURES}
    prose = text.replace(results_of(text), "") if text.startswith("# Forcelayer") else text
    prose = " ".join(re.sub(r"^    .*$", "", prose, flags=re.MULTILINE).split())
    covered = [(found.start(), found.end()) for entry in entries for found in re.finditer(re.escape(entry), prose)]
    for found in PROSE.finditer(prose):
        if not any(begin <= found.start() < end for begin, end in covered):
            yield f"'{prose[max(0, found.start() - 30):found.end() + 20]}'"


def check():
    readme, limits, summary = README.read_text(), LIMITS.read_text(), SUMMARY.read_text()
    wrong = [f"no entry for {what}" for what in (*uncovered_rows(summary), *uncovered_prose(readme), *uncovered_prose(limits))]
    wrong += differing_results(table_rows(results_of(readme)), summary)
    rows = rows_by_figure(BENCHMARKS.read_text())
    wrong += differing_results(rows, summary) if rows else ["no figure on the page of benchmarks"]
    flat = " ".join((readme + limits + summary).split())
    for figure in FIGURES:
        if figure.readme not in flat:
            wrong.append(f"no page says '{figure.readme}'")
        committed = figure.of(bench_csv.newest(figure.file))
        if committed is None:
            wrong.append(f"no committed value of '{figure.readme}', {figure.name}")
        elif not figure.of_machine:
            low, high, _ = figure.interval(figure, committed)
            if not low <= figure.value(committed) <= high:
                wrong.append(f"the committed value of '{figure.readme}', {figure.name}, is outside of its interval")
    for line in wrong:
        print(f"readme_figures.py: {line}", file=sys.stderr)
    return 1 if wrong else 0


def main():
    if sys.argv[1:] == ["--check"]:
        return check()
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    compare(pathlib.Path(sys.argv[1]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
