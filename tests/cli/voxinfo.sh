#!/usr/bin/env bash
# voxinfo as a user meets it: facts, verify, sample, export, and what it says about files that are
# not what they should be. The exports are compared with an independent reader of the formats.
set -euo pipefail
voxinfo=$FORCELAYER_BIN_DIR/voxinfo
golden=$FORCELAYER_SOURCE_DIR/tests/golden
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

failed=0
fail() { echo "FAILED: $*" >&2; failed=1; }
expect_equal() { [ "$2" = "$3" ] || fail "$1: '$2' instead of '$3'"; }

# expect_refused STATUS TEXT COMMAND...: the status, one line on stderr that holds TEXT, no output.
expect_refused() {
  local status=$1 text=$2 actual=0
  shift 2
  "$@" >out 2>err </dev/null || actual=$?
  expect_equal "status of $*" "$actual" "$status"
  expect_equal "lines on stderr of $*" "$(wc -l <err)" 1
  expect_equal "bytes on stdout of $*" "$(wc -c <out)" 0
  grep -qF -- "$text" err || fail "$*: '$(cat err)' does not say '$text'"
}

python=python3
for candidate in python3 /usr/bin/python3; do  # one with xxhash, to compare checksums too
  "$candidate" -c 'import xxhash' 2>/dev/null && { python=$candidate; break; }
done
reader() { "$python" "$golden/read_baked_file.py" "$@"; }
value() { "$python" -c 'import json,sys; print(eval("r" + sys.argv[2], {"r": json.load(open(sys.argv[1]))}))' "$@"; }

# Facts, for people and for programs.
"$voxinfo" "$golden/v2.vox" --json vox.json >facts
grep -q '4097 interior, 1762 surface, 2266 proximity' facts || fail "facts of v2.vox"
expect_equal counts "$(value vox.json '["counts"]["surface"]')" 1762
expect_equal origin "$(value vox.json '["origin_voxel"]')" "[-514, 6, 6]"
expect_equal dims "$(value vox.json '["dims"]')" "[47, 37, 37]"
expect_equal layers "$(value vox.json '["layers"]')" 1
expect_equal size "$(value vox.json '["voxel_size_m"]')" 0.0025
expect_equal sides "$(value vox.json '["cropped_sides"]')" "['max_x']"
expect_equal provenance "$(value vox.json '["provenance"]["inputs"]')" "[]"
grep -q 'distances         none' facts || fail "v2.vox has no distances"
"$voxinfo" "$golden/v2_distances.vox" --objects --json full.json >facts
grep -q 'force             begins 2.867 mm off the mesh, in a layer 1 mm deep' facts || fail "force: $(cat facts)"
grep -q 'distances         from -3.938 to 4 mm in steps of 0.0312 mm, 560 bytes' facts || fail "distances: $(cat facts)"
grep -q 'objects           2; the nearest objects are stored in 1040 bytes' facts || fail "objects: $(cat facts)"
# The number of each object's voxels with a measured distance.
of_object() {
  LC_ALL=C join -t' ' <(reader "$golden/$1.vox" --objects | sed 's/,\([0-9]*\)$/ \1/' | LC_ALL=C sort) \
    <(reader "$golden/$1.vox" --distances | sed 's/,\([0-9]*\)$/ \1/' | LC_ALL=C sort) |
    awk -v object="$2" '$2 == object && $3 > 0' | wc -l
}
left=$(of_object v2_distances 1)
right=$(of_object v2_distances 2)
[ "$left" -gt 100 ] && [ "$right" -gt 100 ] || fail "too few voxels: $left and $right"
grep -qP "^  object 1\t$left voxels\tleft$" facts || fail "object 1: $(cat facts)"
expect_equal "object 2" "$(value full.json '["objects"][1]')" "{'name': 'right', 'voxels': $right}"
"$voxinfo" "$golden/baked_objects.vox" --objects >facts
grep -qP "^  object 1\t$(of_object baked_objects 1) voxels\twedge$" facts || fail "the wedge: $(cat facts)"
grep -qP "^  object 2\t$(of_object baked_objects 2) voxels\tsheet$" facts || fail "the sheet: $(cat facts)"
expect_equal "objects" "$(value full.json '["object_count"]')" 2
expect_equal "zero force" "$(value full.json '["zero_force_m"]')" 0.0028671875
"$voxinfo" "$golden/v2_distances.vox" | grep -q '  object 1' && fail "objects without --objects"
expect_refused 2 "a part has no objects" "$voxinfo" "$golden/v2.pshell" --objects
"$voxinfo" "$golden/v2.pshell" --json shell.json >facts
grep -q 'points            100' facts || fail "facts of v2.pshell"
expect_equal points "$(value shell.json '["points"]')" 100
expect_equal radius "$(value shell.json '["covering_radius_m"]')" 0.002
expect_equal method "$(value shell.json '["method"]')" surface
expect_equal "convex radius" "$(value shell.json '["convex_radius_m"]')" 0.00175
expect_equal "convex gap" "$(value shell.json '["convex_gap_m"]')" 0.00025
expect_equal losses "$(value shell.json '["losses"][2]["loss_m"]')" 0.0005
# The reader in Python and the command prove the same distance of the surface.
reader "$golden/v2.pshell" >header.json
proven=$(value header.json '["surface_distance_of_2_voxels_m"]')
grep -q "proven distance   $("$python" -c "print('%.6g' % $proven)") m" facts || fail "proven distance"
"$voxinfo" "$golden/v2.vox" --json /dev/stdout --quiet >stdout.json
cmp stdout.json vox.json || fail "--json /dev/stdout"
expect_equal version "$("$voxinfo" --version | cut -d' ' -f1)" voxinfo

# An independent reader sees the same voxels and points, in every kind that voxelize bakes too.
scenes="v2 v2_distances baked_chebyshev baked_lean baked_full baked_covered baked_objects"
for scene in $scenes; do
  "$voxinfo" verify "$golden/$scene.vox" --quiet
  "$voxinfo" export "$golden/$scene.vox" "$scene.csv"
  { echo i,j,k,value; reader "$golden/$scene.vox" --rows; } | cmp - "$scene.csv" || fail "$scene.csv"
done
expect_equal verify "$("$voxinfo" verify "$golden/v2.vox" | cut -d: -f2-)" \
  " valid: structure and checksums are correct; counts, box, clearances and layers are correct"
expect_equal verify "$("$voxinfo" verify "$golden/v2_distances.vox" | cut -d, -f3-)" \
  " clearances and layers are correct, distances are plausible, objects exist"
"$voxinfo" verify "$golden/v2.pshell" | grep -q valid || fail "verify v2.pshell"
"$voxinfo" export "$golden/v2.pshell" shell.ply
reader "$golden/v2.pshell" --rows >rows
"$python" - <<'PYTHON' || fail shell.ply
import struct
data = open("shell.ply", "rb").read()
body = data[data.index(b"end_header\n") + 11:]
rows = [[float(x) for x in line.split(",")] for line in open("rows")]
assert len(body) == 44 * len(rows), len(body)
assert [list(row) for row in struct.iter_unpack("<3d4fI", body)] == rows
PYTHON

# .vdb: the same voxels, distances and objects in grids of OpenVDB's own types, where this build can
# write them.
if [ -x "$FORCELAYER_BIN_DIR/vdb_rows" ]; then
  for scene in $scenes; do
    "$voxinfo" export "$golden/$scene.vox" "$scene.vdb"
    size=$(reader "$golden/$scene.vox" | "$python" -c 'import json,sys; print(json.load(sys.stdin)["voxel_size_m"])')
    "$FORCELAYER_BIN_DIR/vdb_rows" "$scene.vdb" "$size" voxmap | LC_ALL=C sort >vdb_rows
    tail -n +2 "$scene.csv" | LC_ALL=C sort | cmp - vdb_rows || fail "$scene.vdb"
  done
  full=$golden/v2_distances.vox
  "$FORCELAYER_BIN_DIR/vdb_rows" v2_distances.vdb 0.001 object | LC_ALL=C sort >vdb_rows
  reader "$full" --objects | LC_ALL=C sort | cmp - vdb_rows || fail "objects in .vdb"
  # Distances in meters: of code c, (c - 127) / 32 voxels of 1 mm, to the precision of a float.
  "$FORCELAYER_BIN_DIR/vdb_rows" v2_distances.vdb 0.001 distance_m |
    awk -F, -v OFS=, '{ print $1, $2, $3, int($4 * 32000 + 127.5) }' | LC_ALL=C sort >vdb_rows
  reader "$full" --distances | LC_ALL=C sort | cmp - vdb_rows || fail "distances in .vdb"
  status=0
  "$FORCELAYER_BIN_DIR/vdb_rows" v2.vdb 0.0025 distance_m || status=$?
  expect_equal "a lean scene has no distances" "$status" 3
else
  expect_refused 2 "no OpenVDB" "$voxinfo" export "$golden/v2.vox" scene.vdb
fi

# Values at points: inside, force layer, proximity, free, outside, on a voxel's lower face.
printf '%s\n' '-1.25 0.04 0.04' '-1.2812 0.04 0.04' '-1.2838,0.04,0.04' '-1.3 0 0' '0 0 0' '' '+1e30 0 0' '-1.28 0.04 0.04' |
  "$voxinfo" sample "$golden/v2.vox" >values 2>warning
expect_equal samples "$(paste -sd' ' values)" "1 2 3 0 0 0 1"
grep -q '2 points are beyond a cropped side' warning || fail "no warning: $(cat warning)"
# Value, least and most distance of the voxel's center, nearest object: the voxels (3, 3, 3), (1, 3, 3)
# and (7, 7, 7), one beside the brick, and one outside of the directory.
printf '%s\n' '.0035 .0035 .0035' '.0015 .0035 .0035' '.0075 .0075 .0075' '.01 0 0' '-1 0 0' |
  "$voxinfo" sample "$golden/v2_distances.vox" >values
"$python" - <<'PYTHON' || fail "distances of samples: $(cat values)"
rows = [line.rstrip("\n").split("\t") for line in open("values")]
bounds = [(127, 128, "1", ["left"]), (191, 192, "2", ["left"]), (255, None, "3", ["right", "hint"]),
          (255, None, "0", [""]), (255, None, "0", [""])]
for row, (least, most, value, name) in zip(rows, bounds, strict=True):
    # The most takes in the writer's error, 0.002 voxel.
    expected = [(least - 127) * (0.001 / 32),
                (most - 127) * (0.001 / 32) + 0.002 * 0.001 if most else float("inf")]
    assert row[0] == value and row[3:] == name, row
    assert [float(number) for number in row[1:3]] == expected, row
PYTHON
expect_equal "no input" "$("$voxinfo" sample "$golden/v2.vox" </dev/null)" ""
for line in '1 2' '1 2 3 4' '1 2 x' '1 2 nan' '1 2 inf' '1 2 3mm'; do
  printf '0 0 0\n%s\n' "$line" >points
  status=0
  "$voxinfo" sample "$golden/v2.vox" <points >out 2>err || status=$?
  expect_equal "status of '$line'" "$status" 2
  grep -q 'input line 2' err || fail "'$line': $(cat err)"
done

# Wrong usage, missing files, other files, damaged files.
expect_refused 2 "no file given" "$voxinfo"
expect_refused 2 "--color" "$voxinfo" "$golden/v2.vox" --color
expect_refused 2 "FILE" "$voxinfo" verify
expect_refused 2 ".stl, .glb, .ply, .csv or .vdb" "$voxinfo" export "$golden/v2.vox" scene.xyz
expect_refused 2 "exported to .ply" "$voxinfo" export "$golden/v2.pshell" shell.csv
expect_refused 1 "no such file" "$voxinfo" missing.vox
expect_refused 1 "folder" "$voxinfo" verify "$golden"
expect_refused 1 "no/such/folder" "$voxinfo" export "$golden/v2.vox" no/such/folder/out.csv
expect_refused 4 "this is a .pshell" "$voxinfo" sample "$golden/v2.pshell"
printf 'VOX \226\0\0\0MAIN' >magica.vox
expect_refused 4 "MagicaVoxel" "$voxinfo" magica.vox
: >empty.pshell
expect_refused 4 "empty" "$voxinfo" empty.pshell
head -c 1000 "$golden/v2.vox" >cut.vox
expect_refused 4 "cut off" "$voxinfo" cut.vox
{ cat "$golden/v2.vox"; echo; } >longer.vox
expect_refused 4 "appended" "$voxinfo" verify longer.vox
cp "$golden/v2.vox" damaged.vox
printf '\377' | dd of=damaged.vox bs=1 seek=11000 conv=notrunc status=none
expect_refused 4 "damaged" "$voxinfo" verify damaged.vox

# A fact that is not true, under right checksums: one surface voxel too many.
if "$python" - "$golden/v2.vox" liar.vox <<'PYTHON'
import struct, sys
try:
    import xxhash
except ImportError:
    sys.exit(1)
data = bytearray(open(sys.argv[1], "rb").read())
struct.pack_into("<Q", data, 232, struct.unpack_from("<Q", data, 232)[0] + 1)
struct.pack_into("<Q", data, 48, 0)
front = 384 + 32 * struct.unpack_from("<I", data, 20)[0]
struct.pack_into("<Q", data, 48, xxhash.xxh3_64_intdigest(bytes(data[:front])))
open(sys.argv[2], "wb").write(data)
PYTHON
then
  "$voxinfo" liar.vox --quiet
  expect_refused 4 "surface_voxels" "$voxinfo" verify liar.vox
fi

# A resampling of more rows than a path has is refused, before it takes their memory.
printf 't_s,x_m,y_m,z_m\n0,0,0,0\n200,1,0,0\n' >path.csv
addresses_kib=1000000
grep -aq __asan_init "$voxinfo" && addresses_kib=unlimited  # a sanitizer holds terabytes of them
(ulimit -v $addresses_kib; expect_refused 2 "more than 100 million rows" "$voxinfo" path path.csv --resample 1us -o fine.csv; exit $failed) || failed=1
"$voxinfo" path path.csv --resample 10s -o coarse.csv >out || fail "resample: $(cat out)"
expect_equal "rows of 10 s" "$(wc -l <coarse.csv)" 22

# All rows stay, so that no dip is lost.
printf 't_s,x_mm,y_mm,z_mm\n0,0,0,30\n1,0,0,4\n2,0,0,30\n' >dip.csv
"$voxinfo" path dip.csv --resample 375ms -o dips.csv >out || fail "resample: $(cat out)"
expect_equal "times" "$(cut -d, -f1 dips.csv | paste -sd,)" t_s,0,0.375,0.75,1,1.125,1.5,1.875,2
expect_equal "the dip" "$(sed -n 5p dips.csv)" 1,0,0,0.004,1,0,0,0
# A part that turns about its frame's origin: with --part the path is that of its centroid, which moves straight between rows,
# without it the origin's, and that this is not how voxcheck moves it.
printf 't_s,x_m,y_m,z_m,rz_deg\n0,0,0,0,0\n1,0,0,0,90\n' >pivot.csv
"$voxinfo" path pivot.csv >out
grep -q "the frame's origin travels 0 m and turns 1.5708 rad" out || fail "origin: $(cat out)"
"$voxinfo" path pivot.csv --part "$golden/v2.pshell" --json pivot.json >out
python3 - "$golden/v2.pshell" <<'PYTHON' || fail "centroid: $(cat out)"
import json, math, re, subprocess, sys
report = json.load(open("pivot.json"))
x, y, z = report["point_m"]
way_m = math.sqrt(2) * math.hypot(x, y)
assert way_m > 1e-3 and abs(report["length_m"] - way_m) < 1e-12 and report["high_m"][2] == report["low_m"][2], report
told = re.search("the centroid travels ([0-9.]+) m", open("out").read())[1]
assert abs(float(told) - way_m) < 1e-5 * way_m, told
PYTHON
"$voxinfo" path pivot.csv --part "$golden/v2.pshell" --resample 500ms -o straight.csv >out 2>err
expect_equal "no warning" "$(cat err)" ""
"$voxinfo" path pivot.csv --resample 500ms -o about.csv --json about.json >out 2>err
grep -q "^voxinfo: warning: in the new rows the part's origin moves in straight lines, but .*; add --part" err || fail "origin: $(cat err)"
grep -q 'add --part to match voxcheck' about.json || fail "the report does not warn"
expect_equal "the origin" "$(sed -n 3p about.csv | cut -d, -f1-4)" 0.5,0,0,0
[ "$(sed -n 3p straight.csv | cut -d, -f1-4)" != 0.5,0,0,0 ] || fail "the centroid does not go straight"
"$voxinfo" path path.csv --resample 10s -o coarse.csv --quiet 2>err
expect_equal "no warning without turns" "$(cat err)" ""
expect_refused 2 "leave it out: the path is that of the part" "$voxinfo" path pivot.csv --of handle
# Other files are named by their kind.
expect_refused 2 "is a .vox" "$voxinfo" path "$golden/v2.vox"
expect_refused 2 "is JSON" "$voxinfo" path pivot.json

# A file that could not be written is not there, and an old file stays.
echo i,j,k,value >old.csv
expect_refused 4 "cut off" "$voxinfo" export cut.vox old.csv
expect_equal "old file" "$(cat old.csv)" i,j,k,value
(ulimit -f 100; expect_refused 1 "cannot be written" "$voxinfo" export "$golden/v2.vox" old.csv; exit $failed) || failed=1
expect_equal "old file" "$(cat old.csv)" i,j,k,value
expect_equal "temporaries" "$(find . -name '*.tmp')" ""

# A file of 3 MB whose nodes repeat one brick 29 billion times: whoever would visit them all refuses.
"$FORCELAYER_BIN_DIR/make_runtime_files" .
for call in "export repeated.vox r.csv" "repeated.vox --objects" "verify repeated.vox"; do
  expected="2 repeated nodes are read"
  [ "$call" = "verify repeated.vox" ] && expected="4 surface_voxels"
  expect_refused "${expected%% *}" "${expected#* }" "$voxinfo" $call
done
"$voxinfo" export repeated.vox r.vdb >out 2>err && fail "grids of 15 trillion voxels"
grep -qE "GB of memory|repeated nodes are read|no OpenVDB" err || fail "r.vdb: $(cat err)"
compgen -G 'r.*' && fail "a refused export left a file"

# A signal in the middle of an export.
mkfifo pipe.csv
"$voxinfo" export "$golden/v2.vox" pipe.csv &
exporting=$!
exec 3<pipe.csv  # the export is blocked in its first write: more than a pipe holds
kill -TERM $exporting
status=0
wait $exporting || status=$?
exec 3<&-
expect_equal "status on SIGTERM" "$status" 143

exit $failed
