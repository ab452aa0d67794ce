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
"$voxinfo" "$golden/v1.vox" --json vox.json >facts
grep -q '262145 interior, 4098 surface, 4097 proximity' facts || fail "facts of v1.vox"
expect_equal counts "$(value vox.json '["counts"]["surface"]')" 4098
expect_equal origin "$(value vox.json '["origin_voxel"]')" "[-514, 0, -8]"
expect_equal dims "$(value vox.json '["dims"]')" "[84, 70, 72]"
expect_equal layers "$(value vox.json '["layers"]')" 2
expect_equal size "$(value vox.json '["voxel_size_m"]')" 0.0025
expect_equal sides "$(value vox.json '["cropped_sides"]')" "['max_x']"
expect_equal provenance "$(value vox.json '["provenance"]["inputs"]')" "[]"
"$voxinfo" "$golden/v1.pshell" --json shell.json >facts
grep -q 'points            100' facts || fail "facts of v1.pshell"
expect_equal points "$(value shell.json '["points"]')" 100
expect_equal radius "$(value shell.json '["covering_radius_m"]')" 0.002
expect_equal method "$(value shell.json '["method"]')" surface
"$voxinfo" "$golden/v1.vox" --json /dev/stdout --quiet >stdout.json
cmp stdout.json vox.json || fail "--json /dev/stdout"
expect_equal version "$("$voxinfo" --version | cut -d' ' -f1)" voxinfo

# An independent reader sees the same voxels and points, in every kind that voxelize bakes too.
scenes="v1 v1_wide baked_chebyshev baked_euclidean baked_distance4 baked_distance8 baked_covered8"
for scene in $scenes; do
  "$voxinfo" verify "$golden/$scene.vox" --quiet
  "$voxinfo" export "$golden/$scene.vox" "$scene.csv"
  { echo i,j,k,value; reader "$golden/$scene.vox" --rows; } | cmp - "$scene.csv" || fail "$scene.csv"
done
"$voxinfo" verify "$golden/v1.pshell" | grep -q valid || fail "verify v1.pshell"
"$voxinfo" export "$golden/v1.pshell" shell.ply
reader "$golden/v1.pshell" --rows >rows
"$python" - <<'PYTHON' || fail shell.ply
import struct
data = open("shell.ply", "rb").read()
body = data[data.index(b"end_header\n") + 11:]
rows = [[float(x) for x in line.split(",")] for line in open("rows")]
assert len(body) == 44 * len(rows), len(body)
assert [list(row) for row in struct.iter_unpack("<3d4fI", body)] == rows
PYTHON

# Faces of the force layer: as many as the voxels' sides that face something else, wound outwards.
"$voxinfo" export "$golden/v1.vox" faces.ply
"$python" - <<'PYTHON' || fail faces.ply
import re, struct
data = open("faces.ply", "rb").read()
head, body = data.split(b"end_header\n", 1)
vertices, faces = (int(n) for n in re.findall(rb"element \w+ (\d+)", head))
points = [tuple(round(c / 0.0025) for c in row) for row in struct.iter_unpack("<3d", body[:24 * vertices])]
layer = {tuple(int(n) for n in line.split(",")[:3]) for line in open("v1.csv") if line.endswith(",2\n")}
expected = sum((i + a, j + b, k + c) not in layer for i, j, k in layer
               for a, b, c in [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
quads = list(struct.iter_unpack("<B4i", body[24 * vertices:]))
assert faces == len(quads) == expected, (faces, expected)
for four, *corners in quads:
    p = [points[c] for c in corners]
    u, v = ([b - a for a, b in zip(p[0], p[n])] for n in (1, 3))
    normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    low = [min(q[axis] for q in p) for axis in range(3)]
    inside = tuple(l - (n > 0) for l, n in zip(low, normal))
    outside = tuple(l - (n < 0) for l, n in zip(low, normal))
    assert four == 4 and inside in layer and outside not in layer, p
PYTHON

# .vdb: the same voxels, where this build can write it.
if [ -x "$FORCELAYER_BIN_DIR/vdb_rows" ]; then
  for scene in $scenes; do
    "$voxinfo" export "$golden/$scene.vox" "$scene.vdb"
    size=$(reader "$golden/$scene.vox" | "$python" -c 'import json,sys; print(json.load(sys.stdin)["voxel_size_m"])')
    "$FORCELAYER_BIN_DIR/vdb_rows" "$scene.vdb" "$size" | LC_ALL=C sort >vdb_rows
    tail -n +2 "$scene.csv" | LC_ALL=C sort | cmp - vdb_rows || fail "$scene.vdb"
  done
else
  expect_refused 2 "no OpenVDB" "$voxinfo" export "$golden/v1.vox" scene.vdb
fi

# Values at points: inside, force layer, proximity, free, outside, on a voxel's lower face.
printf '%s\n' '-1.25 0.1 0.1' '-1.2812 0.1 0.1' '-1.2838,0.1,0.1' '0 0 0' '' '+1e30 0 0' '-1.28 0.1 0.1' |
  "$voxinfo" sample "$golden/v1.vox" >values 2>warning
expect_equal samples "$(paste -sd' ' values)" "1 2 3 0 0 1"
grep -q '2 points lie beyond a cropped side' warning || fail "no warning: $(cat warning)"
expect_equal "no input" "$("$voxinfo" sample "$golden/v1.vox" </dev/null)" ""
for line in '1 2' '1 2 3 4' '1 2 x' '1 2 nan' '1 2 inf' '1 2 3mm'; do
  printf '0 0 0\n%s\n' "$line" >points
  status=0
  "$voxinfo" sample "$golden/v1.vox" <points >out 2>err || status=$?
  expect_equal "status of '$line'" "$status" 2
  grep -q 'input line 2' err || fail "'$line': $(cat err)"
done

# Wrong usage, missing files, other files, damaged files.
expect_refused 2 "no file given" "$voxinfo"
expect_refused 2 "--color" "$voxinfo" "$golden/v1.vox" --color
expect_refused 2 "FILE" "$voxinfo" verify
expect_refused 2 ".csv, .ply or .vdb" "$voxinfo" export "$golden/v1.vox" scene.stl
expect_refused 2 "exported to .ply" "$voxinfo" export "$golden/v1.pshell" shell.csv
expect_refused 1 "no such file" "$voxinfo" missing.vox
expect_refused 1 "folder" "$voxinfo" verify "$golden"
expect_refused 1 "no/such/folder" "$voxinfo" export "$golden/v1.vox" no/such/folder/out.csv
expect_refused 4 "this is a .pshell" "$voxinfo" sample "$golden/v1.pshell"
printf 'VOX \226\0\0\0MAIN' >magica.vox
expect_refused 4 "MagicaVoxel" "$voxinfo" magica.vox
: >empty.pshell
expect_refused 4 "empty" "$voxinfo" empty.pshell
head -c 1000 "$golden/v1.vox" >cut.vox
expect_refused 4 "cut off" "$voxinfo" cut.vox
{ cat "$golden/v1.vox"; echo; } >longer.vox
expect_refused 4 "appended" "$voxinfo" verify longer.vox
cp "$golden/v1.vox" damaged.vox
printf '\377' | dd of=damaged.vox bs=1 seek=11000 conv=notrunc status=none
expect_refused 4 "damaged" "$voxinfo" verify damaged.vox

# A fact that is not true, under right checksums: one surface voxel too many.
if "$python" - "$golden/v1.vox" liar.vox <<'PYTHON'
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

# A file that could not be written is not there, and an old file stays.
echo old >old.csv
expect_refused 4 "cut off" "$voxinfo" export cut.vox old.csv
expect_equal "old file" "$(cat old.csv)" old
(ulimit -f 100; expect_refused 1 "cannot be written" "$voxinfo" export "$golden/v1.vox" old.csv; exit $failed) || failed=1
expect_equal "old file" "$(cat old.csv)" old
expect_equal "temporaries" "$(find . -name '*.tmp')" ""

# A signal in the middle of an export.
mkfifo pipe.csv
"$voxinfo" export "$golden/v1.vox" pipe.csv &
exporting=$!
exec 3<pipe.csv  # the export is blocked in its first write: more than a pipe holds
kill -TERM $exporting
status=0
wait $exporting || status=$?
exec 3<&-
expect_equal "status on SIGTERM" "$status" 143

exit $failed
