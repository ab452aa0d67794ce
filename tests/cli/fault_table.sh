#!/usr/bin/env bash
# Every test that the tables of faults and of CAD traps name exists, and every fault of the scripts is in the table.
set -euo pipefail
exec python3 - "$FORCELAYER_SOURCE_DIR/tests" <<'PYTHON'
import pathlib, re, sys

tests = pathlib.Path(sys.argv[1])
def rows_of(text):
    return [line for line in text.splitlines() if line.startswith("| ") and not line.startswith(("| fault |", "| defect |"))]

rows = rows_of((tests / "README.md").read_text())
sources = "".join(path.read_text() for path in tests.glob("*/*.cpp"))
declared = {f"{suite}.{name}" for suite, name in re.findall(r"TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", sources)}
wrong, named = [], set()

def faults_of(script):
    text = (tests / "cli" / f"{script}.sh").read_text()
    listed = re.search(r"^run_faults ((?:\\\n|.)*)", text, re.MULTILINE)
    faults = set(listed[1].replace("\\\n", " ").split()) if listed else set()
    return {fault for fault in faults if re.search(rf"^{fault}\(\)", text, re.MULTILINE)}

for row in rows:
    cells = row.strip("| ").split(" | ")
    if len(cells) != 3:
        wrong.append(f"not three cells: {row}")
        continue
    entries = re.findall(r"`([\w.]+)`(?: \(([^)]*)\))?", cells[2])
    if not entries:
        wrong.append(f"no test: {row}")
    for name, faults in entries:
        group, _, rest = name.partition(".")
        if group == "cli":
            if not (tests / "cli" / f"{rest}.sh").exists():
                wrong.append(f"no such test: {name}")
                continue
            for fault in re.findall(r"`(\w+)`", faults):
                named.add((rest, fault))
                if fault not in faults_of(rest):
                    wrong.append(f"{name} has no fault {fault}")
        elif group == "fuzz":
            if not (tests / "fuzz" / "corpus" / rest).is_dir() and not list((tests / "fuzz").rglob(f"{rest}.cpp")):
                wrong.append(f"no such test: {name}")
        elif name not in declared:
            wrong.append(f"no such test: {name}")
for script in ("voxelize_faults", "voxrun_faults"):
    for fault in sorted(faults_of(script)):
        if (script, fault) not in named:
            wrong.append(f"the table lacks {script} ({fault})")
if len(rows) < 30:
    wrong.append(f"only {len(rows)} rows")
traps = rows_of((tests.parent / "formats/mesh/traps.md").read_text().split("\n## Nothing is lost")[0])
for row in traps:
    entries = re.findall(r"`(\w+)\.(\w+)`", row.strip("| ").split(" | ")[-1])
    if not entries:
        wrong.append(f"no test: {row}")
    for group, rest in entries:
        there = (tests / "cli" / f"{rest}.sh").exists() if group == "cli" else f"{group}.{rest}" in declared
        if not there:
            wrong.append(f"no such test: {group}.{rest}")
if len(traps) < 10:
    wrong.append(f"only {len(traps)} traps")
print("\n".join(wrong) or f"{len(rows)} faults, every test there")
sys.exit(bool(wrong))
PYTHON
