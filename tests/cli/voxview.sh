#!/usr/bin/env bash
# voxview without a screen: plain pictures equal the voxels pixel by pixel, contacts equal the run's
# own, and what cannot be shown is an error that leaves no picture.
set -euo pipefail
bin=$FORCELAYER_BIN_DIR data=$FORCELAYER_SOURCE_DIR/sample_data
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
skip_without libvtk9-dev [ -x "$bin/voxview" ]
skip_without xvfb command -v xvfb-run
python=/usr/bin/python3
skip_without python3-matplotlib "$python" -c 'import matplotlib, numpy'
check() { "$python" "$FORCELAYER_SOURCE_DIR/tests/cli/voxview_check.py" "$@"; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
unset DISPLAY  # so that voxview finds its own virtual screen

fail() { echo "FAILED: $*" >&2; exit 1; }

# The bay, and the same with the hydraulic line 30 mm higher.
"$bin/voxelize" "$data/bay.json" -o bay.vox --voxel-size 8mm --quiet
"$python" - "$data" >moved.json <<'END'
import json, sys
scene = json.load(open(sys.argv[1] + "/bay.json"))
for part in scene["parts"]:
    part["mesh"] = sys.argv[1] + "/" + part["mesh"]
    if part["name"] == "hydraulic_line":
        part["translation"] = [0, 0, "30mm"]
print(json.dumps(scene))
END
"$bin/voxelize" moved.json -o moved.vox --voxel-size 8mm --quiet --allow-outside
"$bin/voxinfo" export bay.vox bay.csv
"$bin/voxinfo" export moved.vox moved.csv

# Layers from all sides.
plain=(--plain --pixels-per-voxel 4 --size 800x600 --json facts.json --screenshot picture.png)
for direction in 1,0,0 -1,0,0 0,1,0 0,-1,0 0,0,1 0,0,-1; do
  "$bin/voxview" draw bay.vox "${plain[@]}" --view-from $direction --show force-layer
  check layer picture.png facts.json 0.008 bay.csv 2
done
"$bin/voxview" draw bay.vox "${plain[@]}" --view-from 0,0,1 --show interior
check layer picture.png facts.json 0.008 bay.csv 1
"$bin/voxview" draw bay.vox "${plain[@]}" --view-from 0,1,0 --show proximity
check layer picture.png facts.json 0.008 bay.csv 3

# A path is a line of its own color, on a run and without one.
"$bin/pointshell" "$data/part.obj" --units mm --voxel-size 8mm -o part.pshell --quiet
printf '%s\n' t_s,x_m,y_m,z_m 0,0,0,0.4 1,0.3,0,0.4 2,0.3,0.2,0.5 >way.csv
for path in "" "--path way.csv"; do
  "$bin/voxview" draw bay.vox part.pshell --part-pose 0,0,0.4m $path --view-from 0,0,1 --focus scene --size 800x600 \
    --screenshot path.png --json facts.json --show force-layer
  "$python" - "$path" <<'END' || fail "a path: '$path'"
import json, sys
import matplotlib.image, numpy
picture = numpy.rint(255 * matplotlib.image.imread("path.png")[..., :3]).astype(int)
green = (abs(picture - [0, 158, 115]).max(axis=2) <= 2).sum()
facts = json.load(open("facts.json"))
assert ("path_m" in facts) == (sys.argv[1] != "") == (green > 200), green
if sys.argv[1]:
    assert len(facts["path_m"]) == 3 and abs(facts["path_m"][1][0] - facts["path_m"][0][0] - 0.3) < 1e-9
END
done
status=0; "$bin/voxview" bay.vox --path none.csv --screenshot no.png 2>err || status=$?
[ $status -eq 1 ] && [ ! -e no.png ] || fail "a path that is not there: $status $(cat err)"

# The kinds of maps.
for kind in "--kind paper" "--kind lean" "--range 30mm" "--compliance 4mm:1kPa,20mm:6kPa"; do
  "$bin/voxelize" "$data/bay.json" -o kind.vox --voxel-size 8mm --quiet $kind
  "$bin/voxinfo" export kind.vox kind.csv
  "$bin/voxview" draw kind.vox "${plain[@]}" --view-from 0,0,1 --show force-layer
  check layer picture.png facts.json 0.008 kind.csv 2
done

# Words that are wider than the picture go on below: none touches its right edge, where they were cut off.
"$bin/voxview" bay.vox --view-from 0,0,1 --size 600x450@2 --show force-layer --quiet --screenshot words.png
"$python" - <<'END'
import numpy
from matplotlib import image
picture = image.imread("words.png")[:, :, :3]
ink = (picture < 0.3).all(axis=2)
assert ink[:225].sum() > 1000, "no words"
assert not ink[:225, -6:].any(), "words run out of the picture"
END

# A cut: what is seen from the side that was taken away.
"$bin/voxview" draw bay.vox "${plain[@]}" --view-from 0,0,1 --cut z\<200mm \
  --show interior,force-layer,proximity
check cut picture.png facts.json 0.008 bay.csv 2 24
"$bin/voxview" draw bay.vox "${plain[@]}" --view-from 1,0,0 --cut x\<-3mm \
  --show interior,force-layer,proximity
check cut picture.png facts.json 0.008 bay.csv 0 -1

# A cut fills what meshes enclose, but not their cavities, nor what a sheet does not close: of a block of 40 mm with a
# cavity of 20 mm three quarters, also where the cut is laid in faces. Beside it stands a sheet.
python3 - >block.obj <<'END'
corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
for low, edge in ((0, 40), (10, 20)):
    for corner in corners:
        print("v", *(low + edge * x for x in corner))
for first, outwards in ((1, True), (9, False)):
    for side in sides:
        print("f", *(first + n for n in (side if outwards else reversed(side))))
for y, z in ((0, 0), (40, 0), (40, 40), (0, 40)):
    print("v", 60, y, z)
print("f", 17, 18, 19, 20)
END
for cut in 'z<20mm 0,0,1 0.75' 'x>20mm -1,0,0 0.75' 'y<30mm 0,1,0 0.75' 'y>10mm 0,-1,0 0.75' 'z<38mm 0,0,1 1'; do
  read -r side eye filled <<<"$cut"
  "$bin/voxview" draw block.obj --units mm --plain --size 600x600 --cut "$side" --view-from "$eye" --focus scene --screenshot picture.png
  "$python" - "$filled" <<'END' || fail "the section of $side"
import sys
from matplotlib import image
import numpy
picture = numpy.round(255 * image.imread("picture.png")[:, :, :3]).astype(int)
uncut = numpy.array([199, 201, 204])  # kSceneColor
def count(color):
    return int((abs(picture - color).max(axis=2) <= 1).sum())
section, rest = count(numpy.round(0.8 * uncut)), count(uncut)
assert section > 10000 and section + rest + count(255) == 600 * 600, (section, rest)
# The rest is the cavity's far wall, or the sheet behind.
assert abs(section / (section + rest) - float(sys.argv[1])) < 0.01, (section, rest)
END
done

"$bin/voxview" draw "$data/gearbox.glb" --color object --plain --size 800x600 --view-from 1,-1,1 --json facts.json \
  --screenshot picture.png
"$python" - <<'END'
import json
from matplotlib import image
import numpy
picture = numpy.round(255 * image.imread("picture.png")[:, :, :3]).astype(int)
objects = json.load(open("facts.json"))["objects"]
assert len(objects) == 9 and objects[0]["name"] == "Gearbox/Housing", objects
colors = {tuple(round(255 * x) for x in o["color"]) for o in objects}
assert len(colors) == 9, colors
# All are seen from above, in their colors and no others.
shown = {color: int((picture == color).all(axis=2).sum()) for color in colors}
assert min(shown.values()) > 20, shown
paper = int((picture == 255).all(axis=2).sum())
assert sum(shown.values()) + paper == 800 * 600, (shown, paper)
END

# A change.
"$bin/voxview" draw --compare bay.vox moved.vox "${plain[@]}" --view-from 0.0,1,0 --show part
check change picture.png facts.json 0.008 bay.csv moved.csv

# A run: the contacts of the picture are those that the run counted at that frame, from the trace
# and from the recording; a stream is followed while the run goes on.
"$bin/pointshell" "$data/part.obj" --units mm -o part.pshell --voxel-size 8mm --quiet
run=("$bin/voxrun" bay.vox part.pshell --device sim --motion "$data/press.csv" --quiet --duration)
"${run[@]}" 10s --as-fast-as-possible --trace trace.csv --record run.rec
tiny=(--size 64x64 --plain --json facts.json --screenshot picture.png)
for source in trace.csv run.rec; do
  "$bin/voxview" draw bay.vox part.pshell --replay $source --at 2.2s "${tiny[@]}"
  "$python" - <<'END'
import csv, json
shown = json.load(open("facts.json"))["moment"]
row = min(csv.DictReader(open("trace.csv")), key=lambda r: abs(float(r["t_s"]) - shown["t_s"]))
assert abs(shown["t_s"] - 2.2) < 0.002, shown
for name in ("points_proximity", "points_surface", "points_interior", "contacts"):
    assert int(row[name]) == shown[name], (name, row[name], shown)
assert int(row["contacts"]) > 0
told = shown["clearance"]
assert told == {"clearance_m": float(row["clearance_m"]), "at_least": False, "object": row["nearest_object"]}, told
assert told["clearance_m"] > 0 and told["object"], told
# Poses are written to the last bit, depths computed in single precision about the same center.
assert abs(float(row["depth_m"]) - shown["deepest_m"]) < 1e-7, (row["depth_m"], shown)
END
done
# A path alone is a run without forces, with poses between its few rows.
printf 't_s,x_m,y_m,z_m\n1,0.28,0,0.5\n2,0.28,0,0.7\n' >two.csv
"$bin/voxview" draw bay.vox part.pshell --trace two.csv --at 1.5s "${tiny[@]}"
"$python" - <<'END' || fail "a path as a run: $(cat facts.json)"
import json
moment = json.load(open("facts.json"))["moment"]
assert abs(moment["t_s"] - 1.5) < 0.003 and "clearance" not in moment and "force_n" not in moment, moment
END
# A recording says which model felt the contacts.
"${run[@]}" 3s --as-fast-as-possible --model paper --trace paper.csv --record paper.rec
"$bin/voxview" draw bay.vox part.pshell --replay paper.rec --at 2.2s "${tiny[@]}"
"$python" - <<'END' || fail "contacts of the paper's model"
import csv, json
shown = json.load(open("facts.json"))["moment"]
row = min(csv.DictReader(open("paper.csv")), key=lambda r: abs(float(r["t_s"]) - shown["t_s"]))
assert int(row["contacts"]) == shown["contacts"] > 0, (row["contacts"], shown)
END
# The hand's outline: where the hand asks for the part, drawn from a place far from the world's origin; none without a hand.
for moment in "--trace trace.csv --at 2.2s" "--part-pose 0.28m,0,0.5m"; do
  "$bin/voxview" draw bay.vox part.pshell --part "$data/part.obj" --part-units mm $moment --show handle --plain --view-from 0,-1,0 \
    --size 800x600 --json facts.json --screenshot picture.png
  "$python" - "$data/part.obj" "$moment" <<'END' || fail "the hand's outline: $moment"
import csv, json, sys
from matplotlib import image
import numpy
facts = json.load(open("facts.json"))
picture = numpy.round(255 * image.imread("picture.png")[:, :, :3]).astype(int)
rows, columns = (abs(picture - (0, 115, 178)).max(axis=2) <= 2).nonzero()  # kGhostColor
if "t_s" not in facts["moment"]:
    assert len(rows) == 0, f"{len(rows)} pixels of an outline without a hand"
    sys.exit()
def pose(row, what):
    w, x, y, z = (float(row[f"{what}_q{n}"]) for n in "wxyz")
    turn = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return numpy.array([[*turn[n], float(row[f"{what}_{'xyz'[n]}_m"])] for n in range(3)] + [[0, 0, 0, 1]])
run = list(csv.DictReader(open("trace.csv")))
grip = numpy.linalg.inv(pose(run[0], "handle")) @ pose(run[0], "part")
row = min(run, key=lambda r: abs(float(r["t_s"]) - facts["moment"]["t_s"]))
corners = numpy.array([[float(x) / 1000 for x in line.split()[1:4]] + [1] for line in open(sys.argv[1]) if line.startswith("v ")])
target = (corners @ (pose(row, "handle") @ grip).T)[:, :3] - facts["target_m"]
pixels = target / facts["metres_per_pixel"]
wanted = (400 + pixels[:, 0].min(), 400 + pixels[:, 0].max(), 300 - pixels[:, 2].max(), 300 - pixels[:, 2].min())
drawn = (columns.min(), columns.max(), rows.min(), rows.max())
assert numpy.abs(numpy.array(drawn) - wanted).max() < 4, (drawn, wanted)
END
done
# The line of the clearance: from a tip 12 mm above a floor straight down to it, and none where nothing is measured.
printf 'v %s\n' '0 0 -10' '200 0 -10' '200 200 -10' '0 200 -10' '0 0 0' '200 0 0' '200 200 0' '0 200 0' >floor.obj
printf 'f %s\n' '1 4 3 2' '5 6 7 8' '1 2 6 5' '2 3 7 6' '3 4 8 7' '4 1 5 8' >>floor.obj
printf 'v %s\n' '20 0 20' '-20 0 20' '0 20 20' '0 -20 20' '0 0 40' '0 0 0' >tip.obj
printf 'f %s\n' '1 3 5' '3 2 5' '2 4 5' '4 1 5' '3 1 6' '2 3 6' '4 2 6' '1 4 6' >>tip.obj
"$bin/voxelize" floor.obj --units mm --voxel-size 5mm -o floor.vox --quiet
"$bin/pointshell" tip.obj --units mm --voxel-size 5mm -o tip.pshell --quiet
for height in 12 60; do
  "$bin/voxview" draw floor.vox tip.pshell --part-pose 0.1m,0.1m,0.0${height}m --show contacts --plain --size 400x400 \
    --view-from 1,0,0 --screenshot "tip_$height.png" --json "tip_$height.json"
done
"$python" - <<'END'
import json
from matplotlib import image
import numpy
def purple(height):
    picture = numpy.round(255 * image.imread(f"tip_{height}.png")[:, :, :3]).astype(int)
    facts = json.load(open(f"tip_{height}.json"))
    rows, columns = (abs(picture - (204, 76, 143)).max(axis=2) <= 2).nonzero()  # kClearanceColor
    return rows, columns, facts
rows, columns, facts = purple(12)
moment = facts["moment"]
assert abs(numpy.array(moment["nearest_m"]) - (0.1, 0.1, 0.012)).max() < 1e-6, moment
assert abs(numpy.array(moment["nearest_scene_m"]) - (0.1, 0.1, 0)).max() < 0.0005, moment  # a tenth of a voxel
long = 0.012 / facts["metres_per_pixel"]
assert abs(numpy.ptp(rows) - long) < 12 and numpy.ptp(columns) < 14, (numpy.ptp(rows), numpy.ptp(columns), long)
assert 0 < moment["clearance_m"] < 0.012
assert moment["seated_on"] == ["floor"] and moment["contacts"] == 0, moment  # so near that a run would start in a seat
rows, _, facts = purple(60)
assert facts["moment"]["at_least"] and len(rows) == 0, facts
END

"${run[@]}" 600s --udp 127.0.0.1:47219 & sender=$!  # longer than a viewer takes to start on a busy machine
"$bin/voxview" draw bay.vox part.pshell --listen 47219 --duration 2s "${tiny[@]}"
"$python" - <<'END'
import json
shown = json.load(open("facts.json"))["moment"]
assert shown["t_s"] > 0 and shown["clearance"]["clearance_m"] > 0, shown
END
kill -0 $sender || fail "the run did not outlive its viewer"
kill $sender
wait $sender || true
"$bin/voxview" draw "$data/bay.json" bay.vox part.pshell --trace trace.csv --size 320x240 --duration 1s ||
  fail "the window"

# A picture for people: the size asked for, light paper, and neither empty nor full.
"$bin/voxview" "$data/bay.json" bay.vox --size 640x400 --screenshot people.png
"$python" - <<'END'
from matplotlib import image
picture = image.imread("people.png")
assert picture.shape[:2] == (400, 640), picture.shape
paper = (picture[:, :, :3] == 1).all(axis=2).mean()
assert 0.2 < paper < 0.9, paper
END

# A turntable: a movie of 72 pictures, the first of them the plan's, the nineteenth a quarter about z further; a whole scene
# is never cut off.
movie=(--plain --size 200x150 --show force-layer)
"$bin/voxview" draw bay.vox "${movie[@]}" --view-from 1,0.5,0.4 --pixels-per-voxel 1 --screenshot turntable:turn.png
for picture in 0:1,0.5,0.4 18:-0.5,1,0.4; do
  "$bin/voxview" draw bay.vox "${movie[@]}" --view-from "${picture#*:}" --pixels-per-voxel 1 --screenshot "at_${picture%%:*}.png"
done
"$bin/voxview" draw bay.vox "${movie[@]}" --focus scene --screenshot turntable:whole.png
"$python" - <<'END'
import numpy
from PIL import Image
def frames(name):
    movie = Image.open(name)
    assert movie.n_frames == 72 and movie.info["duration"] == 80 and movie.info["loop"] == 0, movie.info
    for n in range(72):
        movie.seek(n)
        yield numpy.asarray(movie.convert("RGB")).copy()
turn = list(frames("turn.png"))
for n in (0, 18):
    still = numpy.asarray(Image.open(f"at_{n}.png").convert("RGB"))
    other = (turn[n] != still).any(axis=2).mean()
    assert other < 0.002, (n, other)  # pixels on an edge, by rounding
assert all((turn[n] != turn[n - 1]).any() for n in range(72)), "it stands"
for n, frame in enumerate(frames("whole.png")):
    rim = numpy.concatenate([frame[0], frame[-1], frame[:, 0], frame[:, -1]])
    assert (rim == 255).all() and (frame != 255).any(axis=2).mean() > 0.1, n
END
"$bin/voxview" bay.vox --screenshot turntable:movie.gif 2>err.txt && fail "an ending of no picture was taken"

# A machined part with another on it, which moves by 30 and 20 mm between two bakes.
counter=$FORCELAYER_SOURCE_DIR/tests/models/counter.drc
for bake in 'counter "50mm","150mm","290mm"' 'counter_moved "80mm","170mm","290mm"'; do
  read -r name place <<<"$bake"
  cat >$name.json <<END
{"parts": [{"mesh": "$counter", "units": "mm"},
           {"mesh": "$data/part.obj", "units": "mm", "translation": [$place]}]}
END
  "$bin/voxelize" $name.json -o $name.vox --voxel-size 6mm --allow-outside --quiet
  "$bin/voxinfo" export $name.vox $name.csv
done
"$bin/voxview" draw counter.vox "${plain[@]}" --view-from 0,1,0 --show force-layer
check layer picture.png facts.json 0.006 counter.csv 2
for direction in 0,0,1 0,1,0; do
  "$bin/voxview" draw --compare counter.vox counter_moved.vox "${plain[@]}" --view-from $direction \
    --show part
  check change picture.png facts.json 0.006 counter.csv counter_moved.csv
done

expect() {  # STATUS WORDS ARGUMENTS...
  local status=$1 words=$2 got=0
  shift 2
  "$bin/voxview" "$@" --screenshot bad.png 2>error.txt || got=$?
  [ "$got" = "$status" ] || fail "status $got, not $status: $* ($(cat error.txt))"
  grep -qF -- "$words" error.txt || fail "not said: $words ($(cat error.txt))"
  [ "$(wc -l <error.txt)" = 1 ] || fail "more than one line: $(cat error.txt)"
  [ ! -e bad.png ] || fail "a picture in spite of: $*"
}
head -c 1000 bay.vox >cut.vox
cp bay.vox wrong.pshell
"$bin/voxelize" "$data/skin.stl" --units mm -o coarse.vox --voxel-size 20mm --quiet
expect 1 nowhere.vox nowhere.vox
expect 4 cut.vox cut.vox
expect 4 wrong.pshell wrong.pshell
expect 2 'a second voxmap' bay.vox moved.vox
expect 2 --units "$data/skin.stl"
expect 2 'not a picture size' bay.vox --size 10
expect 2 'is not a cut' bay.vox --cut z200
expect 2 'is not known' bay.vox --show layer
expect 2 'no length' bay.vox --view-from 0,0,0
expect 2 'no file to show is given'
expect 2 'the run does not contain the time 99 s' bay.vox part.pshell --trace trace.csv --at 99s
expect 2 'the nearest names are: hydraulic_line' bay.vox --hide hydraulic_lin
# A first sibling has no number, but may be named by it, as to the bakes: the same picture.
for first in 'Half' 'Clip[1]/Half[1]'; do
  "$bin/voxview" "$data/gearbox.glb" --hide "$first" --size 200x150 --screenshot "${first%%[*}.png" || fail "--hide $first"
done
cmp -s Half.png Clip.png || fail "Half and Half[1] are two"
got=0
"$bin/voxview" bay.vox --screenshot bad.jpg 2>error.txt || got=$?
[ "$got" = 2 ] && [ ! -e bad.jpg ] && grep -q 'ends in .png' error.txt || fail "a .jpg: $got, $(cat error.txt)"
"$bin/voxview" bay.vox --screenshot bad.ppm 2>error.txt && fail "a picture called .ppm"
[ ! -e bad.ppm ] && grep -q 'ends in .png' error.txt || fail "a .ppm: $(cat error.txt)"

# The eye is on the side that a cut takes away; the strongest force is one of a contact.
for cut in 'x<0.1m 0 1' 'x>0.1m 0 -1' 'y<0m 1 1' 'y>0m 1 -1' 'z<0.2m 2 1' 'z>0.2m 2 -1'; do
  read -r side axis sign <<<"$cut"
  "$bin/voxview" draw bay.vox --cut "$side" "${tiny[@]}"
  "$python" -c "import json; assert json.load(open('facts.json'))['to_eye'][$axis] * $sign > 0" || fail "the eye for $side"
done
"$python" - <<'END'
import csv
rows = list(csv.reader(open("trace.csv")))
free = next(row for row in rows[1:] if row[rows[0].index("contacts")] == "0")
free[rows[0].index("force_x_n")] = "99"  # felt without a contact, as braking is
for row in rows[1:]:  # the least clearance would be shown
    row[rows[0].index("clearance_m")] = ""
csv.writer(open("braked.csv", "w"), lineterminator="\n").writerows(rows)
END
"$bin/voxview" draw bay.vox part.pshell --trace braked.csv "${tiny[@]}"
"$python" -c 'import json
moment = json.load(open("facts.json"))["moment"]
assert moment["contacts"] > 0 and moment["name"] == "the strongest force", moment' || fail "no contact in the strongest frame"
expect 4 'the voxel sizes differ' --compare bay.vox coarse.vox
got=0
"$bin/voxview" bay.vox 2>error.txt || got=$?
[ "$got" = 5 ] || fail "status $got for a window without a display"
got=0
"$bin/voxview" bay.vox --size 64x64 --screenshot nowhere/picture.png 2>error.txt || got=$?
[ "$got" = 1 ] || fail "status $got for a folder that is missing"
