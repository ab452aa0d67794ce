#!/usr/bin/env bash
# forcelayer disassemble, as a user meets it: order, paths, a target, a second run, and wrong input.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
cp "$data/gearbox.glb" .

disassemble() {  # STATUS ARGUMENTS...: output in out.txt and err.txt
  local wanted=$1 status=0
  shift
  "$bin/forcelayer" disassemble "$@" >out.txt 2>err.txt || status=$?
  [ "$status" = "$wanted" ] || fail "status $status, not $wanted: disassemble $*: $(cat out.txt err.txt)"
}
line() { sed -n "$1p" out.txt | grep -qxF "$2" || fail "line $1 is not '$2': $(sed -n "$1p" out.txt)"; }
refuses() {  # STATUS LINE ARGUMENTS...
  local status=$1 line=$2
  shift 2
  disassemble "$status" "$@"
  grep -qxF "forcelayer: $line" err.txt || fail "no error '$line': $(cat err.txt)"
}
report() { python3 -c "import json; report = json.load(open('$1')); assert ($2), report" || fail "$1: $2"; }

# The gearbox comes apart, and voxcheck confirms a path.
disassemble 0 gearbox.glb -o apart --json apart.json
line 1 '1. Bolt[1]: 34 mm or more along +z (touches Cover; nearest: Housing, 0.0997 mm)'
line 9 'All 9 parts come apart.'
report apart.json 'report["tool"] == "forcelayer" and report["exit_status"] == 0'
report apart/sequence.json 'len(report["steps"]) == 8 and report["left"] == [] and report["finished"]'
report apart/sequence.json 'report["base"] == "Gearbox/Housing" and report["target"] is None and report["seconds"] > 0'
report apart/sequence.json 'report["steps"][4]["parts"] == ["Gearbox/Pin"] and report["steps"][4]["path"] == "paths/005_Pin.csv"'
report apart/sequence.json 'all(step["settled_by"].startswith("meshes") for step in report["steps"])'
report apart/sequence.json 'all(0 <= step["clearance_m"] <= step["distance_m"] for step in report["steps"] if step["nearest"])'
[ "$(ls apart/paths | wc -l)" = 8 ] || fail "the paths: $(ls apart/paths)"
"$bin/voxelize" gearbox.glb --without Pin --voxel-size 1mm -o rest.vox --quiet
"$bin/pointshell" gearbox.glb#Pin --voxel-size 1mm -o pin.pshell --quiet
"$bin/voxcheck" rest.vox pin.pshell apart/paths/005_Pin.csv --seat 0,0,0m --clearance 1mm --exact gearbox.glb --without Pin \
  --part gearbox.glb#Pin --quiet || fail "voxcheck says no to a path"

# Only what must leave for a target: the bolts for the cover, nothing for a bolt.
disassemble 0 gearbox.glb --target Cover -o cover
tail -1 out.txt | grep -qx 'Cover comes out after 4 other parts.' || fail "the last line: $(tail -1 out.txt)"
report cover/sequence.json '[s["parts"][0].split("/")[-1][:4] for s in report["steps"]] == ["Bolt"] * 4 + ["Cove"]'
disassemble 0 gearbox.glb --target 'Bolt[2]' -o bolt
line 2 'Bolt[2] comes out, and nothing needs to leave first.'
# A node with several parts comes out as one.
disassemble 0 gearbox.glb --target Lid -o lid
report lid/sequence.json 'len(report["steps"]) == 1 and len(report["steps"][0]["parts"]) == 5'

# A second run keeps what it knows, another clearance or a changed file does not.
cp apart/sequence.json before.json
disassemble 0 gearbox.glb -o apart
python3 - <<'PYTHON' || fail "a second run has other steps"
import json
before, after = (json.load(open(name))["steps"] for name in ("before.json", "apart/sequence.json"))
assert before == after
PYTHON
disassemble 0 gearbox.glb -o apart --time 0s  # nothing is left to be searched
disassemble 0 gearbox.glb -o apart --clearance 0.5mm
report apart/sequence.json 'report["required_clearance_m"] == 0.0005 and len(report["steps"]) == 8'
python3 - <<'PYTHON' || fail "a path that was changed is taken"
import json, pathlib
path = pathlib.Path("apart/paths/001_Bolt_1_.csv")
path.write_text(path.read_text().replace("0.03", "0.01"))
PYTHON
disassemble 0 gearbox.glb -o apart --clearance 0.5mm
grep -q 0.03 apart/paths/001_Bolt_1_.csv || fail "a path that was changed stays"

# Ended in the middle: the rounds that are known stay, and the same command goes on from there.
python3 - <<'PYTHON'
import json
report = json.load(open("apart/sequence.json"))
states = [step["state"] for step in report["steps"]]
report["steps"] = [step for step in report["steps"] if step["state"] == states[0]]
report["finished"] = False
assert 0 < len(report["steps"]) < 8, report
json.dump(report, open("apart/sequence.json", "w"), indent=2)
PYTHON
disassemble 6 gearbox.glb -o apart --clearance 0.5mm --time 0s
report apart/sequence.json '0 < len(report["steps"]) < 8 and report["out_of_time"]'
disassemble 0 gearbox.glb -o apart --clearance 0.5mm
report apart/sequence.json 'len(report["steps"]) == 8 and report["finished"]'

# A part in a closed cage: left, with what blocks it; and no time at all.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'PYTHON'
import json
from boxes import boxes
walls = [((0, 0, 0), (50, 50, 5)), ((0, 0, 45), (50, 50, 50)), ((0, 0, 5), (5, 50, 45)), ((45, 0, 5), (50, 50, 45)),
         ((5, 0, 5), (45, 5, 45)), ((5, 45, 5), (45, 50, 45))]
boxes("cage.obj", *walls)
boxes("captive.obj", ((20, 20, 20), (30, 30, 30)))
boxes("lid.obj", ((0, 0, 50), (50, 50, 55)))
json.dump({"parts": [{"name": part, "mesh": part + ".obj", "units": "mm"} for part in ("cage", "captive", "lid")]}, open("cage.json", "w"))
PYTHON
disassemble 6 cage.json -o cage
grep -qF 'left: captive: no path was found' out.txt && grep -qF 'blocked by cage' out.txt || fail "the cage: $(cat out.txt)"
grep -qxF 'forcelayer: cage.json: 1 of 2 parts comes off cage; 1 is left' err.txt || fail "the error: $(cat err.txt)"
report cage/sequence.json '[(l["part"], l["blocked_by"]) for l in report["left"]] == [("captive", ["cage"])] and report["base"] == "cage"'
disassemble 6 cage.json --target captive -o captive
disassemble 6 gearbox.glb --time 0s -o none
report none/sequence.json 'report["out_of_time"] and not report["finished"] and len(report["left"]) == 8'

# Rules: an ignored pair is not in the way, and the step says so. Other rules are another question for a second run.
rules() { printf 'part,object,clearance\n' >rules.csv && printf '%s\n' "$@" >>rules.csv; }
rules 'captive,cage,ignore' 'lid,nothing,touch'
disassemble 0 cage.json --rules rules.csv -o cage
grep -qE '^1\. captive: [0-9]+ mm or more along .* \(ignores cage(;.*)?\)$' out.txt || fail "no ignored pair: $(cat out.txt)"
grep -qF "warning: rules.csv: line 3: no part has the name 'nothing'" err.txt || fail "no warning: $(cat err.txt)"
report cage/sequence.json '[s["ignores"] for s in report["steps"]] == [["cage"], []] and report["rules"][0]["required_clearance_m"] is None'
disassemble 0 cage.json --rules rules.csv -o cage
report cage/sequence.json '[s["ignores"] for s in report["steps"]] == [["cage"], []]'
disassemble 6 cage.json -o cage
report cage/sequence.json 'report["rules"] == [] and [l["part"] for l in report["left"]] == ["captive"]'
# One distance for all pairs is --clearance. voxcheck reads the rules as disassemble does.
rules '*,*,0.5mm'
disassemble 0 gearbox.glb --clearance 0mm --rules rules.csv -o by_rules
python3 - <<'PYTHON' || fail "a rule for all pairs is not --clearance"
import json
by_rules, plain = (json.load(open(name + "/sequence.json"))["steps"] for name in ("by_rules", "apart"))
assert all({**a, "state": 0} == {**b, "state": 0} for a, b in zip(by_rules, plain, strict=True))
PYTHON
rules 'Pin,Clip/*,2mm' 'Pin,Housing,touch'
disassemble 0 gearbox.glb --target Pin --rules rules.csv -o pin
"$bin/voxcheck" rest.vox pin.pshell pin/paths/001_Pin.csv --seat 0,0,0m --rules rules.csv --exact gearbox.glb --without Pin \
  --part gearbox.glb#Pin --quiet || fail "voxcheck says no to a path by rules"

# Parts that overlap as installed: only force separates them.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'PYTHON'
import json
from boxes import boxes
boxes("plate.obj", ((0, 0, 0), (50, 50, 5)))
boxes("block.obj", ((20, 20, 4.5), (30, 30, 20)))
json.dump({"parts": [{"name": part, "mesh": part + ".obj", "units": "mm"} for part in ("plate", "block")]}, open("pressed.json", "w"))
PYTHON
disassemble 7 pressed.json -o pressed
line 2 '   overlaps plate as installed, 0.5 mm deep'
line 3 'All 2 parts come apart, if force overcomes the overlaps as installed.'
grep -qF 'accept exit status 7' err.txt || fail "no advice: $(cat err.txt)"
disassemble 7 pressed.json --target block -o pressed_target
tail -1 out.txt | grep -qx 'block comes out, and nothing needs to leave first, if force overcomes the overlaps as installed.' ||
  fail "the target: $(tail -1 out.txt)"

# The overlap that cracks of a mesh may hide is told with the step, by a run and by the next one, which knows the step.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'PYTHON'
import json
from boxes import boxes, cracked_box
cracked_box("cracked.obj", (-30, -30, -10), (30, 30, 0), 0.02)
boxes("box.obj", ((-5, -5, 0), (5, 5, 10)))
json.dump({"parts": [{"name": name, "mesh": name + ".obj", "units": "mm"} for name in ("cracked", "box")]}, open("cracked.json", "w"))
PYTHON
for run in first second; do
  disassemble 0 cracked.json -o cracked
  sed -n 2p out.txt | grep -qE '^   a collision of up to 0\.[01][0-9]* mm is not ruled out, because the meshes have cracks$' ||
    fail "the $run run of a mesh with cracks: $(cat out.txt)"
done
report cracked/sequence.json '2e-5 < report["steps"][0]["hidden_overlap_m"] < 2e-4 and report["steps"][0]["overlaps"] == []'

# Two rings that are linked come off a tray, but not apart, alone or as a target.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'PYTHON'
import json
from boxes import boxes
def frame(name, low, high, axis):  # four bars around a hole along the axis, 10 mm thick
    a, b = [n for n in range(3) if n != axis]
    bars = []
    for side, across in ((a, b), (b, a)):
        for end in (0, 1):
            l, h = list(low), list(high)
            if end: l[side] = high[side] - 10
            else: h[side] = low[side] + 10
            if side == b: l[a], h[a] = low[a] + 10, high[a] - 10
            bars.append((l, h))
    boxes(name, *bars)
boxes("tray.obj", ((-60, -60, -20), (120, 60, -10)))
frame("ring1.obj", (-40, -40, 25), (40, 40, 35), 2)
frame("ring2.obj", (10, -5, 0), (90, 5, 60), 1)
json.dump({"parts": [{"name": part, "mesh": part + ".obj", "units": "mm"} for part in ("tray", "ring1", "ring2")]}, open("rings.json", "w"))
PYTHON
disassemble 6 rings.json -o rings
grep -qx '1 of 2 parts comes off tray; 1 is left\.' out.txt && grep -q '^  left: ring[12]: ' out.txt || fail "linked rings: $(cat out.txt)"
disassemble 6 rings.json --target ring1 -o ring1

# A run that is interrupted at its first step says so, and is continued.
python3 - "$bin/forcelayer" <<'PYTHON' || fail "an interrupted run: $(cat interrupted/sequence.json)"
import json, signal, subprocess, sys
run = subprocess.Popen([sys.argv[1], "disassemble", "gearbox.glb", "-o", "interrupted"], stdout=subprocess.PIPE, text=True,
                       stderr=subprocess.PIPE, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
run.stdout.readline()
run.send_signal(signal.SIGINT)
out, err = run.communicate()
if run.returncode != 0:  # it was not faster than the signal
    assert run.returncode == 130 and "left, because the command was stopped." in out, (run.returncode, out, err)
    assert err.endswith("because the command was stopped; the same command continues from there\n"), err
    report = json.load(open("interrupted/sequence.json"))
    assert not report["finished"] and report["left"], report
PYTHON
disassemble 0 gearbox.glb -o interrupted

# A run that is stopped by its time keeps no step of which it does not know the overlaps.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'PYTHON'
import json
from boxes import boxes
pegs = ["peg%02d" % n for n in range(24)]
boxes("base.obj", ((0, 0, 0), (300, 100, 20)))
for n, peg in enumerate(pegs):
    x, y, z = 10 + 22 * (n % 12), 10 + 40 * (n // 12), 19 if n == 0 else 20
    boxes(peg + ".obj", ((x, y, z), (x + 10, y + 10, 40)))
json.dump({"parts": [{"name": part, "mesh": part + ".obj", "units": "mm"} for part in ["base"] + pegs]}, open("pegs.json", "w"))
PYTHON
for time in 20ms 50ms 100ms 200ms 400ms; do
  "$bin/forcelayer" disassemble pegs.json -o pegs --time $time >out.txt 2>err.txt || true
  report pegs/sequence.json 'all(step["path_length_m"] > 0 for step in report["steps"])'
done
disassemble 7 pegs.json -o pegs
report pegs/sequence.json '[(s["parts"], [o["object"] for o in s["overlaps"]]) for s in report["steps"] if s["overlaps"]] == [(["peg00"], ["base"])]'

# A thin closed wall is not passed, however much the meshes may deviate.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'PYTHON'
import json
from boxes import boxes
walls = [((0, 0, 0), (50, 50, 5)), ((0, 0, 45), (50, 50, 50)), ((0, 0, 5), (5, 50, 45)), ((45, 0, 5), (45.3, 50, 45)),
         ((5, 0, 5), (45, 5, 45)), ((5, 45, 5), (45, 50, 45))]
boxes("chamber.obj", *walls)
boxes("tab.obj", ((44, 20, 20), (44.3, 30, 30)))
json.dump({"parts": [{"name": part, "mesh": part + ".obj", "units": "mm", "mesh_deviation": "0.2mm"} for part in ("chamber", "tab")]}, open("chamber.json", "w"))
PYTHON
disassemble 6 chamber.json -o chamber
report chamber/sequence.json 'report["steps"] == [] and [l["part"] for l in report["left"]] == ["tab"]'

# Another target's answer stays, and so do files of others.
disassemble 2 gearbox.glb -o apart --target Cover
report apart/sequence.json 'report["finished"] and len(report["steps"]) == 8'
grep -qF 'holds a disassembly with another --target' err.txt || fail "another target: $(cat err.txt)"
mkdir -p kept/paths && echo keep >kept/paths/001_Pin.csv
disassemble 2 gearbox.glb -o kept
grep -qx keep kept/paths/001_Pin.csv && [ ! -e kept/sequence.json ] || fail "a file of another was replaced"

# Wrong input.
refuses 2 "--target: 'Covers': no node has this name; the nearest names are: Gearbox/Lid/Cover, Gearbox/Clip, Gearbox/Lid/Bolt, Gearbox/Clip/Half, Gearbox/Housing" gearbox.glb --target Covers -o wrong
disassemble 2 gearbox.glb
disassemble 2 gearbox.glb -o wrong --clearance 1
disassemble 2 gearbox.glb -o wrong --clearance=-1mm
disassemble 1 gearbox.glb -o wrong --rules none.csv
disassemble 2 gearbox.glb -o wrong --target Gearbox
disassemble 1 nothing.glb -o wrong
[ ! -e wrong ] || fail "a folder after wrong input"
echo '{"parts": [{"name": "a", "mesh": "cage.obj", "units": "mm"}]}' >one.json
refuses 3 "one.json: has only one part, so there is nothing to take apart; give an assembly; voxelize --list prints its parts" one.json -o wrong
mkdir taken && echo "a novel" >taken/sequence.json
disassemble 2 gearbox.glb -o taken
grep -qx 'a novel' taken/sequence.json || fail "a file of another kind was replaced"
finish
