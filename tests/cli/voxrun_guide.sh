#!/usr/bin/env bash
# voxrun --guide: a way that voxplan found leads a loose hand, weakly, within its limits; a device's button switches it
# off; a run with it replays; its errors.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
source "$FORCELAYER_SOURCE_DIR/tests/support/in_time.sh"
gearbox=$data/gearbox.glb
"$bin/voxelize" "$gearbox" --without Pin --voxel-size 1mm -o rest.vox --quiet
"$bin/pointshell" "$gearbox#Pin" --voxel-size 1mm -o pin.pshell --quiet
"$bin/voxplan" rest.vox pin.pshell --clearance 1mm -o way.csv --quiet || fail "no way"
# run NAME ARGUMENTS...: a loose hand that wants to stay where the pin is
run() {
  "$bin/voxrun" rest.vox pin.pshell --device sim:hand=loose --duration 4s --as-fast-as-possible --quiet --json "$1.json" \
    --trace "$1.csv" "${@:2}" 2>err || fail "$*: status $?: $(cat err)"
}
run alone
run led --guide way.csv --record led.flr
run strong --guide way.csv --set guide_force_n=1
run capped --guide way.csv --set guide_force_n=1,max_force_n=0.2
python3 - <<'END' || fail "the guide"
import csv, json
def of(name):
    return json.load(open(name + ".json")), list(csv.DictReader(open(name + ".csv")))
def height(rows): return float(rows[-1]["handle_z_m"])
def most(rows): return max(abs(float(row["device_force_z_n"])) for row in rows)
report, rows = of("alone")
assert report["guided_frames"] == 0 == report["max_guide_force_n"] == report["guide_given_j"]
assert height(rows) == 0 == most(rows)
led, rows = of("led")
assert led["guided_frames"] > 3900 and abs(led["max_guide_force_n"] - 0.3) < 1e-9, led["max_guide_force_n"]
assert 0.004 < height(rows) < 0.007, height(rows)  # 0.3 N against the hand's own hold
assert most(rows) <= 0.31
assert 0 < led["guide_given_j"] < led["guide_allowed_j"] < 0.05
assert led["energy_generated_j"] < 2e-4
# It comes in over a second, and gives way by as much as the seat pushes back.
pulls = [float(row["device_force_z_n"]) - float(row["force_z_n"]) for row in rows if row["output"] == "1"][250:]
assert max(abs(b - a) for a, b in zip(pulls, pulls[1:])) < 0.03
strong, rows = of("strong")
assert height(rows) > 0.012 and abs(strong["max_guide_force_n"] - 1) < 1e-9, (height(rows), strong["max_guide_force_n"])
capped, rows = of("capped")
assert most(rows) <= 0.2 and capped["max_guide_force_n"] <= 0.2, most(rows)
END

# A replay with the same guide gives the motors the same, and the outcome is compared as ever.
"$bin/voxrun" rest.vox pin.pshell --replay led.flr --guide way.csv --as-fast-as-possible --quiet \
  --trace again.csv 2>err || fail "the replay: $(cat err)"
python3 - <<'END' || fail "the replay differs"
import csv
def forces(name): return [row["device_force_z_n"] for row in csv.DictReader(open(name))]
assert forces("led.csv") == forces("again.csv")
END

# The text at the end says it, where there is one.
"$bin/voxrun" rest.vox pin.pshell --device sim:hand=loose --duration 1s --as-fast-as-possible --guide way.csv >out || fail "status $?"
grep -qE '^guided in [0-9]+ frames by up to 0\.[0-9]+ N; the guide gave the hand [0-9.e-]+ J of the allowed [0-9.e-]+ J$' out || fail "$(cat out)"

# A button of a device: it pulls upward until the button is pressed, and not from then on.
by_button() {
  local motors wait
  motors=$(mktemp -u motors.XXXXXX)  # the device of a try before this one may still write
  printf '%s\n' t_s,x_m,y_m,z_m 0,0,0,0 1,0,0,0.1 >up.csv
  "$bin/voxrun" rest.vox pin.pshell --start 0,0,0.2m --guide up.csv --set guide_force_n=1 \
    --device "plugin:library=$bin/fault_plugin.so,args=log=$motors below fault=button at=1.7,guide=1,clutch=5" \
    --duration 3s --json button.json >out 2>err || return 1
  for wait in $(seq 200); do [ -e $motors ] && break; sleep 0.1; done
  python3 - $motors 2>>err <<'PYTHON'
import csv, sys
rows = [tuple(map(float, row)) for row in csv.reader(open(sys.argv[1]))]
pressed_s = next((t for t, force, pressed, stays in rows if pressed), 0)
before = [abs(force) for t, force, *_ in rows if pressed_s - 0.2 < t < pressed_s]
after = [abs(force) for t, force, *_ in rows if t > pressed_s + 0.1]
assert min(before, default=0) > 0.3, f"held up: the guide did not pull: {before}"
assert after, "held up: nothing after the button"
assert max(after) == 0, f"it is off, and something pulls: {max(after)}"
PYTHON
}
if ! grep -q '^CMAKE_CXX_FLAGS:.*-fsanitize' "$FORCELAYER_BUILD_DIR/CMakeCache.txt"; then
  in_time err by_button || fail "by a button: $(cat err)"
fi

refuses() {  # refuses STATUS TEXT ARGUMENTS...
  "$bin/voxrun" rest.vox pin.pshell --duration 1s "${@:3}" >out 2>err
  [ $? = "$1" ] && [ "$(wc -l <err)" = 1 ] && grep -qF -- "$2" err || fail "no '$2': ${*:3}: $(cat err)"
}
printf '%s\n' t_s,x_m,y_m,z_m 1,0,0,0 0,0,0,1 >back.csv
refuses 1 "none.csv" --guide none.csv
refuses 2 "back.csv" --guide back.csv
refuses 2 "--set guide_force_n" --guide way.csv --set guide_force_n=1.1
refuses 2 "--set guide_force_n: has no effect without --guide" --set guide_force_n=0.5
refuses 2 "--device guide: has no effect without --guide" --device hid:guide=1
refuses 2 "--json: is an input of this command" --guide way.csv --json way.csv
finish
