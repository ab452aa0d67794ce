#!/usr/bin/env bash
# forcelayer pairs, as a user meets it: overlaps, distances and rules of an assembly, and wrong input.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
cp "$data/gearbox.glb" .

pairs() {  # STATUS ARGUMENTS...: output in out.txt and err.txt
  local wanted=$1 status=0
  shift
  "$bin/forcelayer" pairs "$@" >out.txt 2>err.txt || status=$?
  [ "$status" = "$wanted" ] || fail "status $status, not $wanted: pairs $*: $(cat out.txt err.txt)"
}
says() { head -1 out.txt | grep -qxF "$1" || fail "the first line is not '$1': $(head -1 out.txt)"; }
refuses() {  # STATUS LINE ARGUMENTS...
  local status=$1 line=$2
  shift 2
  pairs "$status" "$@"
  grep -qxF "forcelayer: $line" err.txt || fail "no error '$line': $(cat err.txt)"
  [ ! -s out.txt ] || fail "it prints something beside an error: $(cat out.txt)"
}
report() { python3 -c "import json; report = json.load(open('$1')); assert ($2), report" || fail "$1: $2"; }

# The gearbox: bolts and cover touch, the rest has gaps.
pairs 0 gearbox.glb --json gearbox.json
says 'All 36 pairs keep their rules; 5 touch as allowed.'
[ "$(wc -l <out.txt)" = 1 ] && [ ! -s err.txt ] || fail "more than a line where all is well: $(cat out.txt err.txt)"
report gearbox.json 'report["verdict"] == "clear" and report["kind"] == "keeps the clearance" and report["exit_status"] == 0'
report gearbox.json 'report["tool"] == "forcelayer" and report["input_files"][0]["path"] == "gearbox.glb"'
report gearbox.json 'all(f["kind"] == "stays in contact" and f["keeps_rule"] for f in report["found"])'
pairs 6 gearbox.glb --clearance 0.15mm
says '12 of 36 pairs are nearer than the required 0.15 mm, the nearest: Cover touches Bolt[1].'
[ "$(cat err.txt)" = 'forcelayer: gearbox.glb: 12 of 36 pairs do not keep their rules' ] || fail "the error: $(cat err.txt)"

# Rules: the first row counts, names are those of voxelize --list, and either part may stand first.
cat >rules.csv <<'CSV'
part,object,clearance
Lid,Bolt*,touch
Cover,Housing,touch
Bolt*,Housing,0.05mm
Housing,Pin,0.05mm
Half[1],Half[2],ignore
Pin,*,0.099mm
*,*,0.15mm
CSV
pairs 6 gearbox.glb --rules rules.csv --json rules.json
says '2 of 36 pairs are nearer than the required 0.099 mm, the nearest: Pin 0.0978 mm from Half[1]; 5 touch as allowed; 1 is ignored.'
grep -qE '^  Pin +Half\[1\] +0.0978 mm apart +0.099 mm +line 7 ' out.txt || fail "the table: $(cat out.txt)"
report rules.json '[f["rule_line"] for f in report["found"]][:2] == [7, 7] and report["ignored"] == 1'
sed -i 's/0.099mm/0.097mm/; s/^Cover,Housing.*/&\nCovers,Housing,touch/' rules.csv
pairs 0 gearbox.glb --rules rules.csv
grep -qF "forcelayer: warning: rules.csv: line 4: no part has the name 'Covers'; the nearest names are: Gearbox/Lid/Cover" err.txt ||
  fail "no warning about a name that no part has: $(cat err.txt)"
sed -i 's/Lid,Bolt\*/Lid,Bolt/' rules.csv
refuses 2 "rules.csv: line 2: several siblings have the name 'Bolt', such as Gearbox/Lid/Bolt[1]; write Bolt[1] for only the first, or Bolt* for all" \
  gearbox.glb --rules rules.csv

# A manifest: overlaps, a part inside another one, and the same part twice.
PYTHONPATH=$FORCELAYER_SOURCE_DIR/tests/support python3 - <<'PYTHON'
import json
from boxes import boxes
boxes("block.obj", ((0, 0, 0), (40, 40, 40)))
boxes("sunk.obj", ((10, 10, 39.5), (20, 20, 60)))
boxes("buried.obj", ((25, 25, 10), (30, 30, 15)))
boxes("far.obj", ((200, 0, 0), (210, 10, 10)))
boxes("open.obj", ((-10, 0, 0), (50, 40, 45)))
lines = open("open.obj").readlines()
open("open.obj", "w").writelines(lines[:-1])  # a face less
def scene(name, *parts):
    json.dump({"parts": [{"name": part, "mesh": part.split("_")[0] + ".obj", "units": "mm"} for part in parts]}, open(name, "w"))
scene("deep.json", "block", "sunk", "buried", "far")
scene("twice.json", "block", "block_again")
scene("open.json", "buried", "open", "far")
scene("one.json", "block")
scene("none.json")
PYTHON
pairs 6 deep.json --json deep_report.json
says '2 of 6 pairs overlap, the deepest: buried 15 mm into block.'
grep -qE '^  (sunk +block|block +sunk) +overlap 0.5 mm +touch +default ' out.txt || fail "the table: $(cat out.txt)"
report deep_report.json '[f["found"] for f in report["found"]] == ["overlap", "overlap"] and report["exit_status"] == 6'
pairs 6 twice.json
says '1 of 1 pair overlaps: block at least 20 mm into block_again.'
pairs 6 open.json
says '1 of 3 pairs is undecided, because a mesh has no inside.'
grep -qF 'it may be inside: the mesh of open is open' out.txt || fail "no reason: $(cat out.txt)"
pairs 0 open.json --rules <(printf 'part,object,clearance\nopen,*,ignore\n') --quiet
[ ! -s out.txt ] && [ ! -s err.txt ] || fail "not quiet: $(cat out.txt err.txt)"


# Rules from the standard input, lists of names, and numbers beside wildcards.
printf 'part,object,clearance\nopen,*,ignore\n' | "$bin/forcelayer" pairs open.json --rules /dev/stdin >out.txt 2>err.txt ||
  fail "rules from the standard input: $(cat out.txt err.txt)"
printf 'part,object,clearance\n"{Cover,Bolt*}",*,ignore\n' >list.csv
pairs 6 gearbox.glb --clearance 0.15mm --rules list.csv
[ ! -s err.txt ] || ! grep -q warning err.txt || fail "a list of names: $(cat err.txt)"
printf 'part,object,clearance\n*[1],*,ignore\n' >first.csv
pairs 6 gearbox.glb --clearance 0.15mm --rules first.csv
says '9 of 36 pairs are nearer than the required 0.15 mm, the nearest: Cover touches Bolt[2]; 15 are ignored.'

# Wrong input.
columns='the first line names the columns part,object,clearance, and each row has a cell for each'
printf 'part,object,clearance\n*,*,1mm\nPin,*,close\n' >bad.csv
refuses 2 "bad.csv: line 3: the clearance 'close' is not a length with a unit; write a length such as 1mm, touch or ignore" gearbox.glb --rules bad.csv
printf 'part,clearance\n*,1mm\n' >bad.csv
refuses 2 "bad.csv: line 1: the column object is missing; $columns" gearbox.glb --rules bad.csv
refuses 1 "no.csv: no such file; $columns" gearbox.glb --rules no.csv
refuses 2 "--clearance: '1' is not a length with a unit; write a length such as 1mm, touch or ignore" gearbox.glb --clearance 1
refuses 2 '--clearance: must be a length or touch; write pairs to ignore into the file of --rules' gearbox.glb --clearance ignore
pairs 2 gearbox.glb --units furlong
grep -q '^forcelayer: --units: ' err.txt || fail "the unit: $(cat err.txt)"
pairs 2 block.obj
grep -q 'unit' err.txt || fail "no unit: $(cat err.txt)"
refuses 3 'one.json: has only one part, so there is no pair; give an assembly; voxelize --list prints its parts' one.json
refuses 3 'none.json: parts: is missing, empty or not a list; list at least one object with its mesh' none.json --json none_report.json
report none_report.json 'report["exit_status"] == 3 and report["error"]["where"] == "parts"'
refuses 1 'no.glb: no such file; check the path' no.glb
pairs 2
status=0
"$bin/forcelayer" --quiet pairs gearbox.glb >out.txt 2>err.txt || status=$?
[ "$status" = 2 ] && grep -qF -- '--quiet: stands before the word pairs' err.txt || fail "an option before pairs: $status $(cat out.txt err.txt)"
pairs 2 gearbox.glb --json gearbox.glb
cmp -s gearbox.glb "$data/gearbox.glb" || fail "the assembly is overwritten"
finish
