#!/usr/bin/env bash
# Every test that the table of faults names exists, and every fault of the scripts is in the table.
set -euo pipefail
exec python3 - "$FORCELAYER_SOURCE_DIR/tests" <<'PYTHON'
import pathlib, re, sys

tests = pathlib.Path(sys.argv[1])
rows = (tests / "faults.tsv").read_text().splitlines()[1:]
sources = "".join(path.read_text() for path in tests.glob("*/*.cpp"))
declared = {f"{suite}.{name}" for suite, name in re.findall(r"TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", sources)}
wrong, named = [], set()

def faults_of(script):
    text = (tests / "cli" / f"{script}.sh").read_text()
    listed = re.search(r"^run_faults ((?:\\\n|.)*)", text, re.MULTILINE)
    faults = set(listed[1].replace("\\\n", " ").split()) if listed else set()
    return {fault for fault in faults if re.search(rf"^{fault}\(\)", text, re.MULTILINE)}

for row in rows:
    cells = row.split("\t")
    if len(cells) != 3:
        wrong.append(f"not three cells: {row}")
        continue
    entry = r"(\w+\.\w+)(?: \(([^)]*)\))?"
    if not re.fullmatch(rf"{entry}(?:, {entry})*", cells[2]):
        wrong.append(f"not a list of tests: {row}")
    for name, faults in re.findall(entry, cells[2]):
        group, _, rest = name.partition(".")
        if group == "cli":
            if not (tests / "cli" / f"{rest}.sh").exists():
                wrong.append(f"no such test: {name}")
                continue
            for fault in re.findall(r"\w+", faults):
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
print("\n".join(wrong) or f"{len(rows)} faults, every test there")
sys.exit(bool(wrong))
PYTHON
