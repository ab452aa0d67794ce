#!/usr/bin/env bash
# The pointshell command as a user meets it: exit statuses, one line on stderr, no output left behind,
# and a shell that it proves itself and refuses once the mesh is another.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

# expect STATUS DESCRIPTION ARGUMENTS...: the exit status; for errors one line on stderr and no
# $work/out.pshell.
expect() {
  local status=$1 description=$2
  shift 2
  "$bin/pointshell" "$@" >"$work/stdout" 2>"$work/stderr"
  local actual=$?
  [ "$actual" -eq "$status" ] || fail "$description: status $actual instead of $status: $(cat "$work/stderr")"
  [ "$status" -eq 0 ] && return
  [ "$(wc -l <"$work/stderr")" -eq 1 ] || fail "$description: stderr is not one line: $(cat "$work/stderr")"
  grep -q '^pointshell: ' "$work/stderr" || fail "$description: stderr does not name the command"
  [ -z "$(find "$work" -name 'out*')" ] || fail "$description: left an output behind"
}

cat >"$work/box.obj" <<'OBJ'
v 0 0 0
v 10 0 0
v 0 20 0
v 10 20 0
v 0 0 30
v 10 0 30
v 0 20 30
v 10 20 30
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
OBJ
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\n' >"$work/points.obj"
box=("$work/box.obj" --units mm --quiet)
out=(-o "$work/out.pshell")

expect 0 "help" --help
expect 0 "version" --version
expect 2 "no arguments"
expect 2 "no output" "${box[@]}" --voxel-size 1mm
expect 2 "no voxel size" "${box[@]}" "${out[@]}"
expect 2 "voxel size without a unit" "${box[@]}" "${out[@]}" --voxel-size 1
expect 2 "negative voxel size" "${box[@]}" "${out[@]}" --voxel-size -1mm
for option in --voxel-size --covering-radius --mesh-deviation; do
  given=(--voxel-size 1mm)
  [ "$option" != --voxel-size ] || given=()
  for length in nanmm -infm 1e300m; do
    expect 2 "$option=$length" "${box[@]}" "${out[@]}" "${given[@]}" $option=$length
    grep -qE "^pointshell: $option: .*($length'? is (not a finite|longer than 1e9m)|is not a finite)" "$work/stderr" ||
      fail "$option is not named: $(cat "$work/stderr")"
  done
  [ "$option" != --mesh-deviation ] || continue
  for length in 1e-300m 1e-10m 1001km; do
    expect 2 "$option=$length" "${box[@]}" "${out[@]}" "${given[@]}" $option=$length
    grep -q "^pointshell: $option is not between" "$work/stderr" || fail "$(cat "$work/stderr")"
  done
done
expect 2 "no units" "$work/box.obj" "${out[@]}" --voxel-size 1mm
expect 2 "unknown unit" "$work/box.obj" "${out[@]}" --voxel-size 1mm --units parsec
expect 2 "unknown method" "${box[@]}" "${out[@]}" --voxel-size 1mm --method magic
expect 2 "old option" "${box[@]}" "${out[@]}" --voxel-size 1mm --effort fast
expect 2 "unknown option" "${box[@]}" "${out[@]}" --voxel-size 1mm --color
expect 2 "radius for voxel centers" "${box[@]}" "${out[@]}" --voxel-size 1mm --method voxel-centers --covering-radius 1mm
printf 'v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nf 1 2 3\n' >"$work/microscopic.obj"
expect 3 "microscopic mesh" "$work/microscopic.obj" "${out[@]}" --units m --voxel-size 1mm
grep -q "the part's area is too small for single precision; check --units" "$work/stderr" || fail "$(cat "$work/stderr")"
expect 1 "missing mesh" "$work/none.obj" "${out[@]}" --units mm --voxel-size 1mm
expect 1 "unwritable output" "${box[@]}" -o "$work/none/out.pshell" --voxel-size 1mm
expect 3 "mesh without triangles" "$work/points.obj" "${out[@]}" --units mm --voxel-size 1mm
expect 3 "too large" "${box[@]}" "${out[@]}" --voxel-size 1nm
expect 3 "too large for voxel centers" "${box[@]}" "${out[@]}" --voxel-size 1nm --method voxel-centers

# An open sheet is baked; all of them are in one line, and a shell without sides says so.
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 5 0 0\nv 6 0 0\nv 5 3 0\nf 1 2 3\nf 4 5 6\n' >"$work/sheets.obj"
"$bin/pointshell" "$work/sheets.obj" -o "$work/sheets.pshell" --units mm --voxel-size 0.1mm --json "$work/sheets.json" >"$work/stdout" 2>"$work/stderr" ||
  fail "sheets: $(cat "$work/stderr")"
[ "$(grep -c 'warning: 2 open sheets: sheets, 1 triangle, ' "$work/stderr")" -eq 1 ] || fail "sheets are not in one warning: $(cat "$work/stderr")"
"$bin/pointshell" verify "$work/sheets.pshell" "$work/sheets.obj" --units mm --quiet || fail "a shell of sheets is not proven again"
"$bin/voxinfo" "$work/sheets.pshell" --json "$work/facts.json" | grep -q 'open sheets' || fail "voxinfo says nothing of sheets"
python3 - "$work/sheets.json" "$work/facts.json" <<'PY' || fail "reports of sheets"
import json, sys
bake, facts = (json.load(open(name)) for name in sys.argv[1:])
assert [sheet["area_m2"] for sheet in bake["sheets"]] == sorted((sheet["area_m2"] for sheet in bake["sheets"]), reverse=True), bake
assert len(bake["sheets"]) == 2 and bake["mass_source"] == "area" and bake["two_sided_points"] == bake["points"], bake
assert facts["two_sided_points"] == bake["points"] and facts["version"] == "2.1", facts
assert any("2 open sheets" in line for line in bake["warnings"]), bake
PY
rm -f "$work"/sheets.*
# A solid that lacks a face has no volume: its mass is another one, and that is said.
sed '$d' "$work/box.obj" >"$work/lacking.obj"
expect 0 "a solid that lacks a face" "$work/lacking.obj" "${out[@]}" --units mm --voxel-size 1mm
grep -qxF 'pointshell: warning: the surface is not a closed solid, with 4 open edges: the mass is computed from the area' "$work/stderr" ||
  fail "nothing of the missing face: $(cat "$work/stderr")"
expect 0 "a solid" "$work/box.obj" "${out[@]}" --units mm --voxel-size 1mm
[ ! -s "$work/stderr" ] || fail "a closed solid: $(cat "$work/stderr")"
rm "$work/lacking.obj" "$work/out.pshell"
expect 2 "verify without a mesh" verify "$work/part.pshell"
expect 4 "verify of a mesh as shell" verify "$work/box.obj" "$work/box.obj" --units mm
expect 1 "verify of a missing shell" verify "$work/none.pshell" "$work/box.obj" --units mm

for method in surface fast voxel-centers; do
  part=$work/$method.pshell
  expect 0 "bake $method" "${box[@]}" -o "$part" --voxel-size 1mm --method $method --json "$work/$method.json"
  for key in points method covering_radius_m convex_radius_m convex_gap_m losses area_m2 voxel_size_m seconds total peak_rss_bytes; do
    grep -q "\"$key\"" "$work/$method.json" || fail "report of $method has no $key"
  done
  expect 0 "verify $method" verify "$part" "${box[@]}" --json "$work/verify.json"
  grep -q '"proven": true' "$work/verify.json" || fail "verify of $method reports no proof"
  # The mesh in another unit is another part.
  expect 4 "verify $method in centimeters" verify "$part" "$work/box.obj" --units cm
  cp "$part" "$work/damaged.pshell"
  printf 'x' | dd of="$work/damaged.pshell" bs=1 seek=2000 conv=notrunc status=none
  expect 4 "verify of a damaged $method" verify "$work/damaged.pshell" "${box[@]}"
done

# The same bytes for any number of threads, and from a file with its faces in another order.
{ grep '^v' "$work/box.obj"; grep '^f' "$work/box.obj" | tac; } >"$work/reordered.obj"
expect 0 "one thread" "${box[@]}" -o "$work/one.pshell" --voxel-size 1mm --threads 1
expect 0 "reordered" "$work/reordered.obj" --units mm --quiet -o "$work/two.pshell" --voxel-size 1mm --threads 2
cmp -s "$work/one.pshell" "$work/two.pshell" || fail "bytes depend on threads or the order of faces"
cmp -s "$work/one.pshell" "$work/surface.pshell" || fail "bytes depend on the run"

# Several meshes make one part. What lies inside another of them is left out, which needs both to be
# proven again; a sub-tree of an assembly is a part too.
sed -e 's/^v 0 /v -5 /; s/^v 10 /v 15 /' "$work/box.obj" |
  awk '$1 == "v" { $3 = $3 / 2 + 5; $4 = $4 / 3 + 10 } { print }' >"$work/bar.obj"
both=("$work/box.obj" "$work/bar.obj" --units mm --quiet)
expect 0 "two meshes" "${both[@]}" -o "$work/both.pshell" --voxel-size 1mm --json "$work/both.json"
grep -q '"bodies": 2' "$work/both.json" || fail "two meshes are not two bodies"
grep -Eq '"hidden_points": [1-9][0-9]' "$work/both.json" || fail "nothing inside another mesh was left out"
expect 0 "verify two meshes" verify "$work/both.pshell" "${both[@]}"
expect 4 "verify two meshes by one" verify "$work/both.pshell" "${box[@]}"
expect 0 "sub-tree" "$data/structure.glb#frame_1" --quiet -o "$work/frame.pshell" --voxel-size 10mm
expect 0 "verify the sub-tree" verify "$work/frame.pshell" "$data/structure.glb#frame_1" --quiet
expect 4 "verify the sub-tree by all" verify "$work/frame.pshell" "$data/structure.glb" --quiet

# Warnings go to stderr, the summary to stdout, and --quiet silences both.
"$bin/pointshell" "$work/box.obj" --units mm -o "$work/part.pshell" --voxel-size 1mm >"$work/stdout" 2>"$work/stderr" ||
  fail "bake with summary"
grep -q 'proven' "$work/stdout" || fail "no summary on stdout"
[ -s "$work/stderr" ] && fail "noise on stderr: $(cat "$work/stderr")"
"$bin/pointshell" "${box[@]}" -o "$work/part.pshell" --voxel-size 1mm >"$work/stdout" 2>&1
[ -s "$work/stdout" ] && fail "--quiet prints: $(cat "$work/stdout")"

# The sample part.
expect 0 "sample part" "$data/part.obj" --units mm --quiet -o "$work/sample.pshell" --voxel-size 5mm
expect 0 "verify the sample part" verify "$work/sample.pshell" "$data/part.obj" --units mm

for size in 1e7m 1e-10m; do
  "$bin/pointshell" "$data/part.obj" --units mm --voxel-size $size -o no.pshell --quiet 2>err
  [ $? = 2 ] && grep -q 'voxel-size is not between 1e-9 and 1e6 meters' err || fail "a voxel of $size: $(cat err)"
done

# The report of a failure has the warnings before it.
"$bin/pointshell" "$data/part.obj" --units mm --voxel-size 0.5um -o no.pshell --quiet --json no.json 2>err
[ $? = 3 ] && [ ! -e no.pshell ] || fail "a shell too large: $(cat err)"
python3 -c 'import json; r = json.load(open("no.json")); assert r["exit_status"] == 3 and any("minutes" in w for w in r["warnings"]), r' ||
  fail "a failure without its warnings"

finish
