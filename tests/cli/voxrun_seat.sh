#!/usr/bin/env bash
# A part that starts installed: the report of its seat, names of objects, the verdict line, --fail-on.
set -euo pipefail
bin=$FORCELAYER_BIN_DIR
gearbox=$FORCELAYER_SOURCE_DIR/sample_data/gearbox.glb
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

fail() { echo "FAILED: $*" >&2; exit 1; }

# run STATUS ARGUMENTS...: that exit status; what was said is in out.txt and err.txt.
run() {
  local wanted=$1 status=0
  shift
  "$bin/voxrun" "$@" --device sim --as-fast-as-possible >out.txt 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || { cat out.txt err.txt; fail "status $status instead of $wanted: $*"; }
  [ "$wanted" -eq 0 ] || [ "$(grep -vc "warning: " err.txt)" -eq 1 ] || { cat err.txt; fail "not one line on stderr: $*"; }
}
says() { tail -n 1 out.txt | grep -qE -e "$1" || { cat out.txt; fail "the verdict is not '$1'"; }; }
errs() { grep -qE -e "$1" err.txt || { cat err.txt; fail "no '$1' on stderr"; }; }

# The cover's way: straight up; up and pressed down again; and pushed to the side where it lies.
python3 - <<'PYTHON'
def write(name, way):
    with open(name, "w") as file:
        file.write("t_s,x_m,y_m,z_m,qw,qx,qy,qz\n")
        for i in range(101):
            x_m, z_m = way(0.01 * i)
            file.write(f"{0.01 * i:.2f},{x_m:.6f},0,{z_m:.6f},1,0,0,0\n")
write("out.csv", lambda t: (0, 0.03 * max(0, t - 0.2)))
write("back.csv", lambda t: (0, 0.02 * t if t < 0.5 else 0.01 - 0.05 * (t - 0.5)))
write("rest.csv", lambda t: (0, 0))
PYTHON

"$bin/voxelize" "$gearbox" --without Cover --voxel-size 1mm -o bolted.vox --quiet
"$bin/voxelize" "$gearbox" --without Lid --voxel-size 1mm -o opened.vox --quiet
"$bin/pointshell" "$gearbox#Cover" --voxel-size 1mm -o cover.pshell --quiet

# It comes out, and every question is answered well.
run 0 opened.vox cover.pshell --motion out.csv --json run.json --trace run.csv --fail-on penetration \
  --fail-on contact --fail-on outside --fail-on seat
grep -q '^the part is seated on Gearbox/Housing$' out.txt || { cat out.txt; fail "no seat at the start"; }
grep -q '^guaranteed separation, once the part has left its seat: [0-9.]* mm' out.txt || fail "no guarantee"
says '^seated on Gearbox/Housing until 0\.[0-9]{3} s; then clear: least proven clearance [0-9.]+ mm to Gearbox/Housing at 0\.[0-9]{3} s, .*; 0 penetration frames$'
python3 - <<'PYTHON'
import csv, json
run, rows = json.load(open("run.json")), list(csv.DictReader(open("run.csv")))
assert run["verdict"] == "clear" and run["penetration_frames"] == 0, run["verdict"]
assert 0.2 < run["guarantee_from_s"] < 0.5, run["guarantee_from_s"]
assert run["seated_frames"] == round(1000 * run["guarantee_from_s"]), run["seated_frames"]
[seat] = run["seat"]
assert seat["object"] == "Gearbox/Housing" and seat["points"] > 100 and abs(seat["overlap_m"]) < 1e-4, seat
least = run["least_clearance"]
assert least["object"] == "Gearbox/Housing" and least["t_s"] >= run["guarantee_from_s"], least
assert least["clearance_m"] > run["guaranteed_separation_m"] > 0, least
assert list(rows[0])[-1] == "nearest_object" and len(rows) == run["frames"]
# A name wherever a clearance is measured, none in the seat.
seated = rows[:run["seated_frames"]]
assert all(r["clearance_m"] == "" and r["nearest_object"] == "" for r in seated)
named = [r for r in rows if r["nearest_object"]]
assert named and {r["nearest_object"] for r in named} == {"Gearbox/Housing"}
assert float(named[0]["clearance_m"]) > 0
PYTHON

# Bolted, it stays, and the bolts hold it.
run 0 bolted.vox cover.pshell --motion out.csv --json run.json
says '^seated on Gearbox/Housing, Gearbox/Lid/Bolt, .* and 1 more to the end: it has not left its seat, and no separation is guaranteed; .*0 penetration frames$'
grep -q '^touched Gearbox/.*Bolt.* ([0-9.]* s, up to [0-9.]* N)' out.txt || { cat out.txt; fail "nothing touched"; }
python3 - <<'PYTHON'
import json
run = json.load(open("run.json"))
assert run["verdict"] == "seated" and run["guarantee_from_s"] is None and run["least_clearance"] is None
assert run["seated_frames"] == run["unproven_frames"] == run["frames"] > 900
assert len(run["seat"]) == 5
touched = run["touched_objects"]
assert 0 < len([t for t in touched if "Bolt" in t["name"]]), touched
forces = [t["max_force_n"] for t in touched]
assert forces == sorted(forces, reverse=True) and forces[0] > 1, touched
assert all(0 < t["seconds"] <= run["frames"] / 1000 for t in touched), touched
PYTHON
run 6 bolted.vox cover.pshell --motion out.csv --fail-on penetration --fail-on seat --quiet
errs 'cover.pshell: at the end: the part has not left its seat on Gearbox/Housing, '
[ ! -s out.txt ] || fail "--quiet is not"
# Contact with the objects of the seat is none, while it is open.
run 0 bolted.vox cover.pshell --motion out.csv --fail-on contact --fail-on penetration,outside

# Out and pressed down again: it touches what was its seat.
run 0 opened.vox cover.pshell --motion back.csv --json run.json
says '^seated on Gearbox/Housing until .* s; then clear: '
python3 - <<'PYTHON'
import json
run = json.load(open("run.json"))
[touched] = run["touched_objects"]
assert touched["name"] == "Gearbox/Housing" and touched["max_force_n"] > 1, touched
assert run["least_clearance"]["clearance_m"] >= run["guaranteed_separation_m"] - 1e-9, run["least_clearance"]
PYTHON
run 6 opened.vox cover.pshell --motion back.csv --fail-on contact --fail-on penetration
errs 'cover.pshell: at 0\.[0-9]{3} s: the part touched the scene; --trace shows every frame$'

# The model of 1999 has no seat and no guard: it starts in a penetration, and says so.
run 0 opened.vox cover.pshell --motion rest.csv --model paper --json run.json
says '^NOT clear: [0-9]+ penetration frames?, the first at 0\.[0-9]{3} s'
python3 - <<'PYTHON'
import json
run = json.load(open("run.json"))
assert run["verdict"] == "not clear" and run["seat"] == [] and run["seated_frames"] == 0
assert run["guarantee_from_s"] == 0 and run["touched_objects"] == []
PYTHON
run 6 opened.vox cover.pshell --motion rest.csv --model paper --fail-on penetration --fail-on seat
errs 'cover.pshell: at 0\.[0-9]{3} s: the part penetrated the scene'

# Beyond a cropped side nothing is known.
"$bin/voxelize" "$gearbox" --without Lid --voxel-size 1mm --roi=-1m,-1m,-1m,1m,1m,45mm -o cropped.vox --quiet
run 0 cropped.vox cover.pshell --motion out.csv --json run.json
says 'not known to be clear: [0-9]+ frames? beyond a cropped side of the scene, the first at 0\.[0-9]{3} s; '
grep -q '"verdict": "unknown"' run.json || fail "a verdict on what is not known"
run 6 cropped.vox cover.pshell --motion out.csv --fail-on outside
errs 'cover.pshell: at 0\.[0-9]{3} s: the part went beyond a cropped side of the scene'

# A scene without names.
"$bin/voxelize" "$gearbox" --without Lid --voxel-size 1mm --lean -o lean.vox --quiet
run 0 lean.vox cover.pshell --motion out.csv --start 0,0,30mm --json run.json --trace run.csv
says '^clear: no clearance is known; 0 penetration frames$'
[ "$(tail -n 1 run.csv | grep -c ',$')" = 1 ] || fail "a name in a scene without"

run 2 opened.vox cover.pshell --motion out.csv --fail-on quark
errs "'quark' is nothing that a run is checked for"
echo "all passed"
