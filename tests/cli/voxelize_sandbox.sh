#!/usr/bin/env bash
# --sandbox of voxelize and pointshell: the same bytes as without, and a reader that crashes, hangs,
# eats memory or lies is one line about that file, in little time, with nothing left behind.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
# The faults come by LD_PRELOAD, before a sanitizer's own libraries.
export ASAN_OPTIONS=verify_asan_link_order=0:${ASAN_OPTIONS-}

# Other people's scene, and a part: assemblies, materials, every format of the sample data.
scene=("$data/bay.json" --voxel-size 20mm --quiet)
"$bin/voxelize" "${scene[@]}" -o plain.vox || fail "scene"
"$bin/voxelize" "${scene[@]}" -o boxed.vox --sandbox || fail "scene in the sandbox"
cmp -s plain.vox boxed.vox || fail "the sandbox gives another scene"
"$bin/voxelize" "${scene[@]}" -o boxed.vox --sandbox --cache cache || fail "sandbox and cache, cold"
"$bin/voxelize" "${scene[@]}" -o boxed.vox --sandbox --cache cache || fail "sandbox and cache, warm"
cmp -s plain.vox boxed.vox || fail "sandbox and cache give another scene"
part=("$data/part.obj" --units mm --voxel-size 20mm --method fast --quiet)
"$bin/pointshell" "${part[@]}" -o plain.pshell || fail "part"
"$bin/pointshell" "${part[@]}" -o boxed.pshell --sandbox || fail "part in the sandbox"
cmp -s plain.pshell boxed.pshell || fail "the sandbox gives another part"
"$bin/pointshell" verify boxed.pshell "$data/part.obj" --units mm --quiet --sandbox || fail "verify in the sandbox"

# expect STATUS TEXT COMMAND...: that status, one line on stderr that names the text, no output.
expect() {
  local status=$1 text=$2 got
  shift 2
  LD_PRELOAD=$bin/fault_shim.so timeout -k 1 60 "$@" >out 2>err
  got=$?
  [ $got = "$status" ] || fail "status $got instead of $status: $*: $(cat err)"
  [ "$(wc -l <err)" = 1 ] || fail "not one line on stderr: $*: $(cat err)"
  grep -qF -- "$text" err || fail "no '$text' on stderr: $*: $(cat err)"
  [ ! -e out.vox ] && [ ! -e out.pshell ] || fail "an output file was left: $*"
}

both() {  # both STATUS TEXT FILE OPTIONS...: of voxelize and of pointshell
  local status=$1 text=$2 file=$3
  shift 3
  fresh "$file"
  expect "$status" "$text" "$bin/voxelize" "$file" --units mm --voxel-size 20mm -o out.vox --sandbox "$@"
  fresh "$file"
  expect "$status" "$text" "$bin/pointshell" "$file" --units mm --voxel-size 20mm -o out.pshell --sandbox "$@"
}
fresh() {  # a sound mesh, written long ago; not in place of the two that are made below
  case $1 in empty.stl | huge.stl) return ;; esac
  cp "$data/return_line.stl" "$1"
  touch -d 2001-01-01 "$1"
}
both 3 'crash.stl: the reader of this file crashed (Segmentation fault)' crash.stl
both 3 'abort.stl: the reader of this file crashed (Aborted)' abort.stl
both 3 'quit.stl: the reader of this file ended with status 9' quit.stl
both 3 "hang.stl: reading this file takes longer than the sandbox's limit of 0.5 s" hang.stl --sandbox=time=500ms
# A limit asks for the sandbox.
fresh hang.stl
expect 3 "reading this file takes longer than the sandbox's limit of 0.5 s" "$bin/voxelize" hang.stl --units mm --voxel-size 20mm -o out.vox \
  --sandbox=time=500ms
both 3 'mute.stl: the reader of this file' mute.stl
both 3 'nonsense.stl: the reader of this file sent a damaged mesh' nonsense.stl
both 1 'changed.stl: has changed while it was being read; start again' changed.stl
printf 'solid nothing\nendsolid nothing\n' >empty.stl
both 3 'no triangles' empty.stl
expect 1 'no such file' "$bin/voxelize" none.stl --units mm --voxel-size 20mm -o out.vox --sandbox
both 1 'cut.stl: was cut short while it was being read' cut.stl
fresh cut.stl
expect 1 'cut.stl: was cut short while it was being read' "$bin/voxelize" cut.stl --units mm --voxel-size 20mm -o out.vox
fresh cut.stl
expect 1 'cut.stl: was cut short while it was being read' "$bin/pointshell" cut.stl --units mm --voxel-size 20mm -o out.pshell
# A sanitizer holds terabytes of addresses: no limit there.
if ! grep -aq __asan_init "$bin/voxelize"; then
  # Four million triangles of nothing, in a file that takes no disk.
  { head -c 80 /dev/zero; printf '\x00\x09\x3d\x00'; } >huge.stl
  truncate -s $((84 + 50 * 4000000)) huge.stl
  both 3 "huge.stl: reading this file takes more memory than the sandbox's limit of 0.375 GiB" huge.stl --sandbox=memory=384MiB
fi
fresh changed.stl
expect 1 'has changed while it was being read' "$bin/voxelize" changed.stl --units mm --voxel-size 20mm -o out.vox

# The file at fault of a manifest is named; the others are not.
fresh good.stl
fresh crash.stl
cat >scene.json <<'JSON'
{"parts": [{"mesh": "good.stl", "units": "mm"}, {"mesh": "crash.stl", "units": "mm"}]}
JSON
expect 3 'crash.stl' "$bin/voxelize" scene.json --voxel-size 20mm -o out.vox --sandbox
grep -q good.stl err && fail "an innocent file is named: $(cat err)"

# The child dies with its parent, which was killed, and of Ctrl-C.
child_of() {  # child_of PROCESS: its reader
  local child
  for _ in $(seq 100); do
    child=$(pgrep -P $1 | head -n 1)
    [ -n "$child" ] && grep -qa read-mesh-for-sandbox "/proc/$child/cmdline" 2>/dev/null && break
    sleep 0.1
  done
  echo "$child"
}
outlives() {  # outlives CHILD
  for _ in $(seq 50); do
    kill -0 "$1" 2>/dev/null && ! grep -q '^State:.*Z' "/proc/$1/status" || return 1
    sleep 0.1
  done
}
fresh hang.stl
LD_PRELOAD=$bin/fault_shim.so "$bin/voxelize" hang.stl --units mm --voxel-size 20mm -o out.vox --sandbox 2>err &
parent=$!
child=$(child_of $parent)
kill -KILL $parent
wait $parent 2>/dev/null
[ -n "$child" ] || fail "no reader was started"
outlives "$child" && fail "the child outlives its parent"
# STEP is read in a child without --sandbox, too. A shell's background processes ignore SIGINT unless it has job control.
if [ -e "$bin/../lib/forcelayer/forcelayer_step.so" ]; then
  printf 'ISO-10303-21;' >hang.step
  set -m
  LD_PRELOAD=$bin/fault_shim.so "$bin/pointshell" hang.step --voxel-size 20mm -o out.pshell 2>err &
  parent=$!
  set +m
  child=$(child_of $parent)
  [ -n "$child" ] || fail "no reader of STEP was started"
  kill -INT $parent
  wait $parent
  got=$?
  [ $got = 130 ] && [ ! -e out.pshell ] || fail "Ctrl-C while STEP is read: status $got: $(cat err)"
  outlives "$child" && fail "the reader of STEP outlives Ctrl-C"
fi

# A reader is refused all that it does not need: files elsewhere, to write, programs, the network, signals.
if "$bin/voxrun" doctor --clock 0 | grep -q 'confinement of plugins: Landlock.*seccomp'; then
  mkdir inside
  echo secret >secret.txt
  both 3 'nosy.stl: the reader of this file ended with status 32;' inside/nosy.stl
  [ "$(ls inside)" = nosy.stl ] || fail "a reader made $(ls inside)"
else
  echo "SKIPPED: this kernel confines no process"
fi

# Wrong limits.
expect 2 '--sandbox time: ' "$bin/voxelize" good.stl --units mm --voxel-size 20mm -o out.vox --sandbox=time=5
expect 2 '--sandbox memory: ' "$bin/voxelize" good.stl --units mm --voxel-size 20mm -o out.vox --sandbox=memory=1MiB
expect 2 "--sandbox: 'tme' is not a known name; the nearest known name is time" "$bin/voxelize" good.stl --units mm --voxel-size 20mm -o out.vox --sandbox=tme=5s
expect 2 '--sandbox-time: is an option of an earlier version; write --sandbox=time=LIMIT' "$bin/pointshell" good.stl --units mm --voxel-size 20mm -o out.pshell --sandbox-time 5s

finish
