#!/usr/bin/env bash
# voxcheck as a user meets it: verdicts, seats, allowed objects, every kind of path and report, errors.
set -euo pipefail
bin=$FORCELAYER_BIN_DIR
data=$FORCELAYER_SOURCE_DIR/sample_data
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

fail() { echo "FAILED: $*" >&2; exit 1; }

# check STATUS ARGUMENTS...: that exit status; what was said is in out.txt and err.txt.
check() {
  local wanted=$1 status=0
  shift
  "$bin/voxcheck" "$@" >out.txt 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || { cat out.txt err.txt; fail "status $status instead of $wanted: $*"; }
  # The first sentence says yes or no, as the exit status does.
  local answer='^(Comes out|Keeps the clearance|Passes without a collision|Leaves its seat|Is still in its seat)(, |: )'
  [ "$wanted" -eq 0 ] || answer='^(Does not keep the clearance|Collides|Does not come out|Too close to call|Undecided|Never near the scene)(, |: )'
  if [ -s out.txt ] && [ "$wanted" -eq 0 -o "$wanted" -eq 6 ] && ! head -n 1 out.txt | grep -qE '^(::|<)'; then
    head -n 1 out.txt | grep -qE "$answer" || { cat out.txt; fail "status $wanted, and the first sentence: $*"; }
  fi
  grep -v '^voxcheck: warning: ' err.txt >lines.txt || true
  [ "$(wc -l <lines.txt)" -eq $((wanted != 0)) ] || { cat err.txt; fail "stderr has not one line for an error: $*"; }
  grep '^voxcheck: warning: ' err.txt >warnings.txt || true
}
warns() { grep -qF -e "$1" warnings.txt && [ "$(wc -l <warnings.txt)" -eq 1 ] || { cat err.txt; fail "no warning '$1' alone"; }; }
silent() { [ ! -s warnings.txt ] || { cat err.txt; fail "warned without need"; }
}
says() { grep -qE -e "$1" out.txt || { cat out.txt; fail "not said: '$1'"; }; }
errs() { grep -qE -e "$1" err.txt || { cat err.txt; fail "no '$1' on stderr"; }; }

"$bin/voxelize" "$data/gearbox.glb" --without Lid --voxel-size 1mm -o opened.vox --quiet
"$bin/pointshell" "$data/gearbox.glb#Cover" --voxel-size 1mm -o cover.pshell --quiet

# Straight up, out of its place; with a pause. The same path in other words.
python3 - <<'PYTHON'
def rows(way):
    return [(0.01 * i, *way(0.01 * i)) for i in range(101)]
out = rows(lambda t: (0, 0, 0.06 * max(0, t - 0.2)))
def write(name, header, lines):
    with open(name, "w", newline="") as file:
        file.write(header + "\n" + "\n".join(lines) + "\n")
write("out.csv", "t_s,x_m,y_m,z_m,qw,qx,qy,qz", [f"{t:.2f},{x},{y},{z:.6f},1,0,0,0" for t, x, y, z in out])
write("mm.csv", "\ufeff# saved by hand\r\nt_ms;x_mm;y_mm;z_mm;rx_deg;ry_deg;rz_deg",
      [f"{1000 * t:.0f};{1000 * x};{1000 * y};{1000 * z:.3f};0;0;0".replace(".", ",") for t, x, y, z in out])
# Above the gearbox, and once, between two rows, through it.
write("over.csv", "t_s,x_m,y_m,z_m", ["0,0,0,0.2", "1,0,0,0.1", "2,0,0,0.2"])
write("through.csv", "t_s,x_m,y_m,z_m", ["0,0,0,0.2", "1,0,0,-0.2", "2,0,0,-0.2"])
write("rest.csv", "t_s,x_m,y_m,z_m", ["0,0,0,0", "1,0,0,0"])
PYTHON

# The reports for hosts say the same: told WARNINGS FAILURES ERRORS WORDS, in host.xml, host.quality and the lines of out.txt.
hosts=(--report junit:host.xml --report gitlab:host.quality --report github --quiet)
told() {
  python3 - "$@" <<'PYTHON' || { cat host.xml host.quality out.txt; fail "the reports for hosts, of $*"; }
import json, sys, xml.etree.ElementTree as tree
warnings, failures, errors, words = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
suite = tree.parse("host.xml").getroot()
assert [suite.get(key) for key in ("tests", "failures", "errors")] == ["1", str(failures), str(errors)], suite.attrib
case, = suite.findall("testcase")
assert len(case.findall("failure")) == failures and len(case.findall("error")) == errors
assert (case.findtext("system-err") or "").count("warning: ") == warnings
issues = json.load(open("host.quality"))
severities = ["critical"] * errors + ["info"] * warnings + ["major"] * failures
assert [issue["severity"] for issue in issues] == severities, issues
lines = open("out.txt").read().splitlines()
assert sum(line.startswith("::warning ") for line in lines) == warnings
assert sum(line.startswith("::error ") for line in lines) == failures + errors
assert len(lines) == warnings + failures + errors
for text in (open("host.xml").read(), open("host.quality").read(), open("out.txt").read()):
    assert words in text, words
PYTHON
}

# Clear, by the usual half inch and by more.
check 0 opened.vox cover.pshell over.csv --clearance 12.7mm --json over.json
# Clear, and nobody can read it.
"$bin/voxcheck" opened.vox cover.pshell over.csv >/dev/full 2>err.txt && fail "an answer that was lost"
errs '^voxcheck: standard output: cannot be written$'
says '^Keeps the clearance, along a path that ends where it begins: stays [0-9.]+ mm away or more \((proven; nearest to [A-Z][a-z]+(\[[0-9]\])?, after [0-9.]+ of 200 mm|nothing is nearer); 12\.7 mm required\)\.$'
python3 - <<'PYTHON'
import json
over = json.load(open("over.json"))
assert over["verdict"] == "clear" and over["violations"] == [] and over["poses"] == 3, over
assert over["required_clearance_m"] == 0.0127 and over["min_clearance"]["clearance_m"] >= 0.0127, over
PYTHON

# A violation between two rows is seen. Every report says the same.
check 6 opened.vox cover.pshell through.csv --clearance 12.7mm --json through.json --report csv:curve.csv --report=junit:through.xml \
  --report gitlab:quality.json --report=github
through='Collides, straight along -z: goes into [A-Z][a-z]+(\[[0-9]\])? \(too near from 1[0-9.]+ mm on, worst after [0-9.]+ of 400 mm\)\.'
says "^$through\$"
says "^::error file=through\.csv,title=clearance::$through\$"
says '^  1[0-9]{2}\.[0-9] to 2[0-9]{2}\.[0-9] mm along the path: goes into .*, after [0-9.]+ mm, at x [0-9.-]+, y [0-9.-]+, z [0-9.-]+ mm$'
# The path is what is wrong, in a few words; it begins and ends too far away to be installed there.
errs '^voxcheck: through\.csv: collides: goes into [A-Z][a-z]+(\[[0-9]\])? \(too near from 1[0-9.]+ mm on, worst after [0-9.]+ of 400 mm\)$'
silent
python3 - <<'PYTHON'
import csv, json, xml.etree.ElementTree as tree
report, quality = json.load(open("through.json")), json.load(open("quality.json"))
[violation] = report["violations"]
assert report["verdict"] == "not clear" and report["motions_subdivided"] == 1, report
assert 0 < violation["from_s"] < violation["to_s"] < 1, violation
assert violation["clearance_m"] == 0 and violation["object"].startswith("Gearbox/"), violation
curve = [[float(cell) for cell in row] for row in list(csv.reader(open("curve.csv")))[1:]]
assert curve[0][0] == 0 and curve[-1][1] == 2
assert all(a[1] == b[0] for a, b in zip(curve, curve[1:])), "the curve has gaps"
near = [row for row in curve if row[2] < 0.0127]
assert near[0][0] == violation["from_s"] and near[-1][1] == violation["to_s"], (near[0], violation)
assert len(quality) == 1 and quality[0]["location"]["path"] == "through.csv" and quality[0]["fingerprint"]
suite = tree.parse("through.xml").getroot()
assert suite.get("failures") == "1" and "goes into" in suite.find("testcase/failure").get("message")
assert report["kind"] == "collides" and report["direction"] == "straight along -z", report
assert report["sentence"] == suite.find("testcase/failure").get("message") == quality[0]["description"], report
PYTHON

# The seat: until the part has left it, only other objects count; without one it is a violation.
# Then it is said how to tell where the part is installed.
check 6 opened.vox cover.pshell out.csv --clearance 1mm
errs "; if the part is installed at the path's beginning, give --seat 0,0,0m$"
silent
# There, narrow features are not felt: that is said, and it is not clear before it is accepted or settled.
check 6 opened.vox cover.pshell out.csv --clearance 1mm --seat 0,0,0m --json open.json --report junit:open.xml --report github
open='[Uu]ndecided.*: .*in its seat the part (touches Housing|comes nearer than [0-9.]+ mm to Housing), and without meshes, features narrower than 1\.73 mm are not seen \(1 mm of clearance required\)'
says "^$open\.\$"
says '^Undecided, straight along \+z: gets 1 mm away from its seat after [1-5]\.[0-9] mm, but '
says "^::error file=out\.csv,title=clearance::$open\.\$"
errs "^voxcheck: out\.csv: $open; check the seat with --exact, or accept it with --felt-seat\$"
python3 - <<'PYTHON'
import json, xml.etree.ElementTree as tree
report = json.load(open("open.json"))
[violation] = report["violations"]
assert report["verdict"] == "not clear" and report["seat_settled"] is False, report
assert violation["seat_not_settled"] and not violation["pushed_into_seat"], violation
assert [violation["from_s"], violation["to_s"]] == list(report["seated"][0].values())[:2], violation
assert [violation["from_m"], violation["to_m"]] == list(report["seated"][0].values())[2:4], violation
assert report["kind"] == "undecided" and "are not seen" in tree.parse("open.xml").getroot().find("testcase/failure").get("message")
PYTHON
felt=(--seat 0,0,0m --felt-seat)
check 0 opened.vox cover.pshell out.csv --clearance 1mm "${felt[@]}" --json out.json
says '^Comes out, straight along \+z: leaves Housing within the first [1-5]\.[0-9] mm, otherwise stays [12]\.[0-9]{1,3} mm away or more \(proven; nearest to [A-Z][a-z]+(\[[0-9]\])?, after [1-5]\.[0-9] of 48 mm; 1 mm required\)\.$'
says '^  nearest otherwise: at least [12]\.[0-9]{1,3} mm and at most '
says '^  in its seat from 0\.0 to [1-5]\.[0-9] mm along the path: at least 0 mm and at most [01]\.[0-9]+ mm to '
says '^  in its seat, features narrower than 1\.73 mm are not seen; the meshes show them$'
"$bin/voxinfo" path out.csv --reverse -o in.csv --quiet
check 0 opened.vox cover.pshell in.csv --clearance 1mm "${felt[@]}"
says '^Keeps the clearance, straight along -z: reaches Housing within the last [1-5]\.[0-9] mm, otherwise stays'
silent
check 6 opened.vox cover.pshell in.csv --clearance 1mm
errs "; if the part is installed at the path's end, give --seat 0,0,0m$"
# The pose is as --seat takes it.
printf 't_s,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n0,0,0,0,0,0,180\n1,0,0,60,0,0,180\n' >turned.csv
check 6 opened.vox cover.pshell turned.csv --clearance 1mm
errs '--seat 0,0,0m,[0-9.e+-]+,[0-9.e+-]+,[0-9.e+-]+,[0-9.e+-]+$'
turned_seat=$(sed 's/.*--seat //' err.txt)
check 0 opened.vox cover.pshell turned.csv --clearance 1mm --felt-seat --seat "$turned_seat" --allow 'Clip/*' --allow Pin
# A seat in which nothing is touched; a path of another scene.
check 6 opened.vox cover.pshell out.csv --clearance 1mm --seat 0,0,100mm
warns 'warning: the part touches nothing where it is installed (--seat)'
printf 't_s,x_m,y_m,z_m\n0,5,0,0\n1,5,0,1\n' >astray.csv
check 0 opened.vox cover.pshell astray.csv --clearance 12.7mm --json astray.json
warns 'warning: the part is never near the scene: check that part and path belong to this scene'
# Hosts get a report too, also where the terminal is quiet; a job may ask that such a path fails.
check 0 opened.vox cover.pshell astray.csv --clearance 12.7mm "${hosts[@]}"
silent
told 1 0 0 'the part is never near the scene: check that part and path belong to this scene'
check 6 opened.vox cover.pshell astray.csv --clearance 12.7mm "${hosts[@]}" --fail-on far --json far.json
told 1 1 0 'Never near the scene'
errs '^voxcheck: astray\.csv: never near the scene: it stays [0-9.]+ mm away or more \(nothing is nearer; 12\.7 mm required\); check the units of the path'
grep -q '"verdict": "not clear"' far.json || fail "clear, though it is too far"
check 0 opened.vox cover.pshell over.csv --clearance 12.7mm "${hosts[@]}" --fail-on far
"$bin/voxcheck" opened.vox cover.pshell through.csv --fail-on nothing --json any.json --quiet 2>err.txt && [ ! -s err.txt ] || fail "a failure on nothing: $(cat err.txt)"
python3 -c 'import json; r = json.load(open("any.json")); assert r["kind"] == "collides" and r["exit_status"] == 0 and len(r["blocked_by"]) > 0, r' ||
  fail "on nothing: $(cat any.json)"
# Where no clearance is given it is 1 mm.
python3 -c 'import json; r = json.load(open("any.json")); assert r["required_clearance_m"] == 0.001, r["required_clearance_m"]' ||
  fail "the default of --clearance"
told 0 0 0 ''
# The file of the path is named from the folder of the job on.
for name in ./astray.csv "$PWD/astray.csv"; do
  check 0 opened.vox cover.pshell "$name" "${hosts[@]}"
  grep -q '^::warning file=astray\.csv,' out.txt && grep -q '"path": "astray.csv"' host.quality || fail "$name is no file of the job"
done
# A path in meters that was meant in millimeters leaves the seat, and goes on for 60 m: that is no clear without a word.
printf 't_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,60\n' >meters.csv
check 0 opened.vox cover.pshell meters.csv --clearance 1mm --seat 0,0,0m --felt-seat
warns "warning: the path leads away from the scene by 382 times the scene's size: check the unit of the path"
# A seat at neither end of the path lets nothing off.
printf 't_s,x_m,y_m,z_m\n0,0,0,0.06\n1,0,0,0\n2,0,0,0.06\n' >visit.csv
check 6 opened.vox cover.pshell visit.csv --clearance 1mm --seat 0,0,0m
warns 'warning: --seat: has no effect, because the path neither begins nor ends there: the nearer end is 60 mm away, and must be less than 2 mm away'
# Both ends in the seat.
printf 't_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0.06\n2,0,0,0\n' >there_and_back.csv
check 0 opened.vox cover.pshell there_and_back.csv --clearance 1mm "${felt[@]}"
says '^Keeps the clearance, .*: leaves Housing within the first [1-5]\.[0-9] mm and reaches Housing within the last [1-5]\.[0-9] mm, otherwise stays'
silent
# A turn whose unit is missing, and one whose way round is not said, are no path: the part would be checked otherwise.
printf 't_s,x_m,y_m,z_m,rx,ry,rz\n0,0,0,0.2,0,0,0\n1,0,0,0.2,0,0,90\n' >unitless.csv
check 2 opened.vox cover.pshell unitless.csv
errs "unitless\.csv: line 1: has 'rx', which may be a rotation in an unknown form: rename this column; .*rx_deg,ry_deg,rz_deg"
printf 't_s,x_m,y_m,z_m,rz_deg\n0,0,0,0.2,0\n1,0,0,0.2,181\n' >around.csv
check 2 opened.vox cover.pshell around.csv
errs "around\.csv: line 3: 'rz_deg' turns by 180 degrees or more.*; add rows before"
# A part that turns far from one row to the next, about a point that is not its centroid: that is said, once. Every
# row of the resampled path is near the next.
python3 - <<'PYTHON'
def write(name, degrees):
    with open(name, "w") as file:
        print("t_s,x_m,y_m,z_m,ry_deg", file=file)
        for n, turn in enumerate(degrees):
            print(f"{n / (len(degrees) - 1)},0,0,1,{turn}", file=file)
write("pivot.csv", [0, 30, 150])
write("fine.csv", [1.25 * n for n in range(121)])
PYTHON
check 0 opened.vox cover.pshell pivot.csv --clearance 12.7mm --json pivot.json
grep '^voxcheck: warning: between the rows ' err.txt >warnings.txt || true
warns 'between the rows at 0.500 and 1.000 s the part turns by 120 degrees. voxcheck moves the centroid in a straight line, by '
grep -A 1 '"warnings": \[' pivot.json | grep -q 'turns by 120 degrees' || fail "the report does not warn of a wide step"
check 0 opened.vox cover.pshell fine.csv --clearance 12.7mm
! grep -q 'between the rows' err.txt || fail "warned of small steps: $(cat err.txt)"
"$bin/voxinfo" path pivot.csv --resample 5ms -o close.csv --quiet
check 0 opened.vox cover.pshell close.csv --clearance 12.7mm
! grep -q 'between the rows' err.txt || fail "warned of resampled steps: $(cat err.txt)"
# The point that moves straight can be given: then few rows are the same motion as many, by files and by meshes.
"$bin/voxinfo" path pivot.csv --resample 0.2ms -o closer.csv --quiet
hows=("")
[ ! -x "$bin/voxcheck-exact" ] || hows+=("--exact $data/gearbox.glb --without Lid --part $data/gearbox.glb#Cover")
for how in "${hows[@]}"; do
  # shellcheck disable=SC2086  # words, or none
  check 0 opened.vox cover.pshell pivot.csv --clearance 12.7mm --center 0,0,0m $how --json center.json
  ! grep -q 'between the rows' err.txt || fail "warned of a center: $(cat err.txt)"
  # shellcheck disable=SC2086
  check 0 opened.vox cover.pshell closer.csv --clearance 12.7mm $how --json closer.json
  # shellcheck disable=SC2086
  check 0 opened.vox cover.pshell pivot.csv --clearance 12.7mm $how --json centroid.json
  python3 - <<'PYTHON' || fail "--center: $(cat center.json)"
import json
least_m = {}
for name in ("center", "closer", "centroid"):
    least = json.load(open(name + ".json"))["min_clearance"]
    least_m[name] = least.get("exact_m", least["clearance_m"])
# Measured distances are found to a hundred thousandth. What the files prove depends on the poses.
within_m = 2e-7 + 1e-5 * least["exact_m"] if "exact_m" in least else 1e-4
assert abs(least_m["center"] - least_m["closer"]) < within_m < abs(least_m["center"] - least_m["centroid"]), least_m
PYTHON
done
check 2 opened.vox cover.pshell pivot.csv --center 0,0
errs '--center'
# The scene holds the part too: it is seated on itself, all over.
"$bin/voxelize" "$data/gearbox.glb" --voxel-size 2mm -o whole.vox --quiet
check 6 whole.vox cover.pshell out.csv --clearance 1mm --seat 0,0,0m --felt-seat
warns "warning: the scene seems to contain the part itself: every point of the part touches the scene; bake the scene --without the part, or with smaller voxels"
grep -A 1 '"warnings": \[' astray.json | grep -q 'never near the scene' || fail "the report does not warn"
check 0 opened.vox cover.pshell astray.csv --clearance 12.7mm --quiet
silent
check 0 --allow Housing opened.vox cover.pshell out.csv --clearance 1mm
check 0 opened.vox cover.pshell out.csv --clearance 1mm --allow 'Gear*/Ho?sing' --threads 1
check 0 opened.vox cover.pshell out.csv --clearance 1mm --allow 'Gearbox[1]/Housing[1]'  # as the bakes take it
check 6 opened.vox cover.pshell through.csv --clearance 1mm "${felt[@]}"
# A path that ends near the seat's object, elsewhere, is not in the seat.
printf 't_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0.06\n2,0.03,0,0.005\n' >elsewhere.csv
check 6 opened.vox cover.pshell elsewhere.csv --clearance 5.5mm "${felt[@]}" --allow 'Clip/*' --allow Pin --json elsewhere.json
grep -q '"object": "Gearbox/Housing"' elsewhere.json || fail "the seat's object is let off elsewhere"
check 0 opened.vox cover.pshell out.csv --clearance 1mm --seat 0,0,0m --allow Housing  # all of its seat
# Pushed into its seat it is not clear.
printf 't_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,-0.003\n2,0,0,0.06\n' >pushed.csv
check 6 opened.vox cover.pshell pushed.csv --clearance 1mm "${felt[@]}" --json pushed.json
says '^Does not come out, .*: goes at least [0-9.]+ mm deeper into Housing than in the installed pose \(after '
grep -q '"pushed_into_seat": true' pushed.json || fail "not pushed in"

# One path, however it is written; however many threads.
check 0 opened.vox cover.pshell mm.csv --clearance 1mm "${felt[@]}" --json mm.json
check 0 opened.vox cover.pshell out.csv --clearance 1mm "${felt[@]}" --json threads.json --threads 5
check 0 opened.vox cover.pshell out.csv --clearance 5mm "${felt[@]}" --allow 'Clip/*' --allow Pin --json wider.json  # in its seat for longer
"$bin/voxrun" opened.vox cover.pshell --motion out.csv --as-fast-as-possible --quiet --trace trace.csv \
  --save-path path.csv --record run.flr
for kind in trace.csv path.csv run.flr; do
  check 0 opened.vox cover.pshell $kind --clearance 1mm "${felt[@]}" --json "${kind%.*}.json"
done
python3 - <<'PYTHON'
import json
def told(name):
    report = json.load(open(name))
    return {key: report[key] for key in report if key not in ("seconds", "threads", "input_files")}
assert told("out.json") == told("threads.json")
# Its way in the seat: it rises by 60 mm/s from 0.2 s on, and lies on the housing before.
for name in ("out.json", "wider.json"):
    report = told(name)
    [seated] = report["seated"]
    assert abs(report["travel_m"] - 0.048) < 1e-9, report["travel_m"]
    assert abs(seated["travel_m"] - 0.06 * (seated["to_s"] - 0.2)) < 1e-6, seated
    assert seated["clearance_m"] == 0 <= seated["at_most_m"] < 0.002 and seated["t_s"] <= 0.2, seated
assert told("wider.json")["seated"][0]["travel_m"] > told("out.json")["seated"][0]["travel_m"] + 0.003
assert told("trace.json") == told("path.json") == told("run.json")
a, b = told("out.json"), told("mm.json")
assert abs(a["min_clearance"]["clearance_m"] - b["min_clearance"]["clearance_m"]) < 1e-9, (a, b)
assert a["seated"][0]["to_s"] == b["seated"][0]["to_s"]
PYTHON
"$bin/voxinfo" path mm.csv -o back.csv --quiet
"$bin/voxinfo" path back.csv --json back.json | grep -q '^back.csv: 101 poses from 0 to 1 s; the frame'\''s origin travels 0.048 m' ||
  fail "voxinfo path does not say what is there"
check 0 opened.vox cover.pshell back.csv --clearance 1mm "${felt[@]}"

# The meshes settle what the files leave open. A cover that goes sideways 3 mm above the housing: 3 mm, a graze.
if [ -x "$bin/voxcheck-exact" ]; then
  printf 't_s,x_m,y_m,z_m\n0,0,0,0.06\n1,0,0,0.003\n2,0.01,0,0.003\n3,0.01,0,0.06\n' >sideways.csv
  exact=(--exact "$data/gearbox.glb" --without Lid --part "$data/gearbox.glb#Cover" --allow 'Clip/*' --allow Pin)
  check 6 opened.vox cover.pshell sideways.csv --clearance 2.8mm
  says 'goes into (Pin|Half)'
  check 0 opened.vox cover.pshell sideways.csv --clearance 2.8mm "${exact[@]}" --json settled.json
  says '^Keeps the clearance, .*: stays 3 mm away or more \(measured to Housing, after [0-9.]+ of 124 mm; 2\.8 mm required\)\.$'
  check 6 opened.vox cover.pshell sideways.csv --clearance 3.2mm "${exact[@]}" --json nearer.json
  says '^Does not keep the clearance, .*: comes as near as 3 mm \(measured to Housing, after [0-9.]+ of 124 mm; 3\.2 mm required\)\.$'
  [ "$(grep -c 'mm along the path' out.txt)" = 1 ] || fail "more than one stretch: $(cat out.txt)"
  check 6 opened.vox cover.pshell sideways.csv --clearance 3mm "${exact[@]}" --json graze.json --report junit:graze.xml
  says '^Too close to call, .*: comes within [23](\.[0-9]+)? mm of Housing; deviations and rounding \(0\.000[0-9]+ mm\) leave this undecided \('
  check 6 opened.vox cover.pshell through.csv --clearance 1mm "${exact[@]}" --json crossed.json
  says '^Collides, straight along -z: meets Housing, at least [1-9][0-9.]* mm deep \(contact from [0-9.]+ mm on, worst after [0-9.]+ of 400 mm\)\.$'
  # Where surfaces meet it is no graze, however little is required.
  check 6 opened.vox cover.pshell through.csv --clearance 0mm "${exact[@]}" --json met.json
  says '^Collides, .*: meets Housing, at least '
  check 0 opened.vox cover.pshell out.csv --clearance 1mm --seat 0,0,0m "${exact[@]}" --json seated.json
  python3 - <<'PYTHON'
import json
settled, nearer, graze, crossed, seated = (
    json.load(open(name + ".json")) for name in ("settled", "nearer", "graze", "crossed", "seated"))
assert settled["verdict"] == "clear" and settled["violations"] == []
least = settled["min_clearance"]
assert abs(least["exact_m"] - 0.003) < 1e-9 and 0 < least["slack_m"] < 5e-6, least
apart = sum((a - b) ** 2 for a, b in zip(least["point_m"], least["object_point_m"])) ** 0.5
assert abs(apart - least["exact_m"]) < 1e-9 and settled["exact"]["moments_measured"] > 2
[v] = nearer["violations"]
# It is 3.2 mm up at this time, and again.
assert abs(v["from_s"] - (1 - 0.0002 / 0.057)) < 1e-3 and abs(v["to_s"] - (2 + 0.0002 / 0.057)) < 1e-3, v
assert v["clearance_m"] <= 0.003 <= v["at_most_m"] and not v["graze"], v
assert all(v["graze"] and abs(v["exact_m"] - 0.003) < 1e-8 for v in graze["violations"]), graze
[v] = crossed["violations"]
assert v["exact_m"] == 0 and v["from_s"] < 0.5 < v["to_s"], v
# Where it is too near all the time it is looked at once in a 256th of the path, 1.6 mm: with those that find where that begins and
# ends it is measured at 66 moments.
assert crossed["exact"]["moments_measured"] < 130, crossed["exact"]
apart = sum((a - b) ** 2 for a, b in zip(v["point_m"], v["object_point_m"])) ** 0.5
assert 0.001 < v["depth_m"] <= v["max_depth_m"] and abs(apart - v["depth_m"]) < 1e-6, (apart, v)
assert not any(v["graze"] for v in json.load(open("met.json"))["violations"])
# It left its seat 1.6 mm up, and rose.
exact = seated["min_clearance"]["exact_m"]
assert seated["verdict"] == "clear" and 0.001 < exact < 0.0025, seated["min_clearance"]
[stretch] = seated["seated"]
assert stretch["exact_m"] < 1e-5 and stretch["at_most_m"] < 1e-4 and 0.001 < stretch["travel_m"] < 0.005, stretch
[seat] = seated["seat_depths"]
assert seated["seat_settled"] and seat["object"] == "Gearbox/Housing", seated
assert seat["deepest_m"] <= seat["allowed_m"] < 1e-7, seat
PYTHON
  # Pushed into its seat: as deep as it goes.
  check 6 opened.vox cover.pshell pushed.csv --clearance 1mm --seat 0,0,0m "${exact[@]}" --json deep.json
  says '^Does not come out, .*: goes [0-9.]+ mm deep into Housing, which the installed part does not overlap \(too deep from the start, worst after '

  # Bolt heads of 3 mm: the cover goes through them. The files notice it, and the meshes tell how deep.
  if [ -z "${FORCELAYER_SANITIZED:-}" ]; then  # the same code as above, for minutes
    "$bin/voxelize" "$data/gearbox.glb" --without Cover --without 'Bolt???' --voxel-size 3mm -o held.vox --quiet
    "$bin/pointshell" "$data/gearbox.glb#Cover" --voxel-size 3mm -o coarse.pshell --quiet
    held=(held.vox coarse.pshell out.csv --clearance 1mm --seat 0,0,0m)
    meshes=(--exact "$data/gearbox.glb" --without Cover --without 'Bolt???' --part "$data/gearbox.glb#Cover")
    check 6 "${held[@]}"
    says '^Does not come out, .* goes at least [0-9.]+ mm deeper into Bolt than in the installed pose '
    check 6 "${held[@]}" --felt-seat
    check 6 "${held[@]}" "${meshes[@]}" --json through_bolt.json --report junit:through_bolt.xml
    says '^Does not come out, .* goes 1\.[45][0-9]* mm deep into Bolt, which the installed part does not overlap'
    check 6 "${held[@]}" "${meshes[@]}" --felt-seat
    check 0 "${held[@]}" "${meshes[@]}" --seat-depth 2mm
    says '^  in its seat, the part goes at most 2\.001 mm deeper than installed; --seat-depth and the meshes.* deviations allow this\. The deepest position found is 1\.[45][0-9]* mm deeper than installed, in Bolt$'
    python3 - <<'PYTHON'
import json, xml.etree.ElementTree as tree
report = json.load(open("through_bolt.json"))
[v] = report["violations"]
assert report["seat_settled"] and v["pushed_into_seat"] and v["object"] == "Gearbox/Lid/Bolt", report
# The head begins where the cover ends; it has gone through when it is 3 mm higher: so thick it is.
assert 0.0014 < v["depth_m"] < 0.0016 and v["from_s"] < 0.21, v
apart = sum((a - b) ** 2 for a, b in zip(v["point_m"], v["object_point_m"])) ** 0.5
assert abs(apart - v["depth_m"]) < 1e-6, (apart, v)
assert "deep into Bolt" in tree.parse("through_bolt.xml").getroot().find("testcase/failure").get("message")
PYTHON
    # Its picture says no, and shows what holds it, by the files as by the meshes. A voxview beside the commands notes what it is asked.
    mkdir beside
    cp "$bin/voxcheck" "$bin/voxcheck-exact" beside
    printf '#!/bin/sh\nprintf "%%s\\n" "$@" >"$(dirname "$0")/asked"\n' >beside/voxview
    chmod +x beside/voxview
    for count in 0 ${#meshes[@]}; do
      rm -f beside/asked
      bin=$PWD/beside check 6 "${held[@]}" "${meshes[@]:0:count}" --report picture:no.png
      grep -A 1 -x -e --title beside/asked | grep -q '^Does not come out' || fail "the picture's title: $(cat beside/asked)"
      grep -A 1 -x -e --measure-object beside/asked | grep -qx Gearbox/Lid/Bolt || fail "the picture's object: $(cat beside/asked)"
      grep -A 1 -x -e --measure-words beside/asked | grep -qE '^[0-9.]+ mm deep$' || fail "the picture's measure: $(cat beside/asked)"
    done
  fi
  # On a terminal a line shows how far it is, and is gone at the end.
  if command -v script >/dev/null; then
    call="$bin/voxcheck opened.vox cover.pshell out.csv --clearance 1mm --seat 0,0,0m --exact $data/gearbox.glb"
    call+=" --without Lid --part $data/gearbox.glb#Cover --allow 'Clip/*' --allow Pin"
    script -qec "$call" /dev/null </dev/null >seen.txt
    for stage in 'checking the path' 'reading the meshes'; do
      grep -qF "$stage" seen.txt || fail "no progress: $(cat -v seen.txt)"
    done
    python3 -c 'text = open("seen.txt").read(); assert "%" not in text[text.rindex("\x1b[K"):]' || fail "a line is left"
    script -qec "$call --quiet" /dev/null </dev/null >seen.txt
    ! grep -q '%' seen.txt || fail "progress of a quiet command: $(cat -v seen.txt)"
  fi
  # Where the time is over the answer is undecided. A certain collision stays one.
  limited=(opened.vox cover.pshell out.csv --clearance 1mm --exact "$data/gearbox.glb" --without Lid --part "$data/gearbox.glb#Cover")
  check 6 "${limited[@]}" --seat 0,0,0m --time 1us --json limited.json
  errs 'undecided: the time limit \(--time\) expired before the clearance was checked .*; give a longer --time'
  grep -q '"kind": "undecided"' limited.json && grep -q '"out_of_time": true' limited.json || fail "out of time: $(cat limited.json)"
  check 2 opened.vox cover.pshell out.csv --time 1s
  errs '--time: has no effect without --exact'
  check 4 opened.vox cover.pshell sideways.csv --exact "$data/gearbox.glb" --part "$data/gearbox.glb#Cover"
  errs 'opened\.vox: --exact: was not baked from these meshes: the meshes have 3600 triangles'
  check 4 opened.vox cover.pshell sideways.csv --exact "$data/gearbox.glb" --without Lid --part "$data/gearbox.glb#Pin"
  check 3 opened.vox cover.pshell sideways.csv --exact "$data/gearbox.glb#Nobody" --part "$data/gearbox.glb#Cover"
  check 2 opened.vox cover.pshell sideways.csv --exact "$data/gearbox.glb"
  errs '--part: is missing'
  # Meshes of others are read in a process of its own, as by the bakes.
  check 0 opened.vox cover.pshell sideways.csv --clearance 2.8mm "${exact[@]}" --sandbox
  check 3 opened.vox cover.pshell sideways.csv --clearance 2.8mm "${exact[@]}" --sandbox=time=1ms
  errs 'takes longer than the sandbox.s limit of 0\.001 s'
  check 2 opened.vox cover.pshell sideways.csv "${exact[@]}" --sandbox=time=1
fi

# The picture of the worst moment: with meshes, and without.
if [ -x "$bin/voxview" ] && [ -x "$bin/voxcheck-exact" ] && command -v xvfb-run >/dev/null; then
  check 6 opened.vox cover.pshell sideways.csv --clearance 3.2mm "${exact[@]}" --report picture:meshes.png
  check 6 opened.vox cover.pshell through.csv --report picture:voxels.png
  check 0 opened.vox cover.pshell over.csv --report picture:far.png
  python3 - <<'PYTHON'
import struct
for name in ("meshes", "voxels", "far"):
    data = open(name + ".png", "rb").read()
    assert data[1:4] == b"PNG" and struct.unpack(">II", data[16:24]) == (1200, 800), name
    assert len(data) > 8000, (name, len(data))
PYTHON
fi

# Errors: one line, the right status, nothing half-written.
check 2 opened.vox cover.pshell out.csv --allow Nobody
errs "'Nobody' is not an object of the scene"
check 2 opened.vox cover.pshell out.csv --allow Pim
errs 'the nearest names are: Gearbox/Pin'
check 2 opened.vox cover.pshell out.csv --clearance 12
check 2 opened.vox cover.pshell out.csv --seat 0,0,0m --seat-depth 1mm
errs '--seat-depth: has no effect without --exact'
check 2 opened.vox cover.pshell out.csv --clearance 1m
errs '[0-9]+ voxels of this scene, too many to search; .*--voxel-size [0-9.]+mm or more'
check 2 opened.vox cover.pshell out.csv --json out.csv
check 1 opened.vox cover.pshell none.csv
check 2 opened.vox cover.pshell opened.vox
check 4 cover.pshell opened.vox out.csv
"$bin/voxelize" "$data/gearbox.glb" --without Lid --voxel-size 1mm --kind lean -o lean.vox --quiet
check 2 lean.vox cover.pshell out.csv --json lean.json
errs 'stores no distances.*bake the scene without --kind lean'
grep -q '"error"' lean.json && ! grep -q '"verdict"' lean.json || fail "a verdict of a check that was not made"
check 4 lean.vox cover.pshell run.flr
errs 'is not the file that the run was recorded with'

# A failure is reported where hosts look, instead of an earlier verdict, at each stage of a check.
sed 's/^1,0,0,0.1$/1,0,high,0.1/' over.csv >broken.csv
for wrong in "2 opened.vox cover.pshell broken.csv" "4 cover.pshell opened.vox over.csv" "1 opened.vox gone.pshell over.csv" \
  "2 opened.vox cover.pshell over.csv --clearance 12" "2 opened.vox cover.pshell over.csv --nothing" \
  "2 opened.vox cover.pshell over.csv --report csv:none.stl"; do
  read -r status arguments <<<"$wrong"
  rm -f host.*
  for _ in first again; do  # no file is there; a verdict is
    # shellcheck disable=SC2086  # words
    check "$status" $arguments "${hosts[@]}"
    told 0 0 1 "$(sed -n 's/^voxcheck: \([^;]*\).*/\1/p' err.txt | head -c 40 | sed 's/[<>&"].*//')"
    check 0 opened.vox cover.pshell over.csv "${hosts[@]}"
    told 0 0 0 ''
  done
done
# Before the names have been checked nothing else is replaced.
cp over.csv host.xml
echo '{}' >host.quality
check 2 opened.vox cover.pshell over.csv "${hosts[@]}" --nothing
cmp -s over.csv host.xml && grep -qx '{}' host.quality || fail "a wrong command line replaced another file"
check 2 opened.vox cover.pshell over.csv "${hosts[@]}" --report csv:none.stl
cmp -s over.csv host.xml && grep -qx '{}' host.quality || fail "a refused command line replaced another file"
check 2 opened.vox cover.pshell over.csv "${hosts[@]}"
errs 'host\.xml: --report junit: already exists and is not an export that Forcelayer wrote'
cmp -s over.csv host.xml && grep -qx '{}' host.quality || fail "a file that no command wrote was replaced"
rm host.xml host.quality
check 2 opened.vox cover.pshell broken.csv "${hosts[@]}"
told 0 0 1 'broken.csv: line 3'
# On the standard output too, once.
check 2 opened.vox cover.pshell broken.csv --report junit:- --quiet
python3 -c 'import xml.etree.ElementTree as tree; assert tree.parse("out.txt").getroot().get("errors") == "1"' || fail "$(cat out.txt)"
for wrong in "xml:a.xml 'xml' is not a kind of report; known kinds: csv, junit, gitlab, github, picture, animation, map" \
  "csv 'csv' needs a file; write csv:FILE once" "junit: 'junit' needs a file; write junit:FILE once" \
  "github:a.txt 'github' takes no file, because this report is printed; write github alone"; do
  check 2 opened.vox cover.pshell out.csv --report "${wrong%% *}"
  errs "^voxcheck: --report: ${wrong#* }\$"
done
check 2 opened.vox cover.pshell out.csv --report csv:a.csv --report csv:b.csv
errs "^voxcheck: --report: 'csv' is given more than once"
check 2 opened.vox cover.pshell out.csv --junit a.xml
errs '^voxcheck: --junit: is an option of an earlier version; write --report junit:FILE$'
check 2 opened.vox cover.pshell out.csv --seat 0,0,0m --seat 0,0,1m
errs '^voxcheck: --seat: is given more than once; see voxcheck --help$'
echo "all good"
