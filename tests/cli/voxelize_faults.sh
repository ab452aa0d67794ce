#!/usr/bin/env bash
# Broken machines while a scene or a part is baked: a clear line, the old file as it was, nothing
# left behind; and machines that are merely odd: the same bytes.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/faults.sh"
data=$FORCELAYER_SOURCE_DIR/sample_data
scene=("$data/bay.json" --voxel-size 20mm --quiet)
part=("$data/part.obj" --units mm --voxel-size 4mm --method fast --quiet)
voxelize=$bin/voxelize pointshell=$bin/pointshell

# The files that a sound machine gives.
reference() {
  "$voxelize" "${scene[@]}" -o good.vox --json good.json && "$pointshell" "${part[@]}" -o good.pshell || fail "reference"
}

magic=$'\211FL'  # with which a baked file begins
export magic

# refused TEXT: both bakes over an old file fail with the text and leave the old file.
refused() {
  echo "${magic}Vold" >old.vox
  echo "${magic}Pold" >old.pshell
  expect 1 "$1" "$voxelize" "${scene[@]}" -o old.vox
  expect 1 "$1" "$pointshell" "${part[@]}" -o old.pshell
  echo "${magic}Vold" | cmp -s - old.vox && echo "${magic}Pold" | cmp -s - old.pshell || fail "an old file was touched"
  no_leftovers
}

disk_full() {
  local bytes
  for bytes in 0 1000 6000; do
    export LD_PRELOAD=$shim FAULT_WRITE_ERRNO=28 FAULT_WRITE_AFTER=$bytes
    refused 'No space left on device; free some space, or write elsewhere'
    unset LD_PRELOAD
  done
  expect 1 'No space left' "$voxelize" "${scene[@]}" -o /dev/full
  expect 1 'No space left' "$pointshell" "${part[@]}" -o /dev/full
  expect 1 'No space left' "$voxelize" "${scene[@]}" -o fine.vox --json /dev/full
}

# A tmpfs of 64 KiB, in a mount namespace of its own.
disk_full_tmpfs() {
  can_mount || { skip "mounting takes root"; return; }
  reference
  export -f refused expect fail no_leftovers
  export bin voxelize pointshell fault scratch data
  mkdir small
  unshare --mount bash -c '
    scene=("$data/bay.json" --voxel-size 20mm --quiet) part=("$data/part.obj" --units mm --voxel-size 4mm --method fast --quiet)
    mount -t tmpfs -o size=64k none small && cd small || exit 1
    head -c 56000 /dev/zero >ballast
    refused "No space left on device"
    expect 0 "nothing was stored in the cache" "$voxelize" "$data/bay.json" --voxel-size 20mm -o ../other.vox --cache cache
    rm ballast' || fail "in the namespace"
  same other.vox good.vox "with a full disk under the cache"
}

quota() {
  export LD_PRELOAD=$shim FAULT_WRITE_ERRNO=122 FAULT_WRITE_AFTER=5000
  refused 'Disk quota exceeded; free some space, or write elsewhere'
}

file_size_limit() {
  (ulimit -f 8; refused 'File too large')
}

io_error() {
  export LD_PRELOAD=$shim FAULT_WRITE_ERRNO=5 FAULT_WRITE_AFTER=5000
  refused 'Input/output error'
}

read_only_target() {
  can_mount || { skip "mounting takes root"; return; }
  export -f refused expect fail no_leftovers
  export bin voxelize pointshell fault scratch data
  mkdir small
  unshare --mount bash -c '
    mount -t tmpfs none small && echo "${magic}Vold" >small/old.vox && mount -o remount,ro small || exit 1
    expect 1 "Read-only file system" "$voxelize" "$data/bay.json" --voxel-size 20mm --quiet -o small/old.vox
    expect 1 "Read-only file system" "$pointshell" "$data/part.obj" --units mm --voxel-size 4mm --method fast --quiet -o small/new.pshell
    expect 1 "Read-only file system" "$voxelize" "$data/bay.json" --voxel-size 20mm --quiet -o new.vox --cache small/cache
    [ "$(cat small/old.vox)" = "${magic}Vold" ] && [ "$(ls -A small)" = old.vox ] || fail "something was written"' || fail "in the namespace"
}

# A folder in which the user may not write, as a user whom the mode concerns.
forbidden_target() {
  mkdir closed && chmod 555 closed
  local as=()
  if [ "$(id -u)" = 0 ]; then
    as=(setpriv --reuid=65534 --clear-groups)
    chmod 755 .. .
    "${as[@]}" test -x "$voxelize" && "${as[@]}" test -r "$data/bay.json" || { skip "nobody may not read the build"; return; }
  fi
  expect 1 'Permission denied' "${as[@]}" "$voxelize" "${scene[@]}" -o closed/new.vox
  expect 1 'Permission denied' "${as[@]}" "$pointshell" "${part[@]}" -o closed/new.pshell
  [ -z "$(ls -A closed)" ] || fail "something was written"
}

# Two and more bakes into one output and one cache at the same time.
bakes_at_once() {
  reference
  local n
  for n in 1 2 3 4; do
    "$voxelize" "${scene[@]}" -o out.vox --cache cache 2>err$n.txt &
    "$pointshell" "${part[@]}" -o out.pshell 2>perr$n.txt &
  done
  wait
  [ -z "$(cat err?.txt perr?.txt)" ] || fail "$(cat err?.txt perr?.txt)"
  same out.vox good.vox "at once"
  same out.pshell good.pshell "at once"
  [ -z "$(ls -A cache/tmp)" ] || fail "left in the cache: $(ls -A cache/tmp)"
  good "$voxelize" "${scene[@]}" -o out.vox --cache cache
  same out.vox good.vox "from the cache that they filled"
  no_leftovers
}

# Every limit gives a scene or one line; so do the parts' readers under it.
address_space_limit() {
  sanitized && { skip "a sanitizer holds terabytes of addresses"; return; }
  reference
  local kib status bakes=0 refusals=0
  echo "${magic}Vold" >out.vox
  for kib in 12000 18000 24000 30000 36000 42000 48000 60000 100000 2000000; do
    (ulimit -v $kib; exec timeout 60 "$voxelize" "${scene[@]}" -o out.vox --threads 2 >"$scratch/out.txt" 2>"$scratch/err.txt")
    status=$?
    if [ $status = 0 ]; then
      same out.vox good.vox "$kib KiB"
      bakes=$((bakes + 1))
    elif [ $status != 127 ]; then  # 127: not even loaded
      refusals=$((refusals + 1))
      { [ $status = 1 ] || [ $status = 3 ]; } || fail "status $status with $kib KiB: $(tail -n 3 "$scratch/err.txt")"
      [ "$(wc -l <"$scratch/err.txt")" = 1 ] || fail "not one line with $kib KiB: $(tail -n 3 "$scratch/err.txt")"
      [ $bakes -gt 0 ] || [ "$(cat out.vox)" = "${magic}Vold" ] || fail "the old file was touched with $kib KiB"
    fi
  done
  [ $bakes -gt 0 ] && [ $refusals -gt 0 ] || fail "$bakes bakes and $refusals refusals"
  no_leftovers
}

# A triangle of 45 bytes that no machine holds: refused before memory is taken.
immense_triangle() {
  printf 'v 0 0 0\nv 3e6 0 0\nv 0 3e6 0.5\nf 1 2 3\n' >immense.obj
  expect 3 'at 1 mm the scene takes at least 2.7e+04 GB of memory, but this process can have' "$voxelize" immense.obj --units mm --voxel-size 1mm --quiet -o out.vox
  [ ! -e out.vox ] || fail "a file was written"
}

# One number of garbage in a small part: slivers of half a billion voxels.
stray_vertex() {
  sanitized && { skip "a sanitizer holds terabytes of addresses"; return; }
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1e10\nf 1 2 3\nf 2 4 3\n' >stray.obj
  # Twenty gigabytes: the same on machines that have more.
  (ulimit -v 20000000; expect 3 'triangle 1 of stray: passes through at least 5e+08 voxels' timeout 5 "$voxelize" stray.obj --units mm --voxel-size 20mm --quiet -o out.vox)
  # Twenty million voxels: each triangle would fit, and what it reaches would not. The plan knows it, too.
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 4e8\nf 1 2 3\nf 2 4 3\n' >stray.obj
  local more
  for more in "" "--kind lean" "--kind paper" "--cache kept" "--cache kept --shard 1/1" --plan; do
    local out="-o out.vox" status=3 text='correct the stray vertex at (0.000[0-9]*, 0.000[0-9]*, 400000) m'
    [[ $more = *--shard* || $more = --plan ]] && out=
    [ "$more" = --plan ] && status=0
    # shellcheck disable=SC2086
    (ulimit -v 3000000; timeout 20 "$voxelize" stray.obj --units mm --voxel-size 20mm $out $more >all.txt 2>&1
     [ $? = $status ] && grep -q "$text" all.txt || fail "$more: $(cat all.txt)")
  done
  [ ! -e out.vox ] || fail "a file was written"
}

more_threads_than_cores() {
  reference
  local threads
  for threads in 3 61 1000; do
    good "$voxelize" "${scene[@]}" -o out.vox --threads $threads
    same out.vox good.vox "$threads threads"
    good "$pointshell" "${part[@]}" -o out.pshell --threads $threads
    same out.pshell good.pshell "$threads threads"
  done
}

# The wall clock jumps a year ahead and back at every look.
clock_jumps() {
  reference
  export LD_PRELOAD=$shim FAULT_CLOCK_JUMPS=1
  good "$voxelize" "${scene[@]}" -o out.vox --cache cache --json out.json
  good "$voxelize" "${scene[@]}" -o again.vox --cache cache
  good "$pointshell" "${part[@]}" -o out.pshell --json part.json
  unset LD_PRELOAD
  same out.vox good.vox "with a jumping clock"
  same again.vox good.vox "with a jumping clock, from the cache"
  same out.pshell good.pshell "with a jumping clock"
  python3 - <<'PYTHON' || fail "times in the reports"
import json
for name in ("out.json", "part.json"):
    assert all(0 <= s < 600 for s in json.load(open(name))["seconds"].values()), name
PYTHON
}

# A user's locale that writes a comma for the point and a point between thousands.
decimal_comma() {
  command -v localedef >/dev/null && localedef -i de_DE -f UTF-8 ./de_DE.UTF-8 2>/dev/null || { skip "needs locales of scripts/packages.txt"; return; }
  reference
  { export LOCPATH=$PWD LC_ALL=de_DE.UTF-8; } 2>/dev/null  # the shell has no such locale, its children do
  [ "$(env printf '%.1f' 1,5 2>/dev/null)" = 1,5 ] || { skip "the locale does not take"; return; }
  good "$voxelize" "${scene[@]}" -o out.vox --json out.json
  same out.vox good.vox "with decimal commas"
  good "$pointshell" "${part[@]}" -o out.pshell
  same out.pshell good.pshell "with decimal commas"
  python3 -c 'import json; a, b = (json.load(open(n)) for n in ("good.json", "out.json")); assert a["voxel_size_m"] == b["voxel_size_m"] and a["origin_m"] == b["origin_m"]' ||
    fail "other figures in the report"
  good "$bin/voxinfo" export out.vox out.csv
  LC_ALL=C good "$bin/voxinfo" export out.vox plain.csv
  same out.csv plain.csv "export with decimal commas"
}

# Spaces, line ends, quotes, letters of other scripts, bytes that are no UTF-8, a leading dash.
odd_names() {
  local name
  for name in 'with space' $'with\nline end' 'täst-テスト-проба' "quo'te\"s\\" $'bad\xff\xfeutf8' '*?[x]$(true)' '-dash'; do
    mkdir -p "./$name" && cp "$data/return_line.stl" "./$name/$name.stl" || { skip "the file system refuses '$name'"; continue; }
    good "$voxelize" "./$name/$name.stl" --units mm --voxel-size 20mm --quiet -o "./$name/$name.vox" --json "./$name/$name.json" --cache "./$name/cache"
    good "$voxelize" "./$name/$name.stl" --units mm --voxel-size 20mm --quiet -o "./$name/again.vox" --sandbox
    same "./$name/$name.vox" "./$name/again.vox" "$name in the sandbox"
    good "$pointshell" "./$name/$name.stl" --units mm --voxel-size 20mm --method fast --quiet -o "./$name/$name.pshell" --json "./$name/part.json"
    good "$bin/voxinfo" verify "./$name/$name.vox"
    good "$bin/voxinfo" export "./$name/$name.vox" "./$name/$name.csv"
    python3 -c 'import json, sys; json.load(open(sys.argv[1], encoding="utf-8")); json.load(open(sys.argv[2], encoding="utf-8"))' "./$name/$name.json" "./$name/part.json" ||
      fail "the report of '$name' is no JSON"
    # Errors stay one line of printable text, whatever the name.
    expect 1 'no such file' "$voxelize" "./$name/none.stl" --units mm --voxel-size 20mm -o out.vox
    LC_ALL=C grep -q '[[:cntrl:]]' "$scratch/err.txt" && fail "control characters in the line about '$name'"
  done
  no_leftovers
}

# A mesh file that another program writes to while it is read: cli.voxelize_sandbox has it cut short
# and changed at the worst moment; here at any moment.
input_changes() {
  python3 - "$voxelize" "$data/return_line.stl" <<'PYTHON' || fail "while a file is written to"
import os, random, subprocess, sys, threading, time
voxelize, source = sys.argv[1:]
whole = open(source, "rb").read() * 1
dice, stop = random.Random(1), threading.Event()
def scribble():
    while not stop.is_set():
        with open("live.stl", "r+b") as f:
            f.seek(dice.randrange(len(whole)))
            f.write(bytes(dice.randrange(256) for _ in range(8)))
            if dice.random() < 0.2: f.truncate(dice.randrange(len(whole)))
        with open("live.stl", "r+b") as f:
            f.write(whole)
open("live.stl", "wb").write(whole)
writer = threading.Thread(target=scribble, daemon=True)
writer.start()
seen = {}
for n in range(25):
    more = ["--sandbox"] if n % 2 else []
    try:
        run = subprocess.run([voxelize, "live.stl", "--units", "mm", "--voxel-size", "20mm", "--quiet", "-o", "out.vox", *more],
                             capture_output=True, timeout=20)
    except subprocess.TimeoutExpired:
        seen["slow"] = seen.get("slow", 0) + 1  # bytes that make a part of ten thousand kilometres: a bake like any other
        continue
    seen[run.returncode] = seen.get(run.returncode, 0) + 1
    lines = run.stderr.count(b"\n")
    assert run.returncode in (0, 1, 3) and lines == (run.returncode != 0), (run.returncode, run.stderr[-500:])
stop.set()
writer.join()
assert seen.get("slow", 0) < 5, seen
print("statuses", seen)
PYTHON
}

run_faults disk_full disk_full_tmpfs quota file_size_limit io_error read_only_target forbidden_target bakes_at_once \
  address_space_limit immense_triangle stray_vertex more_threads_than_cores clock_jumps decimal_comma odd_names input_changes
