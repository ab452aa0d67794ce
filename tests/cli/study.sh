#!/usr/bin/env bash
# forcelayer: the list of commands; a study from one command to a page, resumed, and its errors.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
cp "$data/gearbox.glb" .
pictures=--no-pictures
if [ -x "$bin/voxview" ] && command -v xvfb-run >/dev/null; then pictures=; fi
# study STATUS ARGUMENTS...
study() {
  local wanted=$1 status=0
  shift
  # shellcheck disable=SC2086  # an option or none
  "$bin/forcelayer" study "$@" $pictures >out.txt 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || fail "status $status instead of $wanted: $*: $(cat out.txt err.txt)"
}
# says_no FILE TEST: a JUnit file of one failed test of that name.
says_no() {
  python3 - "$@" <<'END' || fail "JUnit: $(cat "$1")"
import sys, xml.etree.ElementTree as tree
suite = next(tree.parse(sys.argv[1]).getroot().iter("testsuite"))
[case] = suite.iter("testcase")
assert suite.get("tests") == suite.get("failures") == "1" and case.get("name") == sys.argv[2]
assert case.find("failure").get("message")
END
}

"$bin/forcelayer" >list.txt || fail "the list"
for name in voxelize pointshell voxinfo voxrun voxcheck voxplan voxview; do
  grep -q "^  $name " list.txt || fail "$name is not listed"
done

# A pin that is pulled out; what is finished is not done again.
pin=('gearbox.glb#Pin' --voxel-size 1mm --pull 0,0,60mm --clearance 1mm)
study 0 "${pin[@]}" -o pin --json pin.json
grep -q '^\$ voxelize gearbox.glb --without Pin' out.txt || fail "commands are not shown: $(cat out.txt)"
grep -q '^unchanged' out.txt && fail "something was known before"
for file in scene.vox part.pshell path.csv trace.csv verdict.json verdict.txt verdict.xml curve.csv curve.svg report.html; do
  [ -s "pin/$file" ] || fail "no pin/$file"
done
study 0 "${pin[@]}" -o pin
grep -q '^\$' out.txt && fail "done again: $(cat out.txt)"
rm pin/curve.csv
study 0 "${pin[@]}" -o pin
[ "$(grep -c '^\$' out.txt)" = 1 ] && grep -q '^\$ voxcheck' out.txt || fail "not what was lost: $(cat out.txt)"
study 0 "${pin[@]}" -o pin --quiet
[ ! -s out.txt ] || fail "--quiet: $(cat out.txt)"
python3 - "$pictures" <<'END' || fail "the page"
import json, re, sys
from html.parser import HTMLParser
page = open("pin/report.html").read()
report, verdict = json.load(open("pin.json")), json.load(open("pin/verdict.json"))
assert report["verdict"] == verdict["verdict"] == "clear" and report["kind"] == verdict["kind"] == "comes out", report["kind"]
assert report["sentence"] == verdict["sentence"] == open("pin/verdict.txt").readline().strip(), report["sentence"]
assert report["check"]["min_clearance"] == verdict["min_clearance"]
assert [step["status"] for step in report["steps"]] == [0] * len(report["steps"])
tags, texts = [], []
class Reader(HTMLParser):
    def handle_starttag(self, tag, attributes):
        tags.append((tag, dict(attributes)))
    def handle_data(self, data):
        texts.append(data)
Reader().feed(page)
for tag, attributes in tags:  # nothing from elsewhere
    for name in ("src", "href", "xlink:href"):
        assert attributes.get(name, "data:").startswith("data:"), (tag, attributes)
assert "url(" not in page and "@import" not in page
assert ("img" in [tag for tag, _ in tags]) == (sys.argv[1] == "") and "svg" in [tag for tag, _ in tags]
said = " ".join(texts)
assert open("pin/verdict.txt").read().strip() in said and "voxrun pin/scene.vox" in said
def mm(length_m):  # rounded down, without zeros at the end
    return f"{int(1e6 * length_m + 1e-6) / 1e3:.3f}".rstrip("0").rstrip(".") + " mm"
assert mm(verdict["min_clearance"]["exact_m"]) + " measured" in said
[seated] = verdict["seated"]
width = float(re.search(r'x="64.0" y="16" width="([0-9.]+)" [^>]*class="seat"', page)[1]) / (900 - 64 - 16)
assert "position along the path, mm" in said and abs(width - seated["to_m"] / verdict["way_m"]) < 1e-3, width
assert "least distance, contact aside" in said and "Comes out, straight along +z" in said
assert f"0.0 mm to {1e3 * seated['to_m']:.1f} mm of a path of {1e3 * verdict['way_m']:.1f} mm; {mm(seated['exact_m'])} measured to " in said
assert verdict["sentence"].startswith("Comes out, straight along +z: slides along "), verdict["sentence"]
assert f" for the first {1e3 * seated['to_m']:.1f} mm" in verdict["sentence"], verdict["sentence"]
END

# An invalid number is refused before anything is baked.
for words in "--time nan" "--time 1e300s" "--pull 0,0,nanmm" "--seat 0,0,0m,nan,0,0,0" "--clearance -1mm" \
  "--seat-depth infmm" "--missing-faces nan" "--missing-faces 1000001"; do
  # shellcheck disable=SC2086  # words
  study 2 "${pin[@]}" -o nothing $words
  [ "$(wc -l <err.txt)" = 1 ] && grep -q -- "^forcelayer: ${words%% *}: " err.txt && [ ! -e nothing ] ||
    fail "$words: $(cat out.txt err.txt)"
done

# Deeper distances are another scene, which is baked anew with them.
study 0 "${pin[@]}" -o pin --range 8mm
grep -q '^\$ voxelize .*--range 8mm' out.txt || fail "--range is not handed on: $(cat out.txt)"

# Another voxel size is another study; a mesh that changed is baked anew.
cp "$data/gearbox.glb" other.glb
study 0 'other.glb#Pin' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o other
printf '\n' >>other.glb  # not even a mesh
study 3 'other.glb#Pin' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o other
grep -q '^\$ voxelize' out.txt || fail "a change is not seen: $(cat out.txt)"
grep -q '^forcelayer: voxelize: ended with status 3' err.txt || fail "$(cat err.txt)"

# Neither a path nor a pull: voxplan finds the way; where it finds none, all files and the page say so.
if [ -x "$bin/voxplan" ]; then
  study 0 'gearbox.glb#Pin' --voxel-size 1mm --clearance 1mm -o found --json found.json
  grep -q '^\$ voxplan found/scene.vox' out.txt && grep -q '"verdict": "clear"' found.json || fail "found: $(cat out.txt)"
  study 6 'gearbox.glb#Cover' --voxel-size 1mm --clearance 1mm --time 1s -o lost
  grep -q '^voxplan: .*: no path found: in .* s it came .* mm far (1 mm required); blocked by ' err.txt || fail "lost: $(cat err.txt)"
  grep -q 'class="verdict no"><strong>No path found' lost/report.html && grep -q '"kind": "no path found"' lost/verdict.json &&
    grep -q '"verdict": "not clear"' lost/verdict.json && grep -q '^No path found: in .* (1 mm required); blocked by .*\.$' lost/verdict.txt || fail "the page of a search that found none"
  says_no lost/verdict.xml Cover
  grep -q '^forcelayer: gearbox.glb: Cover: No path found: in .*; the same search finds no path again; try a longer' \
    err.txt && ! grep -q 'goes on' err.txt || fail "no path is an answer: $(cat err.txt)"
  study 6 'gearbox.glb#Cover' --voxel-size 1mm --clearance 1mm --time 1s --seed 5 -o lost
  grep -q '^\$ voxplan .* --seed 5$' out.txt || fail "--seed is not handed on: $(cat out.txt)"
  # However a study ends, the command that it waits for ends too.
  for signal in TERM KILL; do
    "$bin/forcelayer" study 'gearbox.glb#Cover' --voxel-size 1mm --clearance 1mm --time 300s -o lost --no-pictures \
      >out.txt 2>err.txt &
    study=$!
    for _ in $(seq 600); do
      planner=$(pgrep -x -P "$study" voxplan) && break
      sleep 0.1
    done
    [ -n "$planner" ] || fail "no voxplan: $(cat out.txt err.txt)"
    # While it runs, its folder is its own.
    "$bin/forcelayer" study 'gearbox.glb#Cover' --voxel-size 2mm --pull 0,0,60mm -o lost --no-pictures >second.txt 2>&1
    [ $? = 1 ] && [ "$(cat second.txt)" = \
      "forcelayer: lost: --output: another study is writing to it; wait for its end, or name another folder" ] ||
      fail "two studies at once: $(cat second.txt)"
    kill -s "$signal" "$study"
    wait "$study" 2>/dev/null && fail "ended by SIG$signal with status 0"
    for _ in $(seq 600); do
      kill -0 "$planner" 2>/dev/null || break
      sleep 0.1
    done
    kill -0 "$planner" 2>/dev/null && fail "voxplan goes on after SIG$signal"
  done
fi

# A cover that bolts hold does not come out; by a path through them it is not clear. The page says so.
study 6 'gearbox.glb#Cover' --voxel-size 1mm --pull 0,0,60mm --clearance 1mm -o held --json held.json
grep -q '^forcelayer: gearbox.glb: Cover: Does not come out, straight along +z: pulled 60 mm, it moved .* (1 mm required); blocked by Gearbox/Lid/Bolt, Gearbox/Lid/Bolt\[2\], Gearbox/Lid/Bolt\[3\] and Gearbox/Lid/Bolt\[4\]; see held/report.html$' err.txt ||
  fail "$(cat err.txt)"
grep -q 'class="verdict no"><strong>Does not come out' held/report.html || fail "the page of what is held"
says_no held/verdict.xml held/straight.csv
python3 - <<'END' || fail "what blocks the cover: $(cat held.json)"
import json
report, verdict = json.load(open("held.json")), json.load(open("held/verdict.json"))
assert report["verdict"] == verdict["verdict"] == "not clear" and report["kind"] == "does not come out"
assert report["sentence"] == open("held/verdict.txt").readline().strip(), report["sentence"]
assert report["blocked_by"] == ["Gearbox/Lid/Bolt"] + [f"Gearbox/Lid/Bolt[{n}]" for n in (2, 3, 4)]
END
printf 't_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0.06\n' >up.csv
# At 3 mm the bolt heads are too narrow to be felt: the meshes tell, and without them it stays open.
study 6 'gearbox.glb#Cover' --voxel-size 3mm --path up.csv --clearance 1mm -o given
grep -q 'class="verdict no"><strong>Does not come out, straight along +z</strong>' given/report.html || fail "the page of what is not clear"
grep -q 'goes [0-9.]* mm deep into Gearbox/Lid/Bolt' given/report.html && grep -q '<td>[0-9.]* mm deep</td>' given/report.html || fail "the page does not say what is wrong"
study 6 'gearbox.glb#Cover' --voxel-size 3mm --path up.csv --clearance 1mm -o given --files-alone
grep -q '<strong>Undecided, ' given/report.html && grep -q '<td>undecided in contact</td>' given/report.html ||
  fail "the page does not say that the seat is not settled"

# One pose, in seconds since 1970: ticks of its curve's nanosecond are nearer than doubles.
printf 't_s,x_m,y_m,z_m\n1700000000,0,0,0.2\n' >late.csv
(ulimit -v 4000000
 "$bin/forcelayer" study 'gearbox.glb#Pin' --voxel-size 2mm --path late.csv --clearance 1mm -o late --no-pictures) >out.txt 2>&1 ||
  fail "a late pose: $(tail -n 1 out.txt)"

# A file and a part with # in their names; a node that is called as a list is written.
python3 - <<'END' || fail "odd names"
import json, struct
glb = open("gearbox.glb", "rb").read()
length, = struct.unpack_from("<I", glb, 12)
document = json.loads(glb[20:20 + length])
for node in document["nodes"]:
    node["name"] = {"Pin": "pin#3", "Clip": "{Cover,Bolt}"}.get(node["name"], node["name"])
text = json.dumps(document).encode()
text += b" " * (-len(text) % 4)
rest = glb[20 + length:]
open("odd ü#1.glb", "wb").write(struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest)
END
study 0 'odd ü#1.glb#pin#3' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o odd --json odd.json
grep -q "^\$ pointshell 'odd ü#1.glb#pin#3'" out.txt && grep -q '"path": "odd ü#1.glb"' odd.json || fail "odd names: $(cat out.txt)"
study 0 'odd ü#1.glb#pin#3' --without '{Cover,Bolt}' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o odd --json odd.json
python3 - <<'END' || fail "a node that is called as a list is written"
import json
assert json.load(open("odd/scene.json"))["without"] == ["pin#3", "{Cover,Bolt}"]
names = [part["name"] for part in json.load(open("odd/scene.json"))["parts"]]
assert len(names) == 6 and not any("{" in name for name in names), names
END
study 2 'odd ü#1.glb' --voxel-size 2mm --pull 0,0,60mm -o none

# Errors.
study 2 gearbox.glb --voxel-size 1mm --pull 0,0,60mm -o none
study 2 'gearbox.glb#Pin' --voxel-size 1mm --pull 0,0,60mm --path up.csv -o none
study 2 'gearbox.glb#Pin' --voxel-size 1mm --seat none -o none
study 2 'gearbox.glb#Pin' --voxel-size 1 --pull 0,0,60mm -o none
study 1 'none.glb#Pin' --voxel-size 1mm --pull 0,0,60mm -o none
[ ! -e none ] || fail "a study of nothing leaves $(find none)"
study 3 'gearbox.glb#Nobody' --voxel-size 1mm --pull 0,0,60mm -o none
grep -q '^forcelayer: voxelize: ended with status 3, so the study is not finished; see its line above$' err.txt ||
  fail "a name that is wrong stays wrong: $(cat err.txt)"
study 1 'gearbox.glb#Pin' --voxel-size 1mm --path none.csv -o nowhere
[ ! -s out.txt ] && [ ! -e nowhere ] || fail "something was baked for a path that is not there: $(cat out.txt)"
finish
