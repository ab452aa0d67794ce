#!/usr/bin/env bash
# Broken machines under a running loop: the run ends with a clear line and without a force, and what it
# wrote is whole or not there; machines that are merely odd change no bit of the outcome.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/faults.sh"
source "$FORCELAYER_SOURCE_DIR/tests/support/in_time.sh"
voxrun=$bin/voxrun
run=(floor.vox ball.pshell --device sim --motion press.csv --as-fast-as-possible --quiet)

files() {
  "$bin/make_runtime_files" .
  # A hand that presses and stays.
  printf "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0.1,0.1,0.06,1,0,0,0\n0.4,0.1,0.1,0.03,1,0,0,0\n20,0.12,0.1,0.03,1,0,0,0\n" >hold.csv
}
reference() {
  files
  good "$voxrun" "${run[@]}" --json good.json --trace good.csv --record good.flr
}

# same_outcome JSON: as in good.json, bit for bit.
same_outcome() {
  python3 -c 'import json, sys; a, b = (json.load(open(n)) for n in ("good.json", sys.argv[1])); assert a["outcome_hash"] == b["outcome_hash"] and a["frames"] == b["frames"], (a, b)' "$1" || fail "another outcome: $1"
}

disk_full() {
  files
  local option errno
  for option in --trace --record --json; do
    case $option in  # as a command begins it: no other file is replaced
      --record) echo $'\211FLR' ;;
      --trace) echo t_s,handle_x_m,old ;;
      --json) printf '{\n  "schema_version": 1}\n' ;;
    esac >old
    cp old before
    for errno in 28 122 5; do  # full, quota, broken
      LD_PRELOAD=$shim FAULT_WRITE_ERRNO=$errno FAULT_WRITE_AFTER=500 expect 1 'old: cannot be written' "$voxrun" "${run[@]}" $option old
      cmp -s before old || fail "$option: the old file was touched"
    done
    expect 1 'No space left' "$voxrun" "${run[@]}" $option /dev/full
  done
  in_time err.txt full_in_the_middle || fail "in the middle: $(cat err.txt)"
  no_leftovers
}

full_in_the_middle() {  # a run with a clock ends there, not at its end
  local begin=$SECONDS
  LD_PRELOAD=$shim FAULT_WRITE_ERRNO=28 FAULT_WRITE_AFTER=5000 timeout 100 "$voxrun" floor.vox ball.pshell --start 0.1m,0.1m,0.2m \
    --duration 60s --quiet --trace long.csv 2>err.txt
  [ $? = 1 ] && tail -n 1 err.txt | grep -q 'long.csv: .*No space left' || return 1
  [ $((SECONDS - begin)) -lt 40 ] || { echo "the run went on for $((SECONDS - begin)) s" >>err.txt; return 1; }
}

read_only_target() {
  files
  can_mount || { skip "mounting takes root"; return; }
  mkdir closed
  export -f expect fail
  export fault scratch voxrun
  unshare --mount bash -c '
    mount -t tmpfs none closed && mount -o remount,ro closed || exit 1
    for option in --trace --record --json; do
      expect 1 "Read-only file system" "$voxrun" floor.vox ball.pshell --device sim --motion press.csv --as-fast-as-possible --quiet $option closed/new
    done' || fail "in the namespace"
}

# Nothing that happens to the files while the loop runs changes it: the run ends as one that nobody disturbed, with the
# same trace. Without a clock the loop waits for the reader of its trace, who changes both files in the middle of it.
files_change_while_running() {
  reference
  local still=(floor.vox ball.pshell --motion hold.csv --as-fast-as-possible --quiet)
  good "$voxrun" "${still[@]}" --json still.json --trace still.csv
  python3 - <<'PYTHON' || fail "the hand does not press from the start to the end"
import csv
force = [abs(float(row["device_force_z_n"])) for row in csv.DictReader(open("still.csv"))]
assert len(force) == 20000 and min(force[1000:]) > 0.1, min(force[1000:])
PYTHON
  local how
  for how in 'truncate -s 0 FILE' 'truncate -s 4096 FILE' 'rm FILE' 'cp press.csv other; mv other FILE' \
    'dd of=FILE if=/dev/urandom bs=4096 count=100 conv=notrunc status=none' \
    'dd of=FILE bs=1 count=1 seek=1000 conv=notrunc if=/dev/zero status=none'; do
    files
    good python3 - "$how" "$voxrun" "${still[@]}" <<'PYTHON'
import csv, json, os, subprocess, sys
def rows(name): return [{k: v for k, v in row.items() if k != "step_ns"} for row in csv.DictReader(open(name))]
os.path.exists("pipe") or os.mkfifo("pipe")
run = subprocess.Popen([*sys.argv[2:], "--json", "run.json", "--trace", "pipe"])
with open("pipe", "rb", buffering=0) as pipe, open("run.csv", "wb") as trace:
    trace.write(pipe.read(1000))
    assert run.poll() is None, "it is over already"
    for file in "floor.vox", "ball.pshell": subprocess.run(sys.argv[1].replace("FILE", file), shell=True, check=True)
    while data := pipe.read(65536): trace.write(data)
assert run.wait() == 0, run.returncode
calm, disturbed = (json.load(open(name)) for name in ("still.json", "run.json"))
assert calm["outcome_hash"] == disturbed["outcome_hash"] and disturbed["output_trips"] == 0
assert rows("still.csv") == rows("run.csv"), "another trace"
PYTHON
  done
}

# One bit of any section of either file: refused before the loop begins.
bit_rot() {
  files
  local file rotten
  for file in floor.vox ball.pshell; do
    cp $file whole
    python3 - $file <<'PYTHON' || fail "sections of $file"
import struct, sys
data = open(sys.argv[1], "rb").read()
header_bytes, sections = struct.unpack_from("<II", data, 16)
for n in range(sections):
    offset, size = struct.unpack_from("<8xQQ", data, header_bytes + 32 * n)
    if size:
        rotten = bytearray(data)
        rotten[offset + size // 2] ^= 64
        open("rotten%d" % n, "wb").write(rotten)
PYTHON
    for rotten in rotten*; do
      cp "$rotten" $file
      expect 4 "the section is damaged" "$voxrun" "${run[@]}"
    done
    [ "$(ls rotten* | wc -l)" -ge 4 ] || fail "only $(ls rotten*)"
    rm rotten*
    cp whole $file
  done
  good "$voxrun" "${run[@]}"
}

# kill -9 at any moment: what has a name is whole.
kill_at_any_moment() {
  files
  python3 - "$voxrun" <<'PYTHON' || fail "after kill -9"
import json, os, random, signal, subprocess, sys, time
voxrun, dice = sys.argv[1], random.Random(1)
run = [voxrun, "floor.vox", "ball.pshell", "--device", "sim", "--motion", "press.csv", "--as-fast-as-possible", "--quiet"]
ends = {0: 0, -9: 0}
start = time.monotonic()
outputs = ["--trace", "run.csv", "--record", "run.flr", "--json", "run.json"]
subprocess.run(run + outputs, check=True)  # flushing them is half of the time where the disk is busy
length_s = time.monotonic() - start
for n in range(30):
    for name in ("run.csv", "run.flr", "run.json"):
        if os.path.exists(name): os.remove(name)
    process = subprocess.Popen(run + outputs)
    time.sleep(dice.uniform(0, 2 * length_s))
    process.send_signal(signal.SIGKILL)
    status = process.wait()
    ends[status] += 1
    length_s *= 0.85 if status == 0 else 1.15  # as fast as the machine is meanwhile
    if os.path.exists("run.json"): assert json.load(open("run.json"))["frames"] == 700
    if os.path.exists("run.csv"): assert open("run.csv").read().count("\n") == 701
    if os.path.exists("run.flr"):
        subprocess.run(run[:3] + ["--replay", "run.flr", "--as-fast-as-possible", "--quiet"], check=True)
print(ends)
assert ends[-9] > 3 and ends[0] > 0, ends
PYTHON
}

address_space_limit() {
  sanitized && { skip "a sanitizer holds terabytes of addresses"; return; }
  reference
  local kib status good=0 bad=0
  for kib in 8000 12000 16000 20000 24000 32000 48000 64000 100000 200000 2000000; do
    rm -f run.json
    (ulimit -v $kib; exec timeout 60 "$voxrun" "${run[@]}" --json run.json >out.txt 2>err.txt)
    status=$?
    if [ $status = 0 ]; then
      same_outcome run.json
      good=$((good + 1))
    elif [ $status != 127 ]; then
      bad=$((bad + 1))
      [ $status = 1 ] && [ "$(wc -l <err.txt)" = 1 ] && { [ ! -e run.json ] || grep -q '"error"' run.json; } || fail "status $status with $kib KiB: $(cat err.txt)"
    fi
  done
  [ $good -gt 0 ] && [ $bad -gt 0 ] || fail "$good runs and $bad refusals"
}

more_threads_than_cores() {
  reference
  local threads
  for threads in 3 16 64; do
    good "$voxrun" "${run[@]}" --threads $threads --json run.json
    same_outcome run.json
  done
}

clock_jumps() {
  reference
  LD_PRELOAD=$shim FAULT_CLOCK_JUMPS=1 good "$voxrun" "${run[@]}" --json run.json --trace run.csv
  same_outcome run.json
  # With a clock: half a second is half a second.
  in_time err.txt half_a_second || fail "half a second: $(cat err.txt)"
  python3 -c 'import json; r = json.load(open("run.json")); assert r["frames"] == 500, r["frames"]' || fail "frames"
}

half_a_second() {
  local begin
  begin=$(date +%s%N)
  LD_PRELOAD=$shim FAULT_CLOCK_JUMPS=1 timeout 60 "$voxrun" floor.vox ball.pshell --start 0.1m,0.1m,0.2m --duration 500ms \
    --quiet --json run.json 2>err.txt || return 1
  [ $((($(date +%s%N) - begin) / 1000000)) -ge 499 ] || { echo "500 ms took less" >>err.txt; return 1; }
}

decimal_comma() {
  command -v localedef >/dev/null && localedef -i de_DE -f UTF-8 ./de_DE.UTF-8 2>/dev/null || { skip "needs locales of scripts/packages.txt"; return; }
  reference
  { export LOCPATH=$PWD LC_ALL=de_DE.UTF-8; } 2>/dev/null
  [ "$(env printf '%.1f' 1,5 2>/dev/null)" = 1,5 ] || { skip "the locale does not take"; return; }
  good "$voxrun" "${run[@]}" --json run.json --trace run.csv --set max_force_n=3.5
  good "$voxrun" "${run[@]}" --json run.json --trace run.csv
  same_outcome run.json
  good "$voxrun" floor.vox ball.pshell --replay good.flr --as-fast-as-possible --quiet --json run.json
  same_outcome run.json
  python3 - <<'PYTHON' || fail "another trace"
import csv
a, b = (list(csv.DictReader(open(name))) for name in ("good.csv", "run.csv"))
for row in a + b: del row["step_ns"]
assert len(a) == 700 and a == b
PYTHON
}

odd_names() {
  reference
  local name
  for name in 'with space' $'with\nline end' 'täst-テスト-проба' "quo'te\"s\\" $'bad\xff\xfeutf8' $'turn\xe2\x80\xaexov.' $'c1\xc2\x9b31m' '*?[x]$(true)' '-dash'; do
    mkdir -p "./$name" && cp floor.vox "./$name/$name.vox" && cp ball.pshell "./$name/$name.pshell" && cp press.csv "./$name/$name.csv" ||
      { skip "the file system refuses '$name'"; continue; }
    good "$voxrun" "./$name/$name.vox" "./$name/$name.pshell" --device sim --motion "./$name/$name.csv" --as-fast-as-possible --quiet \
      --json "./$name/run.json" --trace "./$name/trace.csv" --record "./$name/$name.flr"
    same_outcome "./$name/run.json"
    good "$voxrun" "./$name/$name.vox" "./$name/$name.pshell" --replay "./$name/$name.flr" --as-fast-as-possible --quiet
    expect 1 'no such file' "$voxrun" "./$name/none.vox" ball.pshell --duration 1s
    LC_ALL=C grep -qP '[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]|\xe2\x80[\xa8\xa9\xaa-\xae]|\xff' "$scratch/err.txt" &&
      fail "control characters in the line about '$name'"
  done
  no_leftovers
}

run_faults disk_full read_only_target files_change_while_running bit_rot \
  kill_at_any_moment address_space_limit \
  more_threads_than_cores clock_jumps decimal_comma odd_names
