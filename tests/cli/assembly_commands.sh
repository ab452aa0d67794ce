#!/usr/bin/env bash
# The six commands of the tutorial for a part of an assembly, as they stand there; then three parts of the sample
# assembly: one comes out, one is held by others, one comes out with what is fixed to it.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
ln -s "$data" sample_data
PATH=$bin:$PATH

sed -n '/^## 5[.]/,/^## 6[.]/p' "$FORCELAYER_SOURCE_DIR/docs/tutorial.md" | grep '^    ' >commands
[ "$(wc -l <commands)" = 6 ] || fail "not six commands: $(cat commands)"
grep '^    vox\(elize\|run\|check\)\|^    pointshell' commands | sed 's/ *#[^"'"'"']*$//; s/voxrun .*/& --as-fast-as-possible/' >offline.sh
[ "$(wc -l <offline.sh)" = 5 ] || fail "not five commands but voxview: $(cat offline.sh)"
bash -e offline.sh >out 2>err || fail "the commands of the tutorial: $(cat err)"
grep -q " Gearbox/Pin$" out || fail "the list has no pin: $(cat out)"
grep -qE "^seated on .*Housing.* until [0-9.]+ s; then least proven clearance [0-9.]+ mm to " out ||
  fail "no answer for the pin: $(tail -3 out)"
if [ -x "$bin/voxview" ] && command -v xvfb-run >/dev/null; then
  view=$(grep '^    voxview' commands | sed 's/ *#.*$//')
  # How near does it come to what? The picture shows the moment that voxrun names, and what it says of it.
  $view --screenshot view.png --size 320x240 --json view.json 2>err || fail "voxview: $(cat err)"
  sed -n 's/^seated on .*least proven clearance \([0-9.]*\) mm to \(.*\) at \([0-9.]*\) s.*/\1 \2 \3/p' out >answer
  python3 -c '
import json
shown = json.load(open("view.json"))["moment"]
clearance_mm, name, t_s = open("answer").read().split()
assert shown["name"] == "the least proven clearance" and abs(shown["t_s"] - float(t_s)) < 0.0006, (shown, t_s)
for told_m in shown["clearance"]["clearance_m"], shown["clearance_m"]:
    assert abs(1e3 * told_m - float(clearance_mm)) < 0.002, (shown, clearance_mm)
assert shown["nearest_object"] == shown["clearance"]["object"] and shown["nearest_object"].endswith("/" + name), (shown, name)' || fail "voxview shows another moment: $(cat answer)"
  # A picture in the seat shows the contacts that the run felt there.
  seated=$(python3 -c '
import csv
rows = [row for row in csv.DictReader(open("pull.csv")) if row["clearance_m"] == ""]
print(max(rows, key=lambda row: abs(float(row["force_z_n"])))["t_s"])')
  $view --at "${seated}s" --screenshot view.png --size 320x240 --json view.json 2>err || fail "voxview: $(cat err)"
  python3 -c '
import csv, json
shown = json.load(open("view.json"))["moment"]
assert "seated_on" in shown, shown
run = next(row for row in csv.DictReader(open("pull.csv")) if abs(float(row["t_s"]) - shown["t_s"]) < 1e-9)
assert shown["kind"] != "PENETRATION" and shown["points_surface"] > 100, shown
for key in "points_surface", "points_proximity", "points_interior", "contacts":
    assert abs(shown[key] - int(run[key])) <= 2, (key, shown, run[key])' || fail "voxview shows other contacts than the run's"
  # Where it is installed, without a run: seated there as a run's start is, and at rest. Beside it, on nothing.
  voxrun rest.vox pin.pshell --pull 0,0,1mm --as-fast-as-possible --json seat.json >out 2>err || fail "voxrun: $(cat err)"
  for height in 0m 0.5m; do
    voxview rest.vox pin.pshell --part-pose 0,0,$height --screenshot view.png --size 320x240 --json view_$height.json 2>err ||
      fail "voxview: $(cat err)"
  done
  python3 -c '
import json
shown, beside = (json.load(open(f"view_{height}.json"))["moment"] for height in ("0m", "0.5m"))
seat = [one["object"].removesuffix("[1]") for one in json.load(open("seat.json"))["seat"]]
assert shown["kind"] == "in the force layer, no contact" and shown["points_interior"] == shown["contacts"] == 0, shown
assert len(seat) > 0 and shown["seated_on"] == seat, (shown, seat)
assert "seated_on" not in beside and beside["clearance_m"] > 0, beside' || fail "voxview does not seat an installed part"
fi

answer() {  # answer PART: the end of its run, straight up
  voxelize sample_data/gearbox.glb --without "$1" --voxel-size 1mm -o rest.vox --quiet &&
    pointshell "sample_data/gearbox.glb#$1" --voxel-size 1mm -o part.pshell --quiet --method fast &&
    voxrun rest.vox part.pshell --pull 0,0,60mm --as-fast-as-possible --json run.json >out 2>err || fail "$1: $(cat err)"
  tail -3 out
}
answer Pin >pin
grep -q "^touched nothing$" pin || grep -q "^touched " pin || fail "what the pin touched: $(cat pin)"
answer Cover >cover
grep -q "^touched .*Bolt" cover || fail "the bolts do not hold the cover: $(cat cover)"
grep -qE "^Does not come out: the hand pulled 60 mm, the part moved 0\.[0-9]+ mm; blocked by Bolt" cover || fail "the sentence of the cover: $(cat cover)"
grep -q "^Comes out: the part leaves Housing, " pin || fail "the sentence of the pin: $(cat pin)"
grep -q "the part did not leave its seat on " cover || fail "the cover came out through its bolts: $(cat cover)"
python3 -c '
import json
names = {t["name"] for t in json.load(open("run.json"))["touched_objects"]}
assert {"Gearbox/Lid/Bolt[1]", "Gearbox/Lid/Bolt[2]", "Gearbox/Lid/Bolt[4]"} <= names, names' || fail "not by name: $(cat cover)"
answer Lid >lid
grep -qE "^seated on Housing until [0-9.]+ s; then least proven clearance [0-9.]+ mm to Housing" lid ||
  fail "the lid, with its bolts: $(cat lid)"

refuses() {  # refuses TEXT ARGUMENTS...
  voxrun rest.vox part.pshell "${@:2}" >out 2>err
  [ $? = 2 ] && [ "$(wc -l <err)" = 1 ] && grep -qF -- "$1" err || fail "no '$1': ${*:2}: $(cat err)"
}
refuses "--pull: length '5' has no unit" --pull 0,0,5
refuses "--pull: is only for the sim device without --motion" --pull 0,0,5mm --motion sample_data/lift.csv
refuses "--pull: must be longer than zero" --pull 0,0,0m  # from which nothing could come out
refuses "--pull: must be longer than zero" --pull 0,0,1e9m
finish
