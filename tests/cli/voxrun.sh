#!/usr/bin/env bash
# voxrun as a user meets it: runs, files, exit statuses, one line per error.
set -euo pipefail
bin=$FORCELAYER_BIN_DIR
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
"$bin/make_runtime_files" .

fail() { echo "FAILED: $*" >&2; exit 1; }

# expect STATUS PATTERN ARGUMENTS...: that exit status, and one line on stderr that matches.
expect() {
  local wanted=$1 pattern=$2 status=0
  shift 2
  "$bin/voxrun" "$@" >out.txt 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || { cat err.txt; fail "status $status instead of $wanted: $*"; }
  if [ "$wanted" -ne 0 ]; then
    [ "$(wc -l <err.txt)" -eq 1 ] || { cat err.txt; fail "not one line on stderr: $*"; }
  fi
  grep -qE -e "$pattern" err.txt out.txt || { cat out.txt err.txt; fail "no '$pattern': $*"; }
}

fast=(--motion press.csv --as-fast-as-possible)
expect 0 'guaranteed separation: [0-9.]+ mm' floor.vox ball.pshell "${fast[@]}" \
  --json run.json --trace run.csv --record run.flr
expect 0 'penetrating [0-9]+ \(([0-9.e-]+|none) of the force-layer frames\)' floor.vox ball.pshell --replay run.flr --as-fast-as-possible --threads 2 \
  --json again.json --trace again.csv
# The memory of the scene is one number.
grep -qE '^scene in memory [0-9.]+ MiB$' out.txt || { cat out.txt; fail "the memory of the scene"; }

python3 - <<'PYTHON'
import csv, json, math, os
run, again = json.load(open("run.json")), json.load(open("again.json"))
for key in """model frames force_layer_frames penetration_frames penetration_ratio guard_cuts
outside_map_frames saturated_frames guaranteed_separation_m guaranteed_swept_separation_m step_ns
deadline_misses max_force_n max_torque_nm energy_generated_j parameters verdict seated_frames
guarantee_from_s seat min_clearance touched_objects""".split():
    assert key in run, key
assert all(k in run["step_ns"] for k in ("p50", "p99", "p999", "max"))
assert run["frames"] == 700 and run["force_layer_frames"] > 100, run["frames"]
assert run["outcome_hash"] == again["outcome_hash"]
assert 0 < run["scene_file_bytes"] == os.path.getsize("floor.vox") < run["peak_rss_bytes"], run["scene_file_bytes"]
device = run["device_capabilities"]
assert device["name"] == "sim" and device["max_force_n"] == 15 and device["max_torque_nm"] == 0.1
assert device["sensed_axes"] == device["actuated_axes"] == ["x", "y", "z", "rot_x", "rot_y", "rot_z"]
assert device["damping_ns_per_m"] > 0 and device["workspace_radius_m"] is None
assert again["device_capabilities"] is None
rho, e_pose = math.sqrt(3) / 2 * 0.005, run["pose_error_m"]
assert abs(run["guaranteed_separation_m"] - (0.005 - 0.866 * 0.005 - e_pose)) < 1e-12
rows, again_rows = list(csv.DictReader(open("run.csv"))), list(csv.DictReader(open("again.csv")))
header = """t_s handle_x_m handle_y_m handle_z_m handle_qw handle_qx handle_qy handle_qz part_x_m
part_y_m part_z_m part_qw part_qx part_qy part_qz force_x_n force_y_n force_z_n torque_x_nm
torque_y_nm torque_z_nm points_proximity points_surface points_interior contacts depth_m
guard_cuts step_ns device_force_x_n device_force_y_n device_force_z_n device_torque_x_nm device_torque_y_nm
device_torque_z_nm clearance_m clearance_at_least output nearest_object""".split()
assert list(rows[0]) == header
for a, b in zip(rows, again_rows, strict=True):
    assert all(a[k] == b[k] for k in header if k != "step_ns"), (a, b)
for r in rows:  # the floor's force layer is one voxel deep
    assert (int(r["contacts"]) > 0) == (0 < float(r["depth_m"]) <= 0.005), r
touching = [r for r in rows if int(r["points_surface"]) + int(r["points_interior"]) > 0]
assert len(touching) == run["force_layer_frames"]
free = [r for r in rows if all(int(r["points_" + k]) == 0
                               for k in ("proximity", "surface", "interior"))]
assert free and all(float(r["force_z_n"]) == 0 and float(r["torque_x_nm"]) == 0 for r in free)
assert max(float(r["force_z_n"]) for r in touching) > 0.5  # the slab pushes the hand up
assert abs(float(rows[0]["part_z_m"]) - 0.06) < 0.001 and rows[0]["t_s"] == "0"
PYTHON

# Where the part begins: at its place, else where the grip has it; with both, the hand pulls it from
# the one to the other.
part_goes() { python3 -c 'import csv, sys; rows = list(csv.DictReader(open("still_run.csv")))
for row, z in zip((rows[0], rows[-1]), map(float, sys.argv[1:])):
    assert abs(float(row["part_z_m"]) - z) < 2.5e-3, (row, z)  # pulled by half a voxel in a frame' "$@"; }
printf 't_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0.1,0.1,0.1,1,0,0,0\n1,0.1,0.1,0.1,1,0,0,0\n' >still.csv
still=(--device sim --motion still.csv --as-fast-as-possible --trace still_run.csv)
expect 0 'frames' floor.vox ball.pshell "${still[@]}" && part_goes 0.1 0.1
expect 0 'frames' floor.vox ball.pshell "${still[@]}" --grip 0,0,20mm && part_goes 0.12 0.12
expect 0 'frames' floor.vox ball.pshell "${still[@]}" --start 0.1m,0.1m,0.15m && part_goes 0.15 0.15
expect 0 'frames' floor.vox ball.pshell "${still[@]}" --start 0.1m,0.1m,0.15m --grip 0,0,20mm &&
  part_goes 0.15 0.12

# A hand that feels the loop gives way, where one that feels nothing goes on to where it wants to be.
for hand in firm loose; do
  expect 0 'contact episodes' floor.vox ball.pshell "${fast[@]}" --device sim:hand=$hand \
    --set passivity_damping_ns_per_m=1.5 --json hand.json --trace hand.csv
  python3 - <<'PYTHON'
import csv, json
run, prescribed = json.load(open("hand.json")), json.load(open("run.json"))
assert run["penetration_frames"] == 0 and run["contact_episodes"] >= 1
assert 0 <= run["energy_generated_worst_episode_j"] <= run["energy_generated_j"]
assert run["parameters"]["passivity_damping_ns_per_m"] == 1.5
lowest = [min(float(r["handle_z_m"]) for r in csv.DictReader(open(f))) for f in ("hand.csv", "run.csv")]
assert lowest[0] > lowest[1] + 0.0002, lowest
PYTHON
done
expect 2 'replaces the device' floor.vox ball.pshell --replay run.flr --device sim:hand=firm
expect 2 'already sets; leave this option out with --replay' floor.vox ball.pshell --replay run.flr --set motion_scale=2
expect 2 "--device: hand 'soft' is not known; write 'firm' or 'loose'" floor.vox ball.pshell --device sim:hand=soft

# The clock: half a second in real time, neither much less nor more.
begin=$(date +%s%N)
expect 0 'deadline misses' floor.vox ball.pshell --duration 500ms --start 0.1m,0.1m,0.2m
took=$((($(date +%s%N) - begin) / 1000000))
[ "$took" -ge 499 ] || fail "500 ms took $took ms"

expect 1 'no such|not found|cannot|missing' none.vox ball.pshell "${fast[@]}"
expect 1 'CSV file of poses' floor.vox ball.pshell --motion none.csv
expect 4 'ball.pshell' ball.pshell ball.pshell "${fast[@]}"
expect 4 'floor.vox' floor.vox floor.vox "${fast[@]}"
expect 4 'none' unlayered.vox ball.pshell "${fast[@]}"
expect 4 'none' floor.vox coarse.pshell "${fast[@]}"
expect 0 'coarser' floor.vox coarse.pshell "${fast[@]}" --without-guarantee
expect 2 'required' floor.vox
expect 2 '--model' floor.vox ball.pshell --model fancy
expect 2 'not a force field' floor.vox ball.pshell --force fancy
expect 2 'can only use the tangent-plane force' floor.vox ball.pshell --model paper --force level
expect 2 'no offset layers' unlayered.vox ball.pshell "${fast[@]}" --force level --without-guarantee
expect 0 'frames' floor.vox ball.pshell "${fast[@]}" --force tangent-plane
expect 0 'frames' floor.vox ball.pshell "${fast[@]}" --model paper --force tangent-plane
expect 2 'duration' floor.vox ball.pshell --duration 5
expect 0 'frames' floor.vox ball.pshell "${fast[@]}" --set max_speed_mps=2 --json limits.json
grep -q '"max_turn_radps": 20.0' limits.json || fail "no limit of the turning in the report"
expect 2 "--set stale_s: '0.051' is outside" floor.vox ball.pshell "${fast[@]}" --set stale_s=0.051
expect 0 'frames' floor.vox ball.pshell "${fast[@]}" --set stale_s=0.05 --set mass_kg=0.02,look_ups=3 --json set.json
grep -q '"mass_kg": 0.02' set.json && grep -q '"look_ups": 3.0' set.json || fail "no settings in the report"
expect 2 '--set rate_hz: is too slow for a device with motors' floor.vox ball.pshell --device plugin:library=none.so --set rate_hz=49
# The options of a device follow its kind.
expect 2 "--device: 'phantom' is not a kind of device; give sim, hid, spacemouse or plugin" floor.vox ball.pshell --device phantom
expect 2 "--device: 'replay' is not a kind of device; give --replay FILE without --device" floor.vox ball.pshell --device replay --replay run.flr
expect 2 '--replay: replaces the device' floor.vox ball.pshell --device sim --replay run.flr
expect 2 '--device: the plugin.s library is missing; write plugin:library=FILE' floor.vox ball.pshell --device plugin
expect 2 "--device: 'libary' is not a known name; the nearest known name is library" floor.vox ball.pshell --device plugin:libary=a.so
for wrong in hid:dead-zone=0.1 hid:library=a.so spacemouse:without-watchdog plugin:id=16c0:0486 sim:id=16c0:0486; do
  expect 2 '--device: .* is not a known name' floor.vox ball.pshell --device $wrong
done
expect 5 'a,b:c.so: no such file' floor.vox ball.pshell --device plugin:library=./a,,b:c.so,args=x=1
expect 2 '--device id: .nonsense. is not a HID device' floor.vox ball.pshell --device hid:id=nonsense
expect 2 "--device: control 'fast' is not known; write 'rate' or 'position'" floor.vox ball.pshell --device spacemouse:control=fast
expect 2 "--device dead-zone: '1' is outside" floor.vox ball.pshell --device spacemouse:dead-zone=1
expect 2 "--device clutch: '32' is outside" floor.vox ball.pshell --device hid:clutch=32
expect 2 '--device: scene is not a whole number' floor.vox ball.pshell --device spacemouse:scene=1.5
expect 2 '^voxrun: --clutch-button: is an option of an earlier version; write --device KIND:clutch=N$' floor.vox ball.pshell --clutch-button 1
expect 2 '^voxrun: --hand: is an option of an earlier version; write --device sim:hand=firm|loose$' floor.vox ball.pshell --hand firm
expect 2 'never end' floor.vox ball.pshell --as-fast-as-possible
expect 2 "--set: 'mas_kg' is not a known name; the nearest known name is mass_kg" floor.vox ball.pshell "${fast[@]}" --set mas_kg=1
expect 2 "--set: 'mass_kg' needs a value" floor.vox ball.pshell "${fast[@]}" --set mass_kg
expect 2 "--set: 'mass_kg' is given more than once" floor.vox ball.pshell "${fast[@]}" --set mass_kg=1 --set mass_kg=1
expect 2 '--set braking: must be 0 or 1' floor.vox ball.pshell "${fast[@]}" --set braking=0.5
expect 0 'frames' floor.vox ball.pshell "${fast[@]}" --model paper --set braking=0 --json unbraked.json
grep -q '"braking": false' unbraked.json || fail "--set braking=0 brakes"
for setting in mass_kg=0.02 braking=0 rate_hz=500 motion_scale=2; do
  expect 2 '--set: sets a parameter that the recording already sets' floor.vox ball.pshell --replay run.flr --set $setting
done
# An option that has another name now: at its place in the command line, with and without a value.
expect 2 '^voxrun: --mass: is an option of an earlier version; write --set mass_kg=VALUE$' floor.vox ball.pshell "${fast[@]}" --mass 1
expect 2 '^voxrun: --no-braking: is an option of an earlier version; write --set braking=0$' --no-braking floor.vox
# Every option and every name of --set that takes a number: not finite, and far outside.
numbers=$("$bin/voxrun" --help | sed -nE 's/^ +(--[a-z-]+) NUMBER.*/\1/p')
settings=$("$bin/voxrun" --help | sed -nE '/^Names of --set/,/^$/s/^  ([a-z_]+) .*/\1/p;/^Names of --set/,/^$/s/^  ([a-z_]+)$/\1/p')
[ "$(wc -w <<<"$settings")" -eq 23 ] || fail "names of --set: $settings"
for name in $settings; do
  for number in nan -nan inf; do
    expect 2 "--set $name: '$number' is not a finite number" floor.vox ball.pshell "${fast[@]}" --set $name=$number
  done
  for number in 1e300 -1; do
    expect 2 "--set $name: '$number' is outside" floor.vox ball.pshell "${fast[@]}" --set $name=$number
  done
done
for option in $numbers; do
  for number in nan -nan inf; do
    expect 2 "$option: '$number' is not a finite number" floor.vox ball.pshell "${fast[@]}" $option=$number
  done
  for number in 1e300 -1; do
    expect 2 "$option: '$number' is outside" floor.vox ball.pshell "${fast[@]}" $option=$number
  done
done
"$bin/voxrun" --help | grep -E 'FLOAT|:DOUBLE' && fail "a number that is read elsewhere"
for time in nans infs 1e300s 1e400s; do
  expect 2 "--duration: " floor.vox ball.pshell "${fast[@]}" --duration $time
done
for way in 0,0,1001m 0,0,1e9m -1e8,1e8,0m; do
  expect 2 '--pull: must be longer than zero and at most 1000 m' floor.vox ball.pshell --as-fast-as-possible --pull=$way
done
expect 2 'line 3' floor.vox ball.pshell --motion <(printf 't_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0,0,0,0,1,0,0,0\n') --as-fast-as-possible
expect 2 'recording' floor.vox ball.pshell --replay run.flr --model paper
if ! grep -q '^CMAKE_CXX_FLAGS:.*-fsanitize' "$FORCELAYER_BUILD_DIR/CMakeCache.txt"; then
  (ulimit -v 600000
    expect 1 'threads: 256 cannot be started: .*use fewer threads' floor.vox ball.pshell "${fast[@]}" --threads 256)
fi
head -c 5000 run.flr >cut.flr
expect 4 'cut off' floor.vox ball.pshell --replay cut.flr

# --expect: the digests of both files, in any order and case; then another, one alone, and none.
scene_sum=$(sha256sum <floor.vox | cut -c -64) part_sum=$(sha256sum <ball.pshell | cut -c -64)
other=$(sha256sum <press.csv | cut -c -64)
expect 0 'frames' floor.vox ball.pshell "${fast[@]}" --expect $scene_sum --expect $part_sum
expect 0 'frames' floor.vox ball.pshell "${fast[@]}" --expect ${part_sum^^},$other,$scene_sum
expect 4 "floor.vox: has the SHA-256 $scene_sum, which is not expected" floor.vox ball.pshell "${fast[@]}" --expect $other
expect 4 "ball.pshell: has the SHA-256 $part_sum, which is not expected" floor.vox ball.pshell "${fast[@]}" --expect $scene_sum
for digest in '' , 12 ${scene_sum%?} ${scene_sum}0 ${scene_sum%?}g "$scene_sum;$part_sum"; do
  expect 2 '--expect: (.* is not a SHA-256|.*missing)' floor.vox ball.pshell "${fast[@]}" --expect "$digest"
done
# A file that is damaged besides is not looked into, and the next scene is held to the same digests.
cp floor.vox rotten.vox && printf x | dd of=rotten.vox bs=1 seek=100 conv=notrunc status=none
expect 4 'which is not expected' rotten.vox ball.pshell "${fast[@]}" --expect $scene_sum,$part_sum

# A replay with another scene is refused.
expect 4 'recorded with' unlayered.vox ball.pshell --replay run.flr
expect 1 'no such file' floor.vox ball.pshell --replay inputs:none.flr

# Errors leave no output behind; a signal ends the run in order, with its report.
rm -f bad.json bad.csv
expect 4 'none' floor.vox coarse.pshell "${fast[@]}" --json bad.json --trace bad.csv
grep -q '"error"' bad.json && [ ! -e bad.csv ] || fail "output left behind"
: >out.txt  # of the command before: it would end the wait before this one has begun
"$bin/voxrun" floor.vox ball.pshell --start 0.1m,0.1m,0.2m --json signal.json >out.txt 2>err.txt &
for _ in $(seq 200); do [ -s out.txt ] && break; sleep 0.05; done
sleep 0.5
kill -TERM $!
status=0
wait $! || status=$?
[ "$status" -eq 143 ] || fail "status $status after SIGTERM"
grep -q '"exit_status": 143' signal.json || fail "no report after SIGTERM, or another status in it"
grep -q 'ended by signal 15' err.txt || fail "no reason after SIGTERM: $(cat err.txt)"
# Before the first frame there is nothing to write, and old files stay.
# (A sanitizer takes mlockall for itself, so that nothing can hold it up there.)
if [ -z "${FORCELAYER_SANITIZED:-}" ]; then
  mkdir early
  cp signal.json early/run.json
  : >out.txt
  LD_PRELOAD=$bin/fault_shim.so FAULT_LOCK_MS=3000 "$bin/voxrun" floor.vox ball.pshell --motion press.csv --json early/run.json \
    --trace early/run.csv --save-path early/path.csv --record early/run.flr >out.txt 2>err.txt &
  for _ in $(seq 200); do [ -s out.txt ] && break; sleep 0.05; done
  kill -INT $!
  status=0
  wait $! || status=$?
  [ "$status" -eq 130 ] || fail "status $status after a signal before the first frame: $(cat err.txt)"
  tail -n 1 err.txt | grep -q '^voxrun: ended by signal 2 (Interrupt) before the run began$' || fail "another reason: $(cat err.txt)"
  [ "$(ls -A early)" = run.json ] && cmp -s early/run.json signal.json || fail "files of a run that never began: $(ls -A early)"
fi

# docs/voxrun_report.md has every key of the report, those inside too, and no others. The help has every parameter with its range.
expect 0 'followed' floor.vox ball.pshell --start 0.1m,0.1m,0.2m --pull 0,0,10mm --as-fast-as-possible --json keys.json
"$bin/voxrun" --help | tr -s ' \n' ' ' >help.txt
python3 - "$FORCELAYER_SOURCE_DIR/docs/voxrun_report.md" "$FORCELAYER_SOURCE_DIR/docs/commands.md" <<'PYTHON'
import json, re, sys
page, common = (open(path).read() for path in sys.argv[1:])
page = page.split("\n## The trace")[0]
report = json.load(open("keys.json"))
def keys(value):
    for entry in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from keys(entry)
    if isinstance(value, dict):
        yield from value
for named in ("device_capabilities", "miss_causes"):  # by other pages
    report[named] = None
named = set(re.findall(r"`(\w+)`", page + common.split("\n## Reports")[1]))
parameters = set(report["parameter_reasons"])
assert set(keys(report)) - parameters <= named, set(keys(report)) - parameters - named
tops = {key for row in re.findall(r"^- (`.*?):", page, re.MULTILINE) for key in re.findall(r"`(\w+)`", row)}
assert tops - {"device_counters"} <= set(report), tops - set(report)
told = open("help.txt").read().split("Names of --set")[1]
for name in parameters:
    assert re.search(rf" {name} [^(]*(\([^)]*\)[^(]*)?\(\S+ to \S+\)", told), name
PYTHON

# The pose stream: something arrives while the loop runs.
python3 - <<'PYTHON' &
import socket, struct
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind(("127.0.0.1", 0))
open("port", "w").write(f"{s.getsockname()[1]}\n")
s.settimeout(20)
data = s.recv(2048)
assert len(data) == 384 and struct.unpack_from("<IHH", data) == (0x53504C46, 2, 384)
handle = struct.unpack_from("<3d", data, 96)
assert all(abs(a - b) < 1e-12 for a, b in zip(handle, (0.1, 0.1, 0.2))), handle
PYTHON
receiver=$!
until [ -s port ]; do sleep 0.05; done
expect 0 'frames' floor.vox ball.pshell --start 0.1m,0.1m,0.2m --world-from-device 5m,0,0 \
  --duration 500ms --udp "$(cat port)@100"
wait "$receiver" || fail "no pose stream"
expect 2 '--udp' floor.vox ball.pshell --duration 1s --start 0.1m,0.1m,0.2m --udp nonsense:nonsense
expect 2 "--udp: '0.5' is outside" floor.vox ball.pshell --duration 1s --start 0.1m,0.1m,0.2m --udp 7000@0.5
