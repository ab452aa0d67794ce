#!/usr/bin/env bash
# voxelize --cache, --shard, --roi and the report as a user meets them.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"

# Twelve boxes in a manifest, each a mesh file of its own; and a box with a box-shaped cabin in it.
python3 - <<'PYTHON' || exit 1
import json
FACES = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"]
def box(name, low, high, more=None):
    with open(name, "w") as f:
        for n, (low, high) in enumerate([(low, high)] + (more or [])):
            for k in range(8):
                f.write("v %g %g %g\n" % tuple(high[d] if k >> d & 1 else low[d] for d in range(3)))
            for face in FACES:
                f.write("f " + " ".join(str(int(i) + 8 * n) for i in face.split()) + "\n")
parts = []
for i in range(12):
    box("box%d.obj" % i, (0, 0, 0), (20 + i, 30, 25))
    parts.append({"name": "box %d" % i, "mesh": "box%d.obj" % i, "units": "mm",
                  "translation": ["%dmm" % (45 * (i % 4)), "%dmm" % (50 * (i // 4)), 0]})
box("cabin.obj", (0, 0, 0), (60, 60, 60), [((20, 20, 20), (40, 40, 40))])
parts.append({"name": "cabin", "mesh": "cabin.obj", "units": "mm", "translation": ["300mm", 0, 0]})
json.dump({"voxel_size": "1mm", "parts": parts}, open("scene.json", "w"))
PYTHON

bake() {  # bake OUTPUT ARGUMENTS...
  local output=$1
  shift
  "$bin/voxelize" scene.json -o "$output" --quiet "$@" 2>err || fail "voxelize $*: $(cat err)"
}
same() { cmp -s "$1" "$2" || fail "$3: other bytes"; }
cached_objects() { python3 -c 'import json,sys; print(sum(p["from_cache"] for p in json.load(open(sys.argv[1]))["parts"]))' "$1"; }

# Cold, warm, with another number of threads, and after one object has changed.
bake plain.vox
bake cold.vox --cache cache --json cold.json
same cold.vox plain.vox "cold cache"
[ "$(cached_objects cold.json)" = 0 ] || fail "a cold cache holds objects"
for threads in 1 2 4 16; do
  bake warm.vox --cache cache --threads $threads --json warm.json
  same warm.vox plain.vox "warm cache, $threads threads"
  [ "$(cached_objects warm.json)" = 13 ] || fail "not all objects were found"
  bake threads.vox --threads $threads
  same threads.vox plain.vox "$threads threads"
done
sed -i 's/^v 25 /v 26 /' box5.obj
bake plain.vox
bake warm.vox --cache cache --json warm.json
same warm.vox plain.vox "one object changed"
[ "$(cached_objects warm.json)" = 12 ] || fail "more or less than one object was baked again"
python3 -c 'import json; r = json.load(open("warm.json")); assert 0 < r["nodes_from_cache"] < r["nodes"], r' ||
  fail "the nodes away from the change were not found"
# Another order of objects, and another place of the cache's folder: found all the same.
python3 - <<'PYTHON'
import json
scene = json.load(open("scene.json"))
scene["parts"].reverse()
json.dump(scene, open("turned.json", "w"))
PYTHON
mv cache moved
"$bin/voxelize" turned.json -o turned.vox --quiet --cache moved --json turned.json.out || fail "turned"
[ "$(cached_objects turned.json.out)" = 13 ] || fail "another order loses the cache"
# --quiet is quiet; a cache that cannot be written to costs a warning and nothing else.
printf x >file
"$bin/voxelize" scene.json -o out.vox --cache file >out 2>err && fail "a file was taken as a cache"
[ "$(wc -l <err)" = 1 ] && grep -q "cannot be used as a cache" err || fail "no such line: $(cat err)"

# Shards: separate processes at once, then one that unites.
for shard in 1 2 3 4 5; do
  "$bin/voxelize" scene.json --cache shards --shard $shard/5 >shard$shard.out 2>&1 &
done
wait
grep -hq "shard 3/5: 3 objects, 3 baked" shard3.out || fail "shard 3: $(cat shard3.out)"
cat shard?.out | grep -c baked | grep -qx 5 || fail "shards: $(cat shard?.out)"
bake united.vox --cache shards --json united.json
same united.vox plain.vox "shards"
[ "$(cached_objects united.json)" = 13 ] || fail "the shards did not bake all objects"
"$bin/voxelize" scene.json --cache shards --shard 20/20 >out 2>err || fail "an empty shard: $(cat err)"

expect() {  # expect STATUS TEXT ARGUMENTS...
  local status=$1 text=$2
  shift 2
  "$bin/voxelize" "$@" >out 2>err
  [ $? = "$status" ] || fail "not status $status: voxelize $*"
  [ "$(wc -l <err)" = 1 ] && grep -qF -- "$text" err || fail "no '$text': voxelize $*: $(cat err)"
}
expect 2 "--cache" scene.json --shard 1/4
expect 2 "--shard" scene.json --cache shards --shard 5/4
expect 2 "--shard" scene.json --cache shards --shard 0/4
expect 2 "--shard" scene.json --cache shards --shard 1
expect 2 "--output" scene.json --cache shards --shard 1/4 -o out.vox
expect 2 "--output" scene.json
expect 2 "--roi" scene.json -o out.vox --roi 0,0,0,1m,1m
[ ! -e out.vox ] || fail "an output file was left"

# A region: by the command line and by the manifest, with and without the cache.
bake region.vox --roi 10mm,10mm,5mm,80mm,70mm,15mm --json region.json
"$bin/voxinfo" verify region.vox --quiet || fail "the region is not valid"
bake cached.vox --roi 10mm,10mm,5mm,80mm,70mm,15mm --cache moved
same cached.vox region.vox "a region from the cache"
python3 - <<'PYTHON' || fail "region"
import json
scene = json.load(open("scene.json"))
scene["roi"] = ["10mm", "10mm", "5mm", "80mm", "70mm", "15mm"]
json.dump(scene, open("region_scene.json", "w"))
r = json.load(open("region.json"))
assert r["valid_min_voxel"] == [10, 10, 5] and r["valid_max_voxel"] == [80, 70, 15], r
assert r["cropped_sides"] == 63, r
skipped = {p["name"] for p in r["parts"] if p["outside_roi"]}
assert "box 11" in skipped and "box 0" not in skipped and "cabin" in skipped, skipped
PYTHON
"$bin/voxelize" region_scene.json -o manifest.vox --quiet || fail "roi in a manifest"
same manifest.vox region.vox "roi in a manifest"
paste -d' ' <(seq 12 3 78) <(seq 12 2 60) | awk 'NF==2 {print $1*1e-3, $2*1e-3, 0.010}' >points
"$bin/voxinfo" sample region.vox <points >inside && "$bin/voxinfo" sample plain.vox <points >full
cmp -s inside full || fail "the region differs from the whole bake"

# The report: what an object encloses, and a seed that opens it.
python3 - <<'PYTHON' || fail "report"
import json
r = json.load(open("cold.json"))
cabin = r["parts"][12]
assert cabin["triangles"] == 24 and cabin["degenerate_triangles"] == 0, cabin
assert cabin["boundary_edges"] == 0 and cabin["non_manifold_edges"] == 0, cabin
assert cabin["cavity_count"] == 2, cabin
shell, inside = cabin["cavities"]
assert inside["volume_m3"] == 19 ** 3 * 1e-9 or abs(inside["volume_m3"] - 19 ** 3 * 1e-9) < 1e-15, inside
x, y, z = inside["free_seed_m"]
assert 0.320 < x < 0.341 and 0.020 < y < 0.041 and 0.020 < z < 0.041, inside
open("seed", "w").write("%.9gm,%.9gm,%.9gm" % (x, y, z))
assert abs(r["parts"][0]["interior_m3"] - 19 * 29 * 24 * 1e-9) < 1e-12, r["parts"][0]
PYTHON
bake opened.vox --free-seed "$(cat seed)"
echo "$(tr -d m <seed | tr , ' ')" | "$bin/voxinfo" sample opened.vox | cut -f1 | grep -qx 0 || fail "the seed opened nothing"

# Narrow passages: a lid with a slot of 0.7 mm over a box, which voxels of 1 mm close and those of 0.5 mm do not.
cat >slotted.obj <<'OBJ'
v 0 0 0
v 20 0 0
v 0 20 0
v 20 20 0
v 0 0 20
v 20 0 20
v 0 20 20
v 20 20 20
v 10.4 0 20
v 10.4 20 20
v 11.1 0 20
v 11.1 20 20
f 1 3 4 2
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
f 5 9 10 7
f 11 6 8 12
OBJ
passages() { "$bin/voxelize" slotted.obj --units mm --voxel-size "$1" -o slotted.vox --narrow-passages "${@:2}" >out 2>err; }
passages 1mm --json slotted.json || fail "narrow passages: $(cat err)"
grep -q "slotted: a cavity of 6.86 cm3 is closed only because a passage is narrower than 1 mm; to open the cavity, halve the voxel size or give --free-seed" out ||
  fail "no line about the narrow passage: $(cat out)"
seed=$(sed -n 's/.* or give --free-seed \([^ ]*\)$/\1/p' out)
passages 1mm --free-seed "$seed" || fail "the seed of the line: $(cat err)"
grep -qx "no closed cavity would be open at half the voxel size" out || fail "the line's seed opens nothing: $(cat out)"
passages 0.5mm || fail "half the size: $(cat err)"
grep -qx "no closed cavity would be open at half the voxel size" out || fail "half the size leaves it closed: $(cat out)"
bake opened.vox --narrow-passages && [ -z "$(cat err)" ] || fail "--quiet is not quiet"

# e_static: the declared deviation is in the file.
bake declared.vox --mesh-deviation 0.2mm --json declared.json
python3 -c '
import json
a, b = (json.load(open(n))["static_deviation_m"] for n in ("cold.json", "declared.json"))
assert 0 < a < 1e-6 and abs(b - a - 2e-4) < 1e-12, (a, b)' || fail "e_static"

finish
