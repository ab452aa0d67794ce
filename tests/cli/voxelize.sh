#!/usr/bin/env bash
# voxelize as a user meets it: outputs, exit statuses, one-line errors, nothing left behind.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

# expect STATUS TEXT ARGUMENTS...: voxelize ends with STATUS, one line on stderr that holds TEXT, and
# no scene.vox.
expect() {
  local status=$1 text=$2
  shift 2
  rm -f scene.vox
  "$bin/voxelize" "$@" >out 2>err
  local got=$?
  [ $got = "$status" ] || fail "status $got instead of $status: voxelize $*: $(cat err)"
  [ "$(wc -l <err)" = 1 ] || fail "not one line on stderr: voxelize $*: $(cat err)"
  grep -qF -- "$text" err || fail "no '$text' on stderr: voxelize $*: $(cat err)"
  [ ! -e scene.vox ] || fail "an output file was left: voxelize $*"
  [ -z "$(ls -A | grep -v -E '^(out|err|cube.obj|scene.json|kept.vox|report.json|.*\.(stl|json))$')" ] ||
    fail "files were left behind: $(ls -A)"
}

# A closed cube of 1 unit, and meshes and manifests that are wrong.
cat >cube.obj <<'EOF'
v 0 0 0
v 1 0 0
v 0 1 0
v 1 1 0
v 0 0 1
v 1 0 1
v 0 1 1
v 1 1 1
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
EOF
printf 'solid nothing\nendsolid nothing\n' >empty.stl

# Valid calls.
"$bin/voxelize" cube.obj --units cm --voxel-size 1mm --kind paper -o scene.vox --json report.json >out 2>err || fail "cube: $(cat err)"
[ -s err ] && fail "noise on stderr in a pipe: $(cat err)"
"$bin/voxinfo" verify scene.vox >out || fail "the scene is not valid"
python3 - report.json <<'EOF' || fail "report"
import json, sys
r = json.load(open(sys.argv[1]))
assert r["voxel_size_m"] == 0.001 and r["layers"] == 2 and r["triangles"] == 12, r
assert r["origin_voxel"] == [-3, -3, -3] and r["dims"] == [17, 17, 17], r
assert abs(r["origin_m"][0] + 0.003) < 1e-12, r
# Faces on voxel faces mark one layer: the cube's surface lies in voxels 0 and 10.
assert r["counts"]["interior"] == 13**3, r
assert r["counts"]["surface"] == 15**3 - 13**3, r
assert r["counts"]["proximity"] == 17**3 - 15**3, r
assert r["parts"][0]["interior_voxels"] == 9**3 and r["parts"][0]["name"] == "cube", r
assert r["file_bytes"] > 0 and r["peak_rss_bytes"] > 0 and r["threads"] > 0, r
for stage in ["read", "scan", "flood", "tree", "write", "total"]: assert r["seconds"][stage] >= 0, r
EOF
printf '0.005 0.005 0.005\n-0.0025 0.005 0.005\n-0.0015 0.005 0.005\n-0.0035 0.005 0.005\n' |
  "$bin/voxinfo" sample scene.vox >out || fail "sample"
[ "$(tr '\n' ' ' <out)" = "1 3 2 0 " ] || fail "wrong values along x: $(cat out)"

"$bin/voxelize" cube.obj --units cm --voxel-size 1mm --kind paper -o kept.vox --quiet --threads 3 >out 2>err || fail "quiet run"
[ -s out ] || [ -s err ] && fail "--quiet prints"
cmp -s scene.vox kept.vox || fail "another number of threads gives other bytes"

# A free seed opens the cube.
"$bin/voxelize" cube.obj --units cm --voxel-size 1mm -o scene.vox --quiet --free-seed 5mm,5mm,5mm || fail "free seed"
echo '0.005 0.005 0.005' | "$bin/voxinfo" sample scene.vox >out
[ "$(cut -f1 out)" = 0 ] || fail "the free seed opened nothing"

# By default layers are Euclidean: the interior is what has its center less than 1.867 voxels from the
# cube, 14^3 voxels but for the rows along its twelve edges; and distances are stored, from the mesh.
for kind in "" "--kind lean"; do
  "$bin/voxelize" cube.obj --units cm --voxel-size 1mm -o scene.vox --quiet $kind --json report.json || fail "bake $kind"
  "$bin/voxinfo" verify scene.vox --quiet || fail "the scene $kind is not valid"
  python3 - report.json "$kind" <<'EOF' || fail "report $kind"
import json, sys
r = json.load(open(sys.argv[1]))
assert r["metric"] == "euclidean" and r["distances"] == (sys.argv[2] == "") and r["layers"] == 2, r
assert r["counts"]["interior"] == 14**3 - (12 * 14 - 2 * 8), r
EOF
  "$bin/voxinfo" scene.vox --json report.json >out
  grep -q 'force             begins 2.867 mm' out || fail "facts $kind: $(cat out)"
  grep -q "distances         $([ -n "$kind" ] && echo none || echo from)" out || fail "distances $kind: $(cat out)"
  printf '0.005 0.005 0.005\n-0.0015 0.005 0.005\n-0.0025 0.005 0.005\n-0.0035 0.005 0.005\n-0.0045 0.005 0.005\n' |
    "$bin/voxinfo" sample scene.vox >out || fail "sample"
  [ "$(cut -f1 out | tr '\n' ' ')" = "1 1 2 3 0 " ] || fail "wrong values along x $kind: $(cat out)"
done

# A soft covering: the zero force lies its depth above the interior, and the file has its table.
"$bin/voxelize" cube.obj --units cm --voxel-size 1mm -o scene.vox --quiet --compliance 1mm:500Pa,3mm:4kPa || fail "soft covering"
"$bin/voxinfo" verify scene.vox --quiet || fail "the scene with a soft covering is not valid"
"$bin/voxinfo" scene.vox --json report.json >out
grep -q 'compliance        4 kPa at a depth of 3' out || fail "facts of a soft covering: $(cat out)"
python3 - report.json <<'EOF' || fail "report of a soft covering"
import json, sys
r = json.load(open(sys.argv[1]))
c = r["compliance"]
assert c["pressure_pa"] == 4000 and abs(c["depth_m"] - 0.003) <= r["distances"]["quantum_m"], r
assert abs(c["steepest_pa_per_m"] - 1.75e6) < 1e3, c
assert abs(r["zero_force_m"] - 0.0048672) < 1e-6 and r["force_depth_m"] == 0.003, r
assert r["provenance"]["compliance"] == [{"depth_m": 0.001, "pressure_pa": 500}, {"depth_m": 0.003, "pressure_pa": 4000}], r
EOF
printf '0.005 0.005 0.005\n-0.0015 0.005 0.005\n-0.0035 0.005 0.005\n-0.0045 0.005 0.005\n-0.0055 0.005 0.005\n-0.0065 0.005 0.005\n' |
  "$bin/voxinfo" sample scene.vox >out || fail "sample"
[ "$(cut -f1 out | tr '\n' ' ')" = "1 1 2 2 3 0 " ] || fail "wrong values along x under a soft covering: $(cat out)"

# A manifest, the sample scene, a folder.
cat >scene.json <<'EOF'
{"voxel_size": "1mm", "layers": 1,
 "parts": [{"name": "a", "mesh": "cube.obj", "units": "cm"},
           {"name": "b", "mesh": "cube.obj", "units": "cm", "translation": ["3cm", 0, 0],
            "rotation": [0.7071067811865476, 0, 0, 0.7071067811865476], "scale": [1, 2, 1]}]}
EOF
"$bin/voxelize" scene.json --kind paper -o scene.vox --json report.json --quiet || fail "manifest"
python3 - report.json <<'EOF' || fail "manifest report"
import json, sys
r = json.load(open(sys.argv[1]))
assert [p["name"] for p in r["parts"]] == ["a", "b"], r
# b spans x 10..30 mm (its y, doubled and turned), y 0..10 mm.
assert r["origin_voxel"] == [-2, -2, -2] and r["layers"] == 1, r
assert r["dims"][0] in (34, 35) and r["dims"][1] in (15, 16) and r["dims"][2] == 15, r
EOF
"$bin/voxelize" "$data/bay.json" -o scene.vox --voxel-size 20mm --quiet || fail "sample scene"
"$bin/voxinfo" verify scene.vox --quiet || fail "the sample scene is not valid"
mkdir folder && cp cube.obj folder/b.obj && cp cube.obj folder/a.OBJ
"$bin/voxelize" folder --units cm --voxel-size 1mm -o scene.vox --json report.json --quiet || fail "folder"
grep -q '"triangles": 24' report.json || fail "the folder's files were not both read"
rm -rf folder

# A standoff in place of layers: a valid file that says it, from a cache too.
near=(cube.obj --units cm --voxel-size 1mm --standoff 1.3mm --quiet)
"$bin/voxelize" cube.obj --units cm --voxel-size 1mm --cache cache --quiet -o scene.vox || fail "layers into a cache"
for _ in first second; do
  "$bin/voxelize" "${near[@]}" --cache cache -o cached.vox --json report.json || fail "standoff with a cache"
  "$bin/voxelize" "${near[@]}" -o near.vox && cmp near.vox cached.vox || fail "the cache changes a standoff"
done
grep -q '"layers": 0' report.json || fail "a standoff has no layers"
"$bin/voxinfo" verify near.vox --quiet || fail "a file with a standoff is not valid"
"$bin/voxinfo" near.vox --json facts.json >facts
grep -q "standoff          1.3 mm" facts && grep -q "passable gap      at least 2.6 mm wider than a part that is 2 voxels thick or more" facts && grep -q "in the narrowest passable gap" facts ||
  fail "voxinfo does not say the standoff: $(cat facts)"
python3 - <<'EOF' || fail "the facts of a standoff"
import json
facts = json.load(open("facts.json"))
assert facts["layers"] == 0 and facts["provenance"]["standoff_m"] == 0.0013, facts
assert 0.0013 <= facts["standoff_m"] < 0.0013 + 1e-3 / 1024, facts  # rounded up to 2^-10 voxel
assert facts["standoff_m"] == facts["zero_force_m"] and facts["passed_gap_m"] == 2 * facts["standoff_m"], facts
assert facts["guaranteed_separation_m"] > 1e-4, facts
EOF
"$bin/voxelize" "${near[@]}" --compliance 0.4mm:2kPa -o near.vox && "$bin/voxinfo" verify near.vox --quiet ||
  fail "a standoff with a compliance"
rm -rf cache cached.vox near.vox facts facts.json

# Refused calls.
for option in "--kind lean" "--kind paper"; do
  expect 2 "--standoff: needs stored distances" cube.obj --units cm --voxel-size 1mm --standoff 2mm $option -o scene.vox
done
expect 2 "--lean: is an option of an earlier version; write --kind lean" cube.obj --units cm --voxel-size 1mm --lean -o scene.vox
expect 2 "--standoff: cannot be combined with --layers, because both set where the force begins" cube.obj --units cm --voxel-size 1mm --standoff 2mm \
  --layers 2 -o scene.vox
expect 2 "standoff: is 0.5 mm, but must be at least 0.9672 mm (force layer of 0.1 voxels + 888/1024 voxel) and at most 30 mm" cube.obj --units cm --voxel-size 1mm --standoff 0.5mm -o scene.vox
expect 2 "use a smaller standoff, or larger voxels" cube.obj --units cm --voxel-size 1mm --standoff 31mm -o scene.vox
expect 2 "must be at least 2.867 mm (force layer of 2 voxels + 888/1024 voxel) and at most 30 mm" cube.obj --units cm --voxel-size 1mm --standoff 2.8mm --compliance 2mm:1kPa -o scene.vox
expect 2 "--standoff" cube.obj --units cm --voxel-size 1mm --standoff 0mm -o scene.vox
expect 2 "--standoff" cube.obj --units cm --voxel-size 1mm --standoff 2 -o scene.vox
expect 2 "--voxel-size" cube.obj --units cm -o scene.vox
expect 2 "unit" cube.obj --units cm --voxel-size 5 -o scene.vox
expect 2 "--units" cube.obj --voxel-size 1mm -o scene.vox
expect 2 "--units" cube.obj --units parsec --voxel-size 1mm -o scene.vox
expect 2 "layers" cube.obj --units cm --voxel-size 1mm --layers 31 -o scene.vox
expect 2 "--kind" cube.obj --units cm --voxel-size 1mm --kind manhattan -o scene.vox
expect 2 "--layers" cube.obj --units cm --voxel-size 1mm --layers 0 -o scene.vox
expect 2 "range" cube.obj --units cm --voxel-size 1mm --range 1mm -o scene.vox
for kind in "--kind lean" "--kind paper"; do
  expect 2 "--range" cube.obj --units cm --voxel-size 1mm $kind --range 4mm -o scene.vox
  expect 2 "--compliance" cube.obj --units cm --voxel-size 1mm $kind --compliance 2mm:1kPa -o scene.vox
done
for curve in 2mm 2mm:1 2:1Pa 2mm:1Pa, 2mm:1Pa,1mm:2Pa 1mm:2Pa,2mm:1Pa 2mm:0Pa 2mm:-1Pa 0mm:1Pa 2mm:2000MPa; do
  expect 2 "--compliance" cube.obj --units cm --voxel-size 1mm --compliance $curve -o scene.vox
done
expect 2 "--compliance: '0.5N' is a force, but a pressure is needed: force over area; write it like 5kPa" cube.obj --units cm --voxel-size 1mm --compliance 2mm:0.5N -o scene.vox
expect 2 "compliance" cube.obj --units cm --voxel-size 1mm --compliance 40mm:1Pa -o scene.vox
expect 2 "range" cube.obj --units cm --voxel-size 1mm --compliance 3mm:1Pa --range 3mm -o scene.vox
expect 2 "--free-seed" cube.obj --units cm --voxel-size 1mm --free-seed 1mm,2mm -o scene.vox
# A bare number is no length, wherever one is asked.
expect 2 "--voxel-size: length '5' has no unit; write it like 5mm or 0.005m" cube.obj --units cm --voxel-size 5 -o scene.vox
expect 2 "--free-seed: length '5' has no unit" cube.obj --units cm --voxel-size 1mm --free-seed 5,5mm,5mm -o scene.vox
expect 2 "--roi: length '5' has no unit" cube.obj --units cm --voxel-size 1mm --roi 0,0,0,5,5mm,5mm -o scene.vox
expect 2 "--units: 'furlong' is not a unit of length" cube.obj --units furlong --voxel-size 1mm -o scene.vox
expect 2 "" cube.obj --units cm --voxel-size 1mm
expect 2 "" --units cm --voxel-size 1mm -o scene.vox
expect 2 "--no-such-option" cube.obj --no-such-option -o scene.vox
expect 1 "missing.stl" missing.stl --units mm --voxel-size 1mm -o scene.vox
expect 1 "no/such/folder" cube.obj --units cm --voxel-size 1mm -o no/such/folder/scene.vox
expect 3 "no triangles" empty.stl --units mm --voxel-size 1mm -o scene.vox
# Too large for the file: two cubes far apart. Too large for any machine: surfaces of trillions of voxels.
printf '{"parts": [{"mesh": "cube.obj", "units": "mm"}, {"mesh": "cube.obj", "units": "mm", "translation": ["100km", 0, 0]}]}' >bad.json
expect 3 "directory" bad.json --voxel-size 1um -o scene.vox
grep -q "use --voxel-size .*m or more" err || fail "no voxel size that would fit: $(cat err)"
expect 3 "at 0.001 mm the scene takes at least 3.6e+10 GB of memory, but this process can have" cube.obj --units km --voxel-size 1um -o scene.vox
grep -q "; the scene is 1000 m across; if the unit of the files is the millimeter, add --units mm; otherwise use --voxel-size .*m or more, or --roi$" err || fail "no mend: $(cat err)"
expect 3 "free seed" cube.obj --units cm --voxel-size 1mm --free-seed 0,5mm,5mm -o scene.vox
# A manifest states its units: --units does not, which is said, and an error sends nobody in a circle.
printf '{"parts": [{"mesh": "cube.obj"}]}' >scene.json
expect 3 'parts[0] of scene.json: this file format does not state the unit of length; add the unit to this part, for example "units": "mm"' \
  scene.json --units cm --voxel-size 1mm -o scene.vox
printf '{"parts": [{"mesh": "cube.obj", "units": "cm"}]}' >scene.json
"$bin/voxelize" scene.json --units in --voxel-size 1mm -o scene.vox --json report.json >out 2>err || fail "a manifest's unit: $(cat err)"
grep -qx 'voxelize: warning: --units is not used: a manifest states the units of its objects' err || fail "--units: $(cat err)"
grep -q '^scene: 1 object, 10 x 10 x 10 mm$' out || fail "a manifest's unit: $(cat out)"

# A region in another unit holds nothing, and the file too.
"$bin/voxelize" cube.obj --units cm --voxel-size 1mm --roi=10m,0,0,11m,5m,5m -o scene.vox --json report.json >out 2>err || fail "$(cat err)"
grep -qx 'voxelize: warning: no object of the scene is in --roi or near it: check the unit of --roi' err || fail "an empty region: $(cat err)"
grep -q 'no object of the scene is in --roi' report.json || fail "an empty region is not in the report"
"$bin/voxelize" cube.obj --units cm --voxel-size 1mm --roi 4mm,4mm,4mm,5mm,5mm,5mm -o scene.vox >out 2>err || fail "$(cat err)"
[ ! -s err ] || fail "a region inside of a solid: $(cat err)"
rm -f scene.vox

# Long and large, but possible: a warning before it starts.
timeout 2 "$bin/voxelize" cube.obj --units m --voxel-size 0.1mm --threads 1 -o scene.vox >out 2>err
grep -q "^voxelize: warning: this bake may take .* min and .* GB of memory: the scene is 1 m across; use --voxel-size .*m or more, or --roi$" err ||
  fail "no warning of a long bake: $(cat err)"
grep -q "^scene: 1 object, 1000 x 1000 x 1000 mm$" out || fail "no size of the scene: $(cat out)"
rm -f scene.vox bad.json

# Errors of manifests name the key.
manifest_error() {
  printf '%s' "$2" >bad.json
  expect 3 "$1" bad.json --voxel-size 1mm -o scene.vox
}
manifest_error "is longer than 1e9m" '{"parts": [{"mesh": "cube.obj", "units": "cm", "translation": ["1e15m", 0, 0]}]}'
printf '%s' '{"parts": [{"mesh": "cube.obj", "units": "mm", "translation": ["1e9m", 0, 0]}]}' >bad.json
expect 3 "2^52" bad.json --voxel-size 0.0001mm -o scene.vox --quiet
for key in '"roi": [0, 0, 0, "1m", 5, "1m"]' '"free_seeds": [[0, 5, 0]]' '"voxel_size": 5'; do
  manifest_error 'is 5 without a unit; write it like "5mm"' "{$key, \"parts\": [{\"mesh\": \"cube.obj\", \"units\": \"cm\"}]}"
done
manifest_error 'parts[0].translation[1]: is 5 without a unit' '{"parts": [{"mesh": "cube.obj", "units": "cm", "translation": [0, 5, 0]}]}'
manifest_error 'parts[0].matrix[1][3]: is 5 without a unit' '{"parts": [{"mesh": "cube.obj", "units": "cm", "matrix": [[1,0,0,0],[0,1,0,5],[0,0,1,0],[0,0,0,1]]}]}'
manifest_error 'parts[0].mesh_deviation: is 0.5 without a unit' '{"parts": [{"mesh": "cube.obj", "units": "cm", "mesh_deviation": 0.5}]}'
manifest_error 'without: is not a list of names' '{"without": "b", "parts": [{"mesh": "cube.obj", "units": "cm"}]}'
manifest_error "byte" '{"parts": ['
manifest_error "parts: " '{"voxel_size": "1mm"}'
manifest_error "parts[0].mesh" '{"parts": [{"units": "mm"}]}'
manifest_error "parts[1].unit: is not a known key" '{"parts": [{"mesh": "cube.obj", "units": "cm"}, {"mesh": "cube.obj", "unit": "cm"}]}'
manifest_error "parts[0].units" '{"parts": [{"mesh": "cube.obj", "units": "parsec"}]}'
manifest_error "parts[0]" '{"parts": [{"mesh": "cube.obj"}]}'
manifest_error "parts[0].matrix[3]" '{"parts": [{"mesh": "cube.obj", "units": "cm", "matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,0,0,1]]}]}'
manifest_error "parts[0].rotation" '{"parts": [{"mesh": "cube.obj", "units": "cm", "rotation": [0,0,0,0]}]}'
manifest_error "parts[0].rotation" '{"parts": [{"mesh": "cube.obj", "units": "cm", "rotation": [5e-324,5e-324,0,0]}]}'
manifest_error "voxel_size" '{"voxel_size": "5", "parts": [{"mesh": "cube.obj", "units": "cm"}]}'
manifest_error "layers" '{"layers": -1, "parts": [{"mesh": "cube.obj", "units": "cm"}]}'

# A failed bake leaves the old file as it was.
sum=$(sha256sum <kept.vox)
"$bin/voxelize" empty.stl --units mm --voxel-size 1mm -o kept.vox 2>/dev/null && fail "an empty mesh was baked"
[ "$sum" = "$(sha256sum <kept.vox)" ] || fail "a failed bake touched the old file"

finish
