#!/usr/bin/env bash
# The scene changes while the loop runs: at a time, at a signal to a new file by the same name, and not at all where the
# new one is unusable. No frame is lost, the part stays where it is, and what is taken away no longer holds it.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
source "$FORCELAYER_SOURCE_DIR/tests/support/in_time.sh"

# A plate below z = 0, a post beside it, a block around where the part is held, and the part, a cube of 20 mm.
python3 - <<'PYTHON' || exit 1
FACES = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"]
def box(name, low, high):
    with open(name, "w") as f:
        for k in range(8):
            f.write("v %g %g %g\n" % tuple(high[d] if k >> d & 1 else low[d] for d in range(3)))
        f.writelines("f " + face + "\n" for face in FACES)
box("plate.obj", (-60, -60, -10), (60, 60, 0))
box("post.obj", (80, -10, -60), (100, 10, 60))
box("block.obj", (-50, -50, -50), (50, 50, 50))
box("part.obj", (-10, -10, -10), (10, 10, 10))
# Down onto the plate, 3 mm into it by the hand; and 40 mm further later on.
rows = [(0, 40), (0.3, 7), (1.4, 7), (1.8, -33), (2, -33)]
with open("press.csv", "w") as f:
    f.write("t_s,x_m,y_m,z_m,qw,qx,qy,qz\n")
    f.writelines(f"{t},0,0,{z / 1000},1,0,0,0\n" for t, z in rows)
PYTHON
scene() { "$bin/voxelize" "${@:2}" --units mm --voxel-size 2mm -o "$1.vox" --quiet || fail "bake $1"; }
scene plate plate.obj post.obj
scene open post.obj
scene buried block.obj post.obj
cp plate.vox first.vox
"$bin/pointshell" part.obj --units mm --voxel-size 2mm -o part.pshell --quiet || fail "the part"
run=("$bin/voxrun" first.vox part.pshell --motion press.csv --duration 2s --after-trip rearm)

# check REPORT SCENES: every frame is there, and the part went through the plate only once that was gone.
check() {
  python3 - "$@" 2>>err <<'PYTHON'
import csv, json, sys
report = json.load(open(sys.argv[1] + ".json"))
rows = [{k: v if k == "nearest_object" else float(v or "nan") for k, v in row.items()}
        for row in csv.DictReader(open(sys.argv[1] + ".csv"))]
scenes = report["scenes"]
late = report["skipped_ticks"] or report["dropped_frames"] or any(s["from_s"] > 1.3 for s in scenes)
assert not late, "held up: the loop, or the reading of the next scene"
assert [s["scene"] for s in scenes] == sys.argv[2:], scenes
assert len(rows) == report["frames"] == 2000 and report["dropped_frames"] == 0, report["frames"]
assert all(abs(b["t_s"] - a["t_s"] - 0.001) < 1e-9 for a, b in zip(rows, rows[1:])), "a frame is missing"
z = [row["part_z_m"] for row in rows]
assert max(abs(b - a) for a, b in zip(z, z[1:])) < 1e-3, "the part jumped"
assert report["penetration_frames"] == 0
i = round(scenes[1]["from_s"] * 1000)
assert 400 <= i < 1400, i
assert min(z[:i]) > 0.0105, "the plate did not hold the part"
assert abs(z[i] - z[i - 1]) < 1e-9 and abs(z[i + 1] - z[i]) < 5e-4, "the part was torn"
for row in rows[i - 1:i + 1]:
    assert all(row[f"device_force_{axis}_n"] == 0 for axis in "xyz"), "a force while the scene was changed"
assert z[-1] < -0.015, "the part did not go on after the change"
assert report["touched_objects"][0]["name"] == "plate", report["touched_objects"]
near = {row["nearest_object"] for row in rows[i + 1:]}
assert "plate" not in near and "plate" in {row["nearest_object"] for row in rows[:i]}, near
assert scenes[0]["from_s"] == 0 and all(s["guaranteed_separation_m"] > 0 for s in scenes), scenes
PYTHON
}
at_a_time() {
  "${run[@]}" --scene-next open.vox@0.6s --json timed.json --trace timed.csv >out 2>err || return 1
  grep -qE "^voxrun: at [01]\.[0-9]+ s: the scene is now open.vox; guaranteed separation: [0-9.]+ mm" err || return 1
  check timed first.vox open.vox
}
in_time err at_a_time || fail "at a time: $(cat err)"

# A new file by the same name, which the run reads on request; and one that is not there. The files are watched
# all the time: a file that is replaced, by a rename, is another one.
at_a_signal() {
  local running wait
  cp plate.vox old.vox && mv old.vox first.vox
  rm -f asked.json asked.csv  # of a try before, rewritten below
  "${run[@]}" --json asked.json --trace asked.csv >out 2>err &
  running=$!
  for wait in $(seq 200); do [ -s out ] && break; sleep 0.05; done
  sleep 0.6
  cp open.vox next.vox && mv next.vox first.vox
  for wait in $(seq 100); do
    kill -USR1 $running 2>/dev/null
    grep -q "the scene is now" err && break
    sleep 0.05
  done
  wait $running || return 1
  python3 - 2>>err <<'PYTHON' || return 1
import json
report = json.load(open("asked.json"))
assert len(report["scenes"]) >= 2 and {s["scene"] for s in report["scenes"]} == {"first.vox"}, report["scenes"]
json.dump({**report, "scenes": report["scenes"][:2]}, open("asked.json", "w"))
PYTHON
  check asked first.vox first.vox
}
in_time err at_a_signal || fail "at a signal: $(cat err)"

# A scene that is not there is found before the run begins.
"$bin/voxrun" first.vox part.pshell --motion press.csv --scene-next missing.vox@0.1s --json missing.json >out 2>err
[ $? = 1 ] && [ ! -s out ] && grep -q "^voxrun: missing.vox: no such file" err || fail "a missing scene: $(cat out err)"

# One that is gone later, or cannot be used, changes nothing, and the run ends with its error. A part in the middle of a
# solid has no side to be on.
stays() {
  local running wait
  cp open.vox gone.vox
  "$bin/voxrun" first.vox part.pshell --motion press.csv --duration 1.2s --after-trip rearm --scene-next gone.vox@0.6s \
    --scene-next buried.vox@0.8s --json stays.json >out 2>err &
  running=$!
  for wait in $(seq 200); do [ -s out ] && break; sleep 0.05; done
  rm gone.vox
  wait $running
  [ $? = 1 ] || return 1
  grep -qE "^voxrun: at [01]\.[0-9]+ s: the scene is not replaced: gone.vox: " err || return 1
  [ "$(grep -c "^voxrun: at [01]\.[0-9]* s: the scene is not replaced: " err)" = 2 ] || return 1
  tail -n 1 err | grep -q "^voxrun: gone.vox: no such file" || return 1
  tail -n 1 out | grep -q "^a scene of --scene-next was never used; " || return 1
  python3 -c 'import json; r = json.load(open("stays.json")); assert len(r["scenes"]) == 1 and r["verdict"] == "unknown", r' 2>>err
}
cp plate.vox first.vox
in_time err stays || fail "it stays: $(cat err)"

# By a button of a device. The hand rests on the plate, with motors that push it back, until the button takes the plate
# away; then nothing pushes.
by_button() {
  local motors wait
  motors=$(mktemp -u motors.XXXXXX)  # the device of a try before this one may still write
  "$bin/voxrun" first.vox part.pshell --world-from-device 0,0,35mm --duration 2s \
    --device "plugin:library=$bin/fault_plugin.so,args=log=$motors fault=button at=0.3,scene=1" \
    --scene-next open.vox --json button.json >out 2>err || {
    grep -q "the part starts" err && echo "held up: the hand, which has a clock of its own, was there before" >>err
    return 1
  }
  for wait in $(seq 200); do [ -e $motors ] && break; sleep 0.1; done
  python3 - $motors 2>>err <<'PYTHON'
import csv, json, sys
scenes = json.load(open("button.json"))["scenes"]
assert [s["scene"] for s in scenes] == ["first.vox", "open.vox"], scenes
rows = [tuple(map(float, row)) for row in csv.reader(open(sys.argv[1]))]
pressed_s = next((t for t, force, pressed, stays in rows if pressed), 0)
before = [force for t, force, *_ in rows if pressed_s - 0.2 < t < pressed_s]
after = [force for t, force, *_ in rows if t > pressed_s + 0.7]
assert min(before, default=0) > 0.3, f"held up: the plate did not push: {before}"
assert after, "held up: nothing after the button"
assert max(map(abs, after)) < 0.05, "the plate is gone, and something pushes"
PYTHON
}
if ! grep -q '^CMAKE_CXX_FLAGS:.*-fsanitize' "$FORCELAYER_BUILD_DIR/CMakeCache.txt"; then
  in_time err by_button || fail "by a button: $(cat err)"
fi

"$bin/voxrun" first.vox part.pshell --motion press.csv --duration 0.1s --scene-next open.vox@0.1s >out 2>err ||
  fail "a scene for later: $(cat err)"
grep -q '^voxrun: warning: --scene-next: open.vox: the run ends before the time of this scene$' err || fail "no warning: $(cat err)"

refuses() {  # refuses TEXT ARGUMENTS...
  "$bin/voxrun" first.vox part.pshell --motion press.csv "${@:2}" >out 2>err
  [ $? = 2 ] && [ "$(wc -l <err)" = 1 ] && grep -qF -- "$1" err || fail "no '$1': ${*:2}: $(cat err)"
}
refuses "--scene-next: needs real time" --scene-next open.vox --as-fast-as-possible
refuses "--scene-next: cannot be recorded or replayed" --scene-next open.vox --record run.flr
refuses "--scene-next: 'open.vox@1s' has an earlier time than the previous scene" --scene-next plate.vox@2s --scene-next open.vox@1s
refuses "--device scene: needs real time" --device hid:scene=1 --as-fast-as-possible
refuses "--json: is an input of this command" --scene-next open.vox --json open.vox
# A recording on another bake: the same hand, which the plate no longer holds; not where it begins in metal.
replay() { "$bin/voxrun" "$1.vox" part.pshell --replay "$2" --as-fast-as-possible "${@:3}" >out 2>err; }
"$bin/voxrun" plate.vox part.pshell --motion press.csv --duration 2s --as-fast-as-possible --record pressed.flr \
  --trace pressed.csv --json pressed.json --quiet || fail "the run that is recorded"
replay open pressed.flr && fail "a recording on another scene, not for its inputs alone"
replay plate inputs:pressed.flr --json again.json || fail "on its own scene: $(cat err)"
replay open inputs:pressed.flr --json opened.json --trace opened.csv --save-path opened_path.csv || fail "on another: $(cat err)"
grep -q 'warning: --replay: only the inputs of pressed.flr are used' err || fail "not said: $(cat err)"
replay buried inputs:pressed.flr && fail "a start in metal"
[ "$(wc -l <err)" = 1 ] || fail "$(cat err)"
python3 - <<'PYTHON' || fail "the replays"
import csv, json
pressed, again, opened = (json.load(open(name + ".json")) for name in ("pressed", "again", "opened"))
assert again["outcome_hash"] == pressed["outcome_hash"] != opened["outcome_hash"]
assert any("--replay: only the inputs" in warning for warning in opened["warnings"])
before, after = (list(csv.DictReader(open(name + ".csv"))) for name in ("pressed", "opened"))
keys = [key for key in before[0] if key == "t_s" or key.startswith("handle_")]
assert len(before) == len(after) == 2000 and all(a[k] == b[k] for a, b in zip(before, after) for k in keys)
assert min(float(row["part_z_m"]) for row in before) > 0.0105 and float(after[-1]["part_z_m"]) < -0.02
assert len(open("opened_path.csv").readlines()) > 100
PYTHON
finish
