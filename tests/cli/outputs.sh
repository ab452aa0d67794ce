#!/usr/bin/env bash
# Every output option of every command: a file that no command wrote stays, status 2 and one line. Inputs need not be
# there: outputs are looked at first. Links, folders, devices and pipes go on working.
set -u
bin=$FORCELAYER_BIN_DIR
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failed=0
fail() {
  echo "FAILED: $*" >&2
  failed=1
}

# keeps COMMAND...: with the word FILE in it, for a file, and for a link to one.
keeps() {
  local name
  [ -x "$bin/$1" ] || { echo "SKIPPED: $1 is not built"; return; }
  for name in mine linked; do
    echo "# a day of work" >mine
    ln -sf mine linked
    "$bin/$1" "${@:2}" >out 2>err </dev/null
    [ $? = 2 ] || fail "status of $*: $(cat err)"
    [ "$(wc -l <err)" = 1 ] && grep -q "already exists and is not" err || fail "$*: $(cat err)"
    [ "$(cat mine)" = "# a day of work" ] || fail "$* has replaced a file"
    set -- "${@//mine/linked}"
  done
}

printf 'v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >part.obj
printf 't_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0,0,1,1,0,0,0\n' >path.csv
mesh=(part.obj --units mm --voxel-size 1mm)
for option in -o --json; do
  keeps voxelize "${mesh[@]}" $([ $option = -o ] || echo -o new.vox) $option mine
  keeps pointshell "${mesh[@]}" $([ $option = -o ] || echo -o new.pshell) $option mine
  keeps voxplan no.vox no.pshell --clearance 1mm $([ $option = -o ] || echo -o new.csv) $option mine
done
keeps voxelize "${mesh[@]}" --plan --json mine
keeps voxelize --list part.obj --units mm --json mine
keeps pointshell verify no.pshell part.obj --units mm --json mine
keeps voxinfo no.vox --json mine
keeps voxinfo verify no.vox --json mine
keeps voxinfo sample no.vox --json mine
keeps voxinfo export no.vox mine
keeps voxinfo export no.vox new.ply --json mine
keeps voxinfo path path.csv --json mine
keeps voxinfo path path.csv -o mine
for report in json csv junit gitlab; do
  option="--report $report:mine"
  "$bin/voxcheck" --help 2>/dev/null | grep -q -e "--$report" && option="--$report mine"
  # shellcheck disable=SC2086
  keeps voxcheck no.vox no.pshell path.csv --clearance 1mm $option
done
for option in --json --trace --save-path --record; do
  keeps voxrun no.vox no.pshell --motion path.csv --as-fast-as-possible $option mine
done
keeps voxrun-doctor --json mine
keeps forcelayer --json mine
keeps forcelayer study 'no.glb#Pin' --voxel-size 1mm --clearance 1mm -o folder --json mine
keeps voxview part.obj --units mm --screenshot new.png --json mine

# A command replaces its own outputs, also through a link; a pipe and a device take what they are given.
ln -s real.json link.json
for _ in 1 2; do
  "$bin/voxelize" "${mesh[@]}" -o new.vox --json link.json --quiet || fail "its own files"
  "$bin/pointshell" "${mesh[@]}" -o new.pshell --method fast --quiet || fail "its own shell"
  "$bin/voxinfo" export new.vox new.ply --quiet && "$bin/voxinfo" export new.vox voxels.csv --quiet || fail "its own exports"
  "$bin/voxinfo" export new.pshell points.ply --quiet || fail "its own points"
  "$bin/voxinfo" path path.csv -o out.csv --quiet || fail "its own path"
done
[ -L link.json ] && grep -q schema_version real.json || fail "a link was replaced"
"$bin/voxinfo" new.vox --json /dev/stdout --quiet | grep -q schema_version || fail "a pipe"
"$bin/voxinfo" new.vox --json /dev/null --quiet || fail "a device"
echo "a log" >log
"$bin/voxinfo" new.vox --json /dev/stdout --quiet >>log && grep -q "a log" log && grep -q schema_version log || fail "a log"
mkdir folder
"$bin/voxinfo" new.vox --json folder --quiet 2>err
[ $? = 1 ] && grep -q "directory" err || fail "a folder: $(cat err)"

[ "$failed" = 0 ] && echo "all good"
exit "$failed"
