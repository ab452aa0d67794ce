#!/usr/bin/env bash
# Assemblies by the names of their nodes: the tree, one node, all but one, several as one part, and the messages for
# names that fit nothing or too much. The sample assembly as GLB and, in a build with OpenCASCADE, as STEP.
set -u
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
cp "$data/gearbox.glb" .

# refuses STATUS TEXT COMMAND...: ends with STATUS and one line that holds TEXT.
refuses() {
  local status=$1 text=$2
  shift 2
  "$bin/$@" >out 2>err
  local got=$?
  [ $got = "$status" ] || fail "status $got instead of $status: $*: $(cat err)"
  [ "$(wc -l <err)" = 1 ] || fail "not one line on stderr: $*: $(cat err)"
  grep -qF -- "$text" err || fail "no '$text' on stderr: $*: $(cat err)"
}
bake() {  # bake OUTPUT ARGUMENTS...
  local output=$1
  shift
  "$bin/voxelize" "$@" --voxel-size 1mm -o "$output.vox" --json "$output.json" >out 2>err || fail "voxelize $*: $(cat err)"
}
shell() {  # shell OUTPUT ARGUMENTS...
  local output=$1
  shift
  "$bin/pointshell" "$@" --voxel-size 1mm -o "$output.pshell" --method fast >out 2>err || fail "pointshell $*: $(cat err)"
}
names() { python3 -c 'import json, sys; print(*[p["name"] for p in json.load(open(sys.argv[1]))["parts"]])' "$1.json"; }

# check_assembly FILE MEAN_TOLERANCE: everything below, of the sample in one format.
check_assembly() {
  local file=$1
  "$bin/voxelize" --list "$file" --json list.json >list.txt 2>err || fail "list: $(cat err)"
  python3 - list.json "$file" <<'PYTHON' || fail "the list of $file"
import json, sys
listed = json.load(open(sys.argv[1]))["files"]
assert len(listed) == 1 and listed[0]["file"] == sys.argv[2], listed
nodes = {n["node"]: n for n in listed[0]["nodes"]}
lid = ["Cover"] + ["Bolt"] + [f"Bolt[{n}]" for n in (2, 3, 4)]
expected = (["Gearbox", "Gearbox/Housing", "Gearbox/Lid"] + [f"Gearbox/Lid/{n}" for n in lid]
            + ["Gearbox/Pin", "Gearbox/Clip", "Gearbox/Clip/Half", "Gearbox/Clip/Half[2]"])
assert sorted(nodes) == sorted(expected), sorted(nodes)
assert nodes["Gearbox"]["instances"] == 9 and nodes["Gearbox/Lid"]["instances"] == 5
assert nodes["Gearbox"]["triangles"] == sum(n["triangles"] for n in nodes.values() if n["instances"] == 1)
assert all(n["closed"] for n in nodes.values())
# As scripts/samplegen/housing.py draws them; a circle's polygon lies inside of it by less than 1 %.
def near(node, low, high):
    for key, corner in (("low_m", low), ("high_m", high)):
        assert all(abs(a - b * 1e-3) < 1e-4 for a, b in zip(nodes[node][key], corner)), (node, nodes[node])
near("Gearbox/Housing", (0, 0, 0), (110, 70, 40))
near("Gearbox/Lid/Cover", (0, 0, 40), (80, 70, 46))
near("Gearbox/Pin", (89.1, 30.1, 0), (98.9, 39.9, 60))
near("Gearbox/Lid/Bolt[3]", (72.5, 62.97, 28), (79.5, 69.03, 49))
near("Gearbox/Clip/Half", (94.1, 25, 42), (104, 45, 50))
PYTHON
  grep -q "^ *4 .* Gearbox/Lid/Bolt" list.txt && fail "the four bolts are four nodes"
  grep -qE "^ +5 +[0-9]+ +80 x 70 x 21 mm +closed +Gearbox/Lid$" list.txt || fail "no row of the lid: $(cat list.txt)"
  grep -q "^$file: 9 instances, [0-9]* triangles, 110 x 70 x 60 mm, closed; unit 0*.*1 m$" list.txt ||
    grep -q "^$file: 9 instances" list.txt || fail "no line of the file: $(head -1 list.txt)"
  "$bin/voxelize" --list "$file#Lid" --without 'Bolt*' | grep -q "Cover$" || fail "a list of a sub-tree"
  [ "$("$bin/voxelize" --list "$file#Clip" --json - 2>/dev/null | python3 -c 'import json, sys; print(len(json.load(sys.stdin)["files"][0]["nodes"]))')" = 3 ] ||
    fail "a list on standard output"

  # The scene without the cover, and the cover as the part, in its seat at the identity pose.
  bake opened "$file" --without Cover
  grep -q "^scene: 8 objects, 110 x 70 x 60 mm$" out || fail "no size of the scene: $(cat out)"
  case $(names opened) in *Cover*) fail "the cover was not left out: $(names opened)" ;; esac
  # Beside each distance stands the object that it is from, by its name in the list.
  "$bin/voxinfo" verify opened.vox --quiet || fail "the opened gearbox is not valid"
  "$bin/voxinfo" opened.vox --objects --json objects.json >out || fail "objects"
  grep -q "^  objects           8; the nearest objects are stored in [1-9][0-9]* bytes$" out || fail "no number of objects: $(cat out)"
  python3 - opened.json objects.json <<'PYTHON' || fail "the objects of the file: $(cat objects.json)"
import json, sys
baked, file = (json.load(open(name)) for name in sys.argv[1:])
assert baked["object_count"] == file["object_count"] == len(file["objects"]) == 8, file
assert [o["name"] for o in file["objects"]] == [p["name"] for p in baked["parts"]], file
assert all(o["voxels"] > 1000 for o in file["objects"]), file
PYTHON
  # Over the top of the pin, beside the housing, far away.
  printf '%s\n' '0.094 0.035 0.0625' '-0.0025 0.035 0.02' '0.2 0.2 0.2' | "$bin/voxinfo" sample opened.vox >out
  [ "$(cut -f4 out | paste -sd' ')" = "Gearbox/Pin Gearbox/Housing " ] || fail "nearest objects: $(cat out)"

  shell cover "$file#Cover"
  grep -qxF "cover.pshell: pose 0,0,0 is the installed pose of the part in $file" out ||
    fail "no word of where the part stands: $(cat out)"
  python3 - "$("$bin/voxinfo" cover.pshell --json - 2>/dev/null)" <<'PYTHON' || fail "the cover is elsewhere"
import json, sys
center = json.loads(sys.argv[1])["center_m"]
assert abs(center[0] - 0.040) < 1e-4 and abs(center[1] - 0.035) < 1e-4 and abs(center[2] - 0.043) < 1e-4, center
PYTHON

  # Several nodes as one part, in each way to say so; the same bytes.
  shell clip "$file#Clip"
  shell halves "$file#{Half,Half[2]}"
  shell starred "$file#Half*"
  shell listed "$file#Half" "$file#Half[2]"
  shell rest "$file#Gearbox" --without '{Housing,Lid,Pin}'
  for other in halves starred listed rest; do
    cmp -s clip.pshell $other.pshell || fail "$other.pshell differs from clip.pshell"
  done
  bake bolts "$file#Bolt*"
  [ "$(names bolts | wc -w)" = 4 ] || fail "not four bolts: $(names bolts)"
  bake pair "$file#Pin" "$file#Bolt[2]"
  [ "$(names pair)" = "Gearbox/Pin Gearbox/Lid/Bolt[2]" ] || fail "two nodes: $(names pair)"

  # In a manifest: nodes of one file as parts, nodes left out, parts left out by their names.
  cat >scene.json <<JSON
{"parts": [{"name": "box", "mesh": "$file#Housing"}, {"name": "lid", "mesh": "$file#Lid"},
           {"name": "pin", "mesh": "$file#Pin", "translation": [0, 0, "5MM"]}], "without": ["Cover"]}
JSON
  bake manifest scene.json
  [ "$(names manifest)" = "box lid/Gearbox/Lid/Bolt lid/Gearbox/Lid/Bolt[2] lid/Gearbox/Lid/Bolt[3] lid/Gearbox/Lid/Bolt[4] pin" ] ||
    fail "a manifest: $(names manifest)"
  sed 's/"pin"/"{box,lid}"/' scene.json >odd.json
  bake fewer odd.json --without '{box,lid}'
  [ "$(names fewer)" = "$(names manifest | sed 's/ pin$//')" ] || fail "without a part that is called as a list is written: $(names fewer)"
  bake fewer odd.json --without '{box,Bolt[?]}'
  [ "$(names fewer)" = "lid {box,lid}" ] || fail "without a list of a part and nodes: $(names fewer)"
  bake fewer scene.json --without pin --without 'Bolt[?]'
  [ "$(names fewer)" = "box lid" ] || fail "a manifest without its pin: $(names fewer)"
  python3 -c 'import json; assert json.load(open("fewer.json"))["without"] == ["Bolt[?]", "Cover", "pin"]' ||
    fail "what was left out is not in the report"

  # Mistakes.
  refuses 3 "#Covr: no node has this name; the nearest names are: Gearbox/Lid/Cover" voxelize "$file#Covr" --voxel-size 1mm -o no.vox
  refuses 3 "#Covr: no node has this name; the nearest names are: Gearbox/Lid/Cover" pointshell "$file#Covr" --voxel-size 1mm -o no.pshell
  refuses 3 "#Covr: no node has this name; the nearest names are: Gearbox/Lid/Cover" voxelize --list "$file#Covr"
  refuses 3 "no file has a node called 'Covr'; the nearest names are: Gearbox/Lid/Cover" voxelize "$file" --without Covr --voxel-size 1mm -o no.vox
  refuses 3 "no file has a node called 'Covr'; the nearest names are: Gearbox/Lid/Cover" pointshell "$file" --without Covr --voxel-size 1mm -o no.pshell
  refuses 3 "no file has a node called 'Covr'" voxelize --list "$file" --without Covr
  # Siblings that are called alike: nobody means the first alone without to say so.
  alike="several siblings have this name: Gearbox/Lid/Bolt[1], Gearbox/Lid/Bolt[2], Gearbox/Lid/Bolt[3], Gearbox/Lid/Bolt[4]; write Bolt[1] for"
  refuses 3 "$file: --without Bolt: $alike" voxelize "$file" --without Bolt --voxel-size 1mm -o no.vox
  refuses 3 "$file: #Bolt: $alike" voxelize "$file#Bolt" --voxel-size 1mm -o no.vox
  refuses 3 "$file: #Bolt: $alike" pointshell "$file#Bolt" --voxel-size 1mm -o no.pshell
  refuses 3 "$file: #Bolt: $alike" voxelize --list "$file#Bolt"
  refuses 3 "write Gearbox/Lid/Bolt[1] for only the first node, or Gearbox/Lid/Bolt* for all nodes" \
    voxelize "$file#Gearbox/Lid/Bolt" --voxel-size 1mm -o no.vox --cache no.cache
  bake one "$file#Bolt[1]" "$file#Lid/Bolt[3]" --without 'Bolt[3]' --without Half*
  [ "$(names one)" = "Gearbox/Lid/Bolt" ] || fail "the first of four bolts: $(names one)"
  refuses 3 "#Screw*: no node has this name" voxelize "$file#{Cover,Screw*}" --voxel-size 1mm -o no.vox
  # No name, as of "$file#$PART" with nothing in PART, is not the whole file.
  refuses 3 "$file: #: no name follows the #; name a node that voxelize --list prints, or leave out the #" \
    pointshell "$file#" --voxel-size 1mm -o no.pshell
  refuses 3 "$file: #: no name follows the #" voxelize "$file#Pin" "$file#" --voxel-size 1mm -o no.vox
  refuses 3 "$file: #: no name follows the #" voxelize "$file#" --voxel-size 1mm -o no.vox --sandbox --cache no.cache
  refuses 3 "$file: #: no name follows the #" voxelize --list "$file#"
  printf '{"parts": [{"mesh": "%s#"}]}' "$file" >bad.json
  refuses 3 "parts[0] of bad.json, #: no name follows the #" voxelize bad.json --voxel-size 1mm -o no.vox
  printf '{"parts": [{"mesh": "%s#Pin"}, {"mesh": "%s#Pim"}]}' "$file" "$file" >bad.json
  refuses 3 "parts[1] of bad.json, #Pim: no node has this name; the nearest names are: Gearbox/Pin" voxelize bad.json --voxel-size 1mm -o no.vox
  # Names of a manifest's parts. Of parts of one name each is meant, and the second has a number in the bake.
  refuses 3 "no file has a node called 'boxx'; the nearest names are: box, " voxelize scene.json --without boxx --voxel-size 1mm -o no.vox
  sed 's/"pin"/"box"/' scene.json >double.json
  bake twice double.json --without 'Bolt*'
  [ "$(names twice)" = "box box#2" ] || fail "two parts of one name: $(names twice)"
  bake fewer double.json --without box
  case " $(names fewer)" in *" box"*) fail "one of two boxes is left: $(names fewer)" ;; esac
  refuses 3 "--without leaves out all nodes of this file that have a mesh" voxelize gearbox.glb --without Gearbox --voxel-size 1mm -o no.vox
}

check_assembly gearbox.glb
refuses 2 "--list: is not possible for a folder" voxelize --list .
# A manifest's parts where it places them, and one of them by name.
python3 - "$FORCELAYER_SOURCE_DIR/tests/support" <<'END' || fail "the bore"
import sys
sys.dont_write_bytecode = True
sys.path.insert(0, sys.argv[1])
from bore import bore
bore()
END
"$bin/voxelize" --list bore.json --json list.json >out && grep -q "2 instances, 192 triangles, 100 x 100 x 60 mm, closed; unit 1 m$" out ||
  fail "a manifest is listed: $(cat out)"
python3 - <<'END' || fail "the parts of a manifest: $(cat list.json)"
import json
[listed] = json.load(open("list.json"))["files"]
plate, pin = listed["nodes"]
assert plate["node"] == "plate" and pin["node"] == "pin" and pin["triangles"] == 64 and pin["closed"]
for corner, expected in ("low_m", (-0.01, -0.01, 0)), ("high_m", (0.01, 0.01, 0.06)):
    assert max(abs(a - b) for a, b in zip(pin[corner], expected)) < 1e-8, pin
END
"$bin/voxelize" --list 'bore.json#pin' >out && grep -q '^bore.json: 1 instance, 64 triangles, 20 x 20 x 60 mm' out || fail "one part is listed: $(cat out)"
# The same part from the file itself, which has it upright and in millimeters, and from the manifest, turned and moved.
"$bin/pointshell" 'bore.json#pin' --voxel-size 1mm --quiet -o placed.pshell --json placed.json || fail "a part of a manifest"
"$bin/pointshell" pin.obj --units mm --voxel-size 1mm --quiet -o plain.pshell --json plain.json || fail "the part alone"
python3 - <<'END' || fail "not where the manifest places it: $(cat placed.json)"
import json
placed, plain = json.load(open("placed.json")), json.load(open("plain.json"))
assert max(abs(a - b) for a, b in zip(placed["center_m"], plain["center_m"])) < 1e-8, placed
assert abs(placed["area_m2"] / plain["area_m2"] - 1) < 1e-6 and abs(placed["volume_m3"] / plain["volume_m3"] - 1) < 1e-6
END
refuses 3 'bore.json: #pim: no entry under "parts" has this "name"; use one of the names, such as plate, pin' \
  pointshell 'bore.json#pim' --voxel-size 1mm -o no.pshell
refuses 2 "--output: has no effect with --list" voxelize --list gearbox.glb -o no.vox
refuses 2 "--list: cannot be combined with --plan" voxelize --list gearbox.glb --plan
cp "$data/skin.stl" .
"$bin/voxelize" --list skin.stl | grep -q "no unit in this format: add --units$" || fail "a format without units"
"$bin/voxelize" --list skin.stl --units mm | grep -q "1200 x 800.8 x 44.58 mm" || fail "a list with --units"
refuses 3 "STL files have no nodes" voxelize "skin.stl#Cover" --units mm --voxel-size 5mm -o no.vox

# In the sandbox, and from a cache: the same bytes.
bake plain gearbox.glb --without Cover
bake boxed gearbox.glb --without Cover --sandbox
bake first gearbox.glb --without Cover --cache cache
bake again gearbox.glb --without Cover --cache cache
bake whole gearbox.glb --cache cache
bake two 'gearbox.glb#Pin' 'gearbox.glb#Clip' --cache cache
bake two_plain 'gearbox.glb#Pin' 'gearbox.glb#Clip' --sandbox
for other in boxed first again; do cmp -s plain.vox $other.vox || fail "$other.vox differs from plain.vox"; done
cmp -s two.vox two_plain.vox || fail "two nodes, from the cache and in the sandbox"
cmp -s plain.vox whole.vox && fail "the whole is no more than a piece"

# Units: a scene that is 1000 times too large is refused or warned of before it is baked, and one warning does for many.
for n in $(seq 12); do cp gearbox.glb "copy_$n.glb"; done
"$bin/voxelize" copy_*.glb --units mm --voxel-size 1mm -o copies.vox --json copies.json >out 2>err || fail "copies: $(cat err)"
[ "$(grep -c "1 m of the file is read as 1 mm" err)" = 1 ] && grep -q "and 11 other files: 1 m of the file is read as 1 mm, as you asked" err ||
  fail "not one warning for twelve files: $(cat err)"
"$bin/voxelize" 'copy_1.glb#Pin' 'copy_1.glb#Bolt*' 'copy_1.glb#Clip' --units mm --voxel-size 1mm -o copies.vox >out 2>err
[ "$(grep -c "1 m of the file is read as 1 mm" err)" = 1 ] || fail "not one warning for three nodes of a file: $(cat err)"
# One that is too small is warned of, too.
small="warning: the scene is 0.11 mm across, less than a voxel: check --units; if the unit is right, use a smaller --voxel-size"
"$bin/voxelize" gearbox.glb --units mm --voxel-size 1mm -o small.vox --json small.json >out 2>err && grep -qxF "voxelize: $small" err ||
  fail "a scene of less than a voxel: $(cat err)"
grep -qF "${small#warning: }" small.json || fail "the report of a scene of less than a voxel: $(cat small.json)"
"$bin/pointshell" 'gearbox.glb#Pin' --voxel-size 20mm -o small.pshell >out 2>err &&
  grep -qxF "pointshell: warning: the part is 60 mm across, 3 voxels: check --units; if the unit is right, use a smaller --voxel-size" err ||
  fail "a part of three voxels: $(cat err)"
"$bin/pointshell" 'gearbox.glb#Pin' --voxel-size 14mm -o small.pshell >out 2>err && [ ! -s err ] || fail "a part of four voxels: $(cat err)"

# Axes and units: as the file, or as it was asked; the same question about meters in list, plan and bake.
"$bin/voxelize" --list gearbox.glb | grep -q "; unit 1 m, turned from y-up to z-up$" || fail "no word of the axes: $(head -1 out)"
"$bin/voxelize" --list gearbox.glb --up y | grep -q "110 x 60 x 70 mm, closed; unit 1 m, y-up as in the file$" || fail "--up y in a list"
for option in "" --sandbox "--cache axes" "--cache axes"; do
  bake axes gearbox.glb --up y $option
  grep -q "^scene: 9 objects, 110 x 60 x 70 mm$" out && grep -q '"up": "y"' axes.json || fail "--up y $option: $(cat out)"
  bake axes gearbox.glb $option
  grep -q "^scene: 9 objects, 110 x 70 x 60 mm$" out && grep -q '"up": "z"' axes.json || fail "z up $option: $(cat out)"
done
shell axes 'gearbox.glb#Pin' --up y
"$bin/pointshell" verify axes.pshell 'gearbox.glb#Pin' --quiet || fail "verify reads the part as it was baked"
refuses 2 "--up: x not in {z,y}" voxelize gearbox.glb --up x --voxel-size 1mm -o no.vox
python3 - <<'PYTHON'
import json, struct
data = open("gearbox.glb", "rb").read()
length, = struct.unpack_from("<I", data, 12)
document, rest = json.loads(data[20:20 + length]), data[20 + length:]
document["nodes"][0].update(scale=[10000] * 3, name="far\tacross")
text = json.dumps(document).encode()
text += b" " * (-len(text) % 4)
open("far.glb", "wb").write(struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest)
PYTHON
"$bin/voxelize" --list far.glb >out 2>err && grep -qxF "voxelize: warning: far.glb: the model is 1100 m across; if the unit of the files is the millimeter, add --units mm" err || fail "list: $(cat err)"
"$bin/voxelize" far.glb --plan --voxel-size 8m >out 2>err && grep -qxF "voxelize: warning: the scene is 1100 m across; if the unit of the files is the millimeter, add --units mm" err ||
  fail "plan: $(cat err)"
refuses 3 "the scene is 1100 m across; if the unit of the files is the millimeter, add --units mm" voxelize far.glb --voxel-size 0.1mm -o no.vox
"$bin/voxelize" --list far.glb --units m >out 2>err && [ ! -s err ] || fail "a question about a unit that was stated: $(cat err)"
for call in "--list" "--plan --voxel-size 8mm" "--voxel-size 8mm -o far.vox"; do
  "$bin/voxelize" far.glb --units mm $call >out 2>err || fail "far.glb --units mm $call: $(cat err)"
  grep -qxF "voxelize: warning: far.glb: 1 m of the file is read as 1 mm, as you asked" err || fail "$call: no word of the unit: $(cat err)"
done
# A name can be typed as the list prints it.
name=$("$bin/voxelize" --list far.glb 2>err | grep -o 'far.x09across/Pin$')
bake typed "far.glb#$name" --units mm
bake typed far.glb --without "{$name,Clip}" --units mm
case $(names typed) in *Pin*) fail "a listed name was not left out: $(names typed)" ;; esac

if "$bin/make_sample_step" gearbox.step 2>/dev/null; then
  check_assembly gearbox.step
  # Exact surfaces and their polygons are of one place and size.
  bake glb gearbox.glb
  bake step gearbox.step
  python3 - <<'PYTHON' || fail "the scenes of GLB and STEP differ"
import json
a, b = (json.load(open(n + ".json")) for n in ("glb", "step"))
assert a["origin_voxel"] == b["origin_voxel"] and a["dims"] == b["dims"]
for key in ("interior", "surface", "proximity"):
    assert abs(a["counts"][key] - b["counts"][key]) < 0.01 * a["counts"][key], (key, a["counts"], b["counts"])
PYTHON
fi
finish
