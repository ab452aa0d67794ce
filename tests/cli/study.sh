#!/usr/bin/env bash
# forcelayer: the list of commands; a study from one command to a page, resumed, and its errors.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
cp "$data/gearbox.glb" .
pictures=no
[ ! -x "$bin/voxview" ] || pictures=yes
# study STATUS ARGUMENTS...
study() {
  local wanted=$1 status=0
  shift
  "$bin/forcelayer" study "$@" >out.txt 2>err.txt || status=$?
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

# One word for one thing: what has status 7 is "not clear" in --help as in all reports.
for command in "forcelayer study" voxcheck voxplan; do
  [ -x "$bin/${command% *}" ] || continue
  # shellcheck disable=SC2086  # words
  "$bin"/$command --help | tr '\n' ' ' | grep -q '7: [^;]*not clear without force, because the installed part overlaps a neighbor\.' || fail "the help of $command"
done

# Each step that reads a file of odd units notes that in its report. It is printed once.
study 0 'gearbox.glb#Pin' --units cm --voxel-size 0.01mm --pull 0,0,0.6mm --clearance 0.01mm --no-pictures -o scaled
[ "$(grep -c 'warning: .* is read as ' err.txt)" = 1 ] || fail "not one warning: $(cat err.txt)"
for report in scene part check; do
  grep -q ' is read as ' scaled/$report.json || fail "the warning is not in $report.json"
done

# A pin that is pulled out; what is finished is not done again.
pin=('gearbox.glb#Pin' --voxel-size 1mm --pull 0,0,60mm --clearance 1mm)
study 0 "${pin[@]}" -o pin --json pin.json
grep -q '^\$ voxelize gearbox.glb --without Pin' out.txt || fail "commands are not shown: $(cat out.txt)"
! grep -hE '[0-9)] m([,;:. ]|$)' out.txt err.txt || fail "meters beside millimeters"
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
import json, math, re, sys
from html.parser import HTMLParser
page = open("pin/report.html").read()
report, verdict = json.load(open("pin.json")), json.load(open("pin/verdict.json"))
assert report["verdict"] == verdict["verdict"] == "clear" and report["kind"] == verdict["kind"] == "comes out", report["kind"]
assert report["sentence"] == verdict["sentence"] == open("pin/verdict.txt").readline().strip(), report["sentence"]
assert report["check"]["min_clearance"] == verdict["min_clearance"]
assert report["finding"] is verdict["finding"] is None, report["finding"]
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
assert ("img" in [tag for tag, _ in tags]) == (sys.argv[1] == "yes") and "svg" in [tag for tag, _ in tags]
said = " ".join(texts)
assert open("pin/verdict.txt").read().strip() in "".join(texts) and "voxrun pin/scene.vox" in said
def mm(length_m):  # rounded down to three decimals, or to three digits, without zeros at the end
    decimals = max(3, math.ceil(-math.log10(1e3 * length_m) - 1e-9) + 2)
    return f"{int(1e3 * length_m * 10**decimals + 1e-3) / 10**decimals:.{decimals}f}".rstrip("0").rstrip(".") + " mm"
assert mm(verdict["min_clearance"]["exact_m"]) + " measured" in said
[seated] = verdict["seated"]
width = float(re.search(r'x="64.0" y="16" width="([0-9.]+)" [^>]*class="seat"', page)[1]) / (900 - 64 - 16)
assert "position along the path, mm" in said and abs(width - seated["to_m"] / verdict["travel_m"]) < 1e-3, width
assert "smallest distance while not in its seat" in said and "Comes out, straight along +z" in said
assert f"0.0 mm to {1e3 * seated['to_m']:.1f} mm of a path of {1e3 * verdict['travel_m']:.1f} mm; {mm(seated['exact_m'])} measured to " in said
assert re.match("Comes out, straight along [+]z: passes .* with a gap of ", verdict["sentence"]), verdict["sentence"]
assert f" for the first {round(1e3 * seated['to_m'], 1):g} mm" in verdict["sentence"], verdict["sentence"]
END

# The picture shows the moment of which the first sentence speaks, and so does the report.
mkdir drawn
cp "$bin/voxcheck" "$bin/voxcheck-exact" drawn
printf '#!/bin/bash\nprintf "%%s\\n" "$@" >drawn/words.txt\n' >drawn/voxview
chmod +x drawn/voxview
for clearance in 1mm 0.05mm; do
  drawn/voxcheck pin/scene.vox pin/part.pshell pin/straight.csv --clearance $clearance --seat 0,0,0m --exact gearbox.glb --part 'gearbox.glb#Pin' --without Pin \
    --json told.json --report picture:told.png >out.txt 2>err.txt || fail "a picture at $clearance: $(cat out.txt err.txt)"
  python3 - <<'END' || fail "the moment of the picture, $clearance: $(cat out.txt) $(cat drawn/words.txt)"
import json, re
report, words = json.load(open("told.json")), open("drawn/words.txt").read().splitlines()
told = report["told_moment"]
[(name, after_mm)] = re.findall(r"\(measured to ([^,;]*), after ([0-9.]+) of 60 mm", report["sentence"])
option = lambda key: words[words.index(key) + 1]
assert told["object"].endswith(name) and option("--measure-object") == told["object"], (name, told)
z_mm = 1e3 * float(option("--part-pose").split(",")[2].rstrip("m"))
assert abs(z_mm - float(after_mm)) < 0.06 and abs(1e3 * told["along_path_m"] - z_mm) < 1e-6, (z_mm, after_mm, told)
END
done

# An invalid number is refused before anything is baked.
for words in "--time nan" "--time 1e300s" "--pull 0,0,nanmm" "--seat 0,0,0m,nan,0,0,0" "--clearance -1mm" \
  "--seat-depth infmm" "--missing-faces nan" "--missing-faces 1000001"; do
  # shellcheck disable=SC2086  # words
  study 2 "${pin[@]}" -o nothing $words
  [ "$(wc -l <err.txt)" = 1 ] && grep -q -- "^forcelayer: ${words%% *}: " err.txt && [ ! -e nothing ] ||
    fail "$words: $(cat out.txt err.txt)"
done

# The depth of the distances is found by the study itself.
study 2 "${pin[@]}" -o nothing --range 8mm
grep -q -- '--range: is an option of an earlier version; leave it out: with --voxel-size auto' err.txt || fail "--range: $(cat err.txt)"

# Whatever the voxels, a pin slides with the same play, as far, and keeps the same distance then. Its scene is a manifest, in which
# it is turned and moved. Nobody has to choose them: a size is chosen, with the reason.
cp "$FORCELAYER_SOURCE_DIR/tests/support/bore.py" .
python3 -c 'from bore import bore; bore()'
bore=('bore.json#pin' --pull 0,0,100mm --clearance 1mm)
for size in auto 0.5mm 1mm 2mm 3mm 5mm 10mm; do study 0 "${bore[@]}" --voxel-size $size -o "bore$size" --json "bore$size.json"; done
study 0 "${bore[@]}" -o boreauto
grep -q '^\$' out.txt && fail "auto chooses again: $(cat out.txt)"
study 0 'bore.json#pin' --plan --clearance 1mm -o plan --json plan.json
[ ! -e plan/report.html ] || fail "--plan leaves a page"
grep -q '^smallest gap when installed: 0\.098 mm, to plate$' out.txt && grep -q '^ *voxel  *play needed ' out.txt || fail "the plan: $(cat out.txt)"
# The table is of voxels. Where a gap is smaller than the play needed, the plan says that the meshes can still prove a path.
study 0 'bore.json#pin' --plan --clearance 1mm --voxel-size 3mm
grep -qE '^ *3 mm +[1-9][.0-9]* mm ' out.txt && grep -q '^play needed: in less play, voxels hold a simulated hand; meshes can still prove a path$' out.txt ||
  fail "a plan at voxels of 3 mm: $(cat out.txt)"
python3 - <<'END' || fail "the same answer at each size: $(cat bore*/verdict.txt)"
import csv, json, re
from bore import PLAY_MM
for size in "auto", "0.5mm", "1mm", "2mm", "3mm", "5mm", "10mm":
    report = json.load(open(f"bore{size}.json"))
    [seated] = report["check"]["seated"]
    assert report["kind"] == "comes out" and report["sentence"].startswith(
        "Comes out, straight along +z: passes plate with a gap of 0.098 mm for the first 41 mm, otherwise stays 1.0"), report["sentence"]
    assert abs(1e3 * seated["exact_m"] - PLAY_MM) < 0.01 and abs(1e3 * seated["to_m"] - 41) < 0.05, seated
    assert 1e-3 <= report["check"]["min_clearance"]["exact_m"] < 1.05e-3, report["check"]["min_clearance"]
    # The curve shows what the verdict says.
    for row in list(csv.DictReader(open(f"bore{size}/curve.csv"))):
        least = 0.9 * PLAY_MM / 1e3 if float(row["from_m"]) < seated["to_m"] - 1e-9 else 1e-3
        assert float(row["clearance_m"]) >= least, (size, row)
    assert size == "auto" or abs(report["voxel_size_m"] - float(size[:-2]) / 1e3) < 1e-12
    # A simulated hand feels only voxels, and may be held: the answer "comes out" is of the meshes, and says nothing of it.
    held = json.load(open(f"bore{size}/run.json"))["pull"]["held"]
    assert held == (size == "10mm") and "hand" not in report["words"], (size, held, report["words"])
report, plan = json.load(open("boreauto.json")), json.load(open("plan.json"))
assert report["voxel_size_m"] == plan["plan"][0]["voxel_size_m"] and report["voxel_sizes_tried"] == []
assert report["voxel_size_why"] in plan["words"] and report["play"] == plan["play"]
assert abs(1e3 * report["play"]["smallest_m"] - PLAY_MM) < 1e-5 and report["play"]["object"] == "plate"
assert abs(plan["plan"][-1]["voxel_size_m"] - report["smallest_voxel_size_m"]) < 1e-12 and report["smallest_voxel_size_m"] < report["voxel_size_m"]
words = open("boreauto/verdict.txt").read()
assert "  smallest gap when installed: 0.098 mm, to plate\n  voxels of " in words and words.strip() in re.sub("<[^>]*>", "", open("boreauto/report.html").read())
END
# Where an answer stays open, smaller voxels are tried, and the verdict says where that ends.
if [ -x "$bin/voxplan" ]; then
  study 6 'gearbox.glb#Cover' --clearance 1mm --time 30s -o open --json open.json
  grep -qE '^  smaller voxels might change the answer; none are smaller than .* mm: .*smaller voxels |no path was found either; .*smaller voxels |; voxels of .* mm were not tried, because too little of --time .30s. was left$|; --time .30s. ended before voxels of .* mm gave an answer$' open/verdict.txt ||
    fail "no limit: $(cat open/verdict.txt)"
  python3 - <<'END' || fail "refined: $(cat open.json)"
import json
report = json.load(open("open.json"))
tried = [size["voxel_size_m"] for size in report["voxel_sizes_tried"]]
assert tried == sorted(tried, reverse=True) and report["voxel_size_m"] not in tried, tried
tried = sorted([*tried, report["voxel_size_m"]], reverse=True)
assert len(set(tried)) == len(tried) and tried[-1] >= report["smallest_voxel_size_m"] - 1e-12, tried
assert len(tried) > 1 or "too little of --time" in report["voxel_size_why"], report["voxel_size_why"]
assert all(size["open"] for size in report["voxel_sizes_tried"])
# All searches together have the time of the study.
searches_s = [float(line.split(" --time ")[1].split("s")[0]) for line in open("out.txt") if line.startswith("$ voxplan ")]
assert len(searches_s) == len(tried) and 0 < sum(searches_s) < 30, searches_s
END
  study 6 'gearbox.glb#Cover' --clearance 1mm --time 30s -o open
  grep -q '^\$' out.txt && fail "a study with --time is done again: $(cat out.txt)"
  [ ! -e open/larger_voxels ] || fail "files of an answer stay: $(ls open)"
fi
study 3 'bore.json#pim' --pull 0,0,100mm -o nowhere
grep -q '^pointshell: bore.json: #pim: no entry under "parts" has this "name"; use one of the names, such as plate, pin$' err.txt || fail "$(cat err.txt)"
rm -rf nowhere
study 2 'gearbox.glb#Pin' --voxel-size automatic -o none
grep -q '^forcelayer: --voxel-size: ' err.txt || fail "$(cat err.txt)"

# Another voxel size is another study; a mesh that changed is baked anew.
cp "$data/gearbox.glb" other.glb
study 0 'other.glb#Pin' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o other
printf '\n' >>other.glb  # not even a mesh
study 3 'other.glb#Pin' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o other
grep -q '^\$ pointshell' out.txt || fail "a change is not seen: $(cat out.txt)"
grep -q '^forcelayer: pointshell: ended with status 3' err.txt || fail "$(cat err.txt)"

# Neither a path nor a pull: voxplan finds the way; where it finds none, all files and the page say so.
if [ -x "$bin/voxplan" ]; then
  # Files of voxels that are far too large prove no distance to the cover, 9 mm away: the meshes do, along a straight path.
  study 0 'gearbox.glb#Pin' --voxel-size 5mm --clearance 1mm --no-pictures -o coarse
  grep -q '^Comes out, straight along +z: passes .* with a gap of 0\.0978 mm for ' coarse/verdict.txt ||
    fail "the pin at voxels of 5 mm: $(cat coarse/verdict.txt)"
  study 0 'gearbox.glb#Pin' --voxel-size 1mm --clearance 1mm -o found --json found.json
  grep -q '^\$ voxplan found/scene.vox' out.txt && grep -q '"verdict": "clear"' found.json || fail "found: $(cat out.txt)"
  study 6 'gearbox.glb#Cover' --voxel-size 1mm --clearance 1mm --time 1s -o lost
  grep -qE '^voxplan: .*: no path found: (a search of .* s moved .* mm(, and the time limit \(--time\) ended before all objects that block it were known)?|straight along x, y and z it gets at most 0\.1 mm far \(along [-+][xy]\), and a search of .* s found no other way) \(1 mm of clearance required\); blocked by ' err.txt || fail "lost: $(cat err.txt)"
  grep -q 'class="verdict open"><strong>No path found' lost/report.html && grep -q '"kind": "no path found"' lost/verdict.json &&
    grep -q '"verdict": "not clear"' lost/verdict.json && grep -q '^No path found: .*a search of .* (1 mm of clearance required); blocked by .*\.$' lost/verdict.txt || fail "the page of a search that found none"
  says_no lost/verdict.xml Cover
  ! grep -q 'blocked by .*/' lost/verdict.txt || fail "a sentence has whole names: $(cat lost/verdict.txt)"
  # It leaves the path by which the search moved the part farthest, which voxview plays.
  grep -q '^  voxview --trace lost/farthest.csv shows how far the search moved the part$' lost/verdict.txt &&
    grep -q '<td>farthest.csv</td>' lost/report.html || fail "no trace of a search: $(cat lost/verdict.txt)"
  python3 - <<'END' || fail "farthest.csv: $(cat lost/farthest.csv)"
import csv, json, math
rows = [{key: float(cell) for key, cell in row.items()} for row in csv.DictReader(open("lost/farthest.csv"))]
best = json.load(open("lost/plan.json"))["best"]
out_m = [math.dist([row[key] for key in ("x_m", "y_m", "z_m")], [rows[0][key] for key in ("x_m", "y_m", "z_m")]) for row in rows]
assert rows[0]["t_s"] == 0 and rows[0]["z_m"] == 0, rows[0]  # where it is installed
assert abs(max(out_m) - best["out_m"]) < 0.01 and len(rows) == len(best["path"]), (out_m, best)  # the centroid, and the origin
END
  if [ "$pictures" = yes ]; then
    "$bin/voxview" draw gearbox.glb lost/scene.vox lost/part.pshell --trace lost/farthest.csv --size 64x64 --plain --json shown.json \
      --screenshot farthest.png && grep -q '"t_s"' shown.json || fail "voxview shows no search: $(cat shown.json)"
  fi
  grep -q '^forcelayer: gearbox.glb: Cover: No path found: .*; this does not prove that there is no path: try a longer' \
    err.txt && ! grep -q 'goes on' err.txt || fail "no path is an answer: $(cat err.txt)"
  # However a study ends, the command that it waits for ends too.
  for signal in TERM KILL; do
    "$bin/forcelayer" study 'gearbox.glb#Cover' --voxel-size 1mm --clearance 1mm --time 300s -o lost \
      >out.txt 2>err.txt &
    study=$!
    for _ in $(seq 600); do
      planner=$(pgrep -x -P "$study" voxplan) && break
      sleep 0.1
    done
    [ -n "$planner" ] || fail "no voxplan: $(cat out.txt err.txt)"
    # While it runs, its folder is its own.
    "$bin/forcelayer" study 'gearbox.glb#Cover' --voxel-size 2mm --pull 0,0,60mm -o lost >second.txt 2>&1
    [ $? = 1 ] && [ "$(cat second.txt)" = \
      "forcelayer: lost: --output: another study is writing to this folder; wait until it has ended, or name another folder" ] ||
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
grep -q '^forcelayer: gearbox.glb: Cover: Does not come out, straight along +z: .* deep .* (too deep from the start, worst after .* of 60 mm); also blocked by Bolt\[1\], Bolt\[2\] and Bolt\[4\]; see held/report.html$' err.txt ||
  fail "$(cat err.txt)"
grep -q 'class="verdict no"><strong>Does not come out' held/report.html || fail "the page of what is held"
says_no held/verdict.xml held/straight.csv
python3 - <<'END' || fail "what blocks the cover: $(cat held.json)"
import json, re
report, verdict = json.load(open("held.json")), json.load(open("held/verdict.json"))
assert report["verdict"] == verdict["verdict"] == "not clear" and report["kind"] == "does not come out"
assert report["sentence"] == verdict["sentence"] == open("held/verdict.txt").readline().strip(), report["sentence"]
assert report["finding"] == verdict["finding"] and " deep into " in report["finding"], report["finding"]
assert "hand" not in report["words"], report["words"]  # it feels only the voxels: the meshes have the answer
assert report["blocked_by"] == [f"Gearbox/Lid/Bolt[{n}]" for n in (1, 2, 3, 4)]
# Its page gives places in mm: at each of the bolts, which are at its corners, and at no other.
places = re.findall(r"<td>(?:[^<]* at )?x ([^ ,<]+), y ([^ ,<]+), z ([^ ,<]+) mm</td>", open("held/report.html").read())
assert len(places) == 4, places
columns = [[float(place[axis]) for place in places] for axis in range(3)]
sides_mm = 110, 70, 60
assert all(0 <= value <= side for column, side in zip(columns, sides_mm) for value in column), places
assert all(max(column) - min(column) > side / 2 for column, side in zip(columns[:2], sides_mm)) and min(columns[2]) > 30, places
END
[ -s held/trace.csv ] && [ -s held/motion.glb ] || fail "no trace of what is held: $(ls held)"
# Its picture says what the verdict says, and shows one of the bolts.
cp "$bin/forcelayer" drawn
printf '#!/bin/bash\nprintf "%%s\\n" "$@" >drawn/words.txt\nwhile [ "$1" != --screenshot ]; do shift; done\ntouch "$2"\n' >drawn/voxview
rm held/curve.csv
PATH=$bin:$PATH drawn/forcelayer study 'gearbox.glb#Cover' --voxel-size 1mm --pull 0,0,60mm --clearance 1mm -o held >out.txt 2>&1
python3 - <<'END' || fail "the picture of what is held: $(cat out.txt drawn/words.txt)"
import json
words, verdict = open("drawn/words.txt").read().splitlines(), json.load(open("held/verdict.json"))
told = lambda option: words[words.index(option) + 1]
assert told("--title").startswith("Does not come out, straight along +z"), told("--title")
assert told("--measure-object") == verdict["told_moment"]["object"] and verdict["told_moment"]["object"] in verdict["blocked_by"], verdict["told_moment"]
END
printf 't_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0.06\n' >up.csv
# At 3 mm the bolt heads are too narrow to be felt: the meshes tell. Without meshes it stays open what passes in a seat.
study 6 'gearbox.glb#Cover' --voxel-size 3mm --path up.csv --clearance 1mm -o given
grep -q 'class="verdict no"><strong>Does not come out, straight along +z</strong>' given/report.html || fail "the page of what is not clear"
grep -q 'goes [0-9.]* mm deep into Bolt' given/report.html && grep -q '<td>[0-9.]* mm deep</td>' given/report.html || fail "the page does not say what is wrong"
study 6 'bore.json#pin' --voxel-size 3mm --path up.csv --clearance 1mm -o given --files-alone
grep -q '<strong>Undecided, ' given/report.html && grep -q '<td>in its seat, overlap not known</td>' given/report.html ||
  fail "the page does not say that the seat is not settled"
# The files do not know that the pin touches its bore, and do not say so: 0.098 mm are between them.
! grep -q 'touches' given/verdict.txt && grep -q ' in its seat the part comes nearer than [0-9.]* mm to [a-zA-Z]*, and without meshes, features narrower than [0-9.]* mm are not seen ' given/verdict.txt ||
  fail "contact that is not known: $(cat given/verdict.txt)"
grep -q '^  leave out --files-alone: meshes can give an answer$' given/verdict.txt && grep -q 'leave out --files-alone: meshes can give an answer' given/report.html ||
  fail "the reports do not say what decides: $(cat given/verdict.txt)"
python3 - <<'END' || fail "the page gives other bounds than the terminal: $(cat given/verdict.txt)"
import html, re
bounds = re.findall("at least [0-9.]+ mm and at most [0-9.]+ mm", open("given/verdict.txt").read())
page = html.unescape(open("given/report.html").read())
shown = re.findall("at least [0-9.]+ mm,? (?:and )?at most [0-9.]+ mm", page.split("</p>", 1)[1])
assert bounds and shown and set(shown) <= set(bounds), (bounds, shown)
END
grep -q '; leave out --files-alone: meshes can give an answer; see given/report\.html$' err.txt || fail "no way on without the meshes: $(cat err.txt)"

# A part that touches nothing as installed comes out, or does not, all the same.
study 0 'bore.json#pin' --voxel-size 2mm --pull 0,0,100mm --clearance 0.05mm --no-pictures -o free
grep -q '^Comes out, straight along +z: stays 0\.098 mm away or more (measured to plate, ' free/verdict.txt || fail "free as installed: $(cat free/verdict.txt)"
study 6 'bore.json#pin' --voxel-size 2mm --pull 30mm,0,0 --clearance 0.05mm --no-pictures -o free
grep -q '^Does not come out, straight along +x: meets plate, at least ' free/verdict.txt || fail "caught as installed: $(cat free/verdict.txt)"

# A part whose mesh is open stands on a floor whose mesh is closed. A pin overlaps its bore by 0.3 mm as modelled. A bar is 0.345 mm
# beside another one, and its path is searched.
cp "$FORCELAYER_SOURCE_DIR/tests/support/boxes.py" .
python3 - <<'END'
import json
from bore import block
from boxes import boxes
boxes("floor.obj", ((-30, -30, -10), (30, 30, 0)))
boxes("box.obj", ((-5, -5, 0), (5, 5, 10)))
*lines, last = open("box.obj").read().splitlines()
open("open.obj", "w").write("\n".join([*lines, " ".join(last.split()[:4])]) + "\n")  # without a triangle
*lines, last = open("floor.obj").read().splitlines()
open("leaky.obj", "w").write("\n".join([*lines, " ".join(last.split()[:4])]) + "\n")
block("thick.obj", 10.4, 0, 60)
boxes("wall.obj", ((6, -10, 0), (8, 10, 20)))
for n in range(20):
    boxes(f"post{n}.obj", ((-4.2 + 0.4 * n, -1, 20), (-4 + 0.4 * n, 1, 22)))
boxes("left.obj", ((-1, -10, -1), (1, 10, 1)))
boxes("near.obj", ((1.345, -10, -1), (3, 10, 1)))
boxes("right.obj", ((1.58, -10, -1), (3, 10, 1)))
for scene, meshes in (("stood", ("floor", "open")), ("leaky", ("leaky", "open")), ("walled", ("floor", "box", "wall")), ("posts", ("floor", "box", *(f"post{n}" for n in range(20)))), ("press", ("plate", "thick")), ("beside", ("left", "near")),
                      ("apart", ("left", "right"))):
    json.dump({"parts": [{"name": name, "mesh": name + ".obj", "units": "mm"} for name in meshes]}, open(scene + ".json", "w"))
END
study 0 'stood.json#open' --pull 0,0,40mm --voxel-size 0.5mm --no-pictures -o stood
grep -q 'warning: the surface is not a closed solid, with 3 open edges' err.txt || fail "the part is not open: $(cat err.txt)"
grep -q '^Comes out, straight along +z: leaves floor within the first 1 mm, otherwise stays 1[0-9.]* mm away or more (measured to floor, ' stood/verdict.txt &&
  grep -q '^  in its seat, the part never goes deeper than installed$' stood/verdict.txt || fail "an open part on a closed floor: $(cat stood/verdict.txt)"
# Where cracks of a mesh limit what is known of the seat, the first sentence says so, with the figure. More than the
# required clearance leaves the answer undecided, unless it is accepted.
python3 - <<'END'
import json
from boxes import cracked_box
cracked_box("cracked.obj", (-30, -30, -10), (30, 30, 0), 0.02)
json.dump({"parts": [{"name": name, "mesh": name + ".obj", "units": "mm"} for name in ("cracked", "box")]}, open("cracked.json", "w"))
END
study 0 'cracked.json#box' --pull 0,0,40mm --voxel-size 0.5mm --no-pictures -o cracked
study 6 'cracked.json#box' --pull 0,0,40mm --clearance 0mm --voxel-size 0.5mm --no-pictures -o undecided
grep -q '; close the cracks of the meshes, or accept such a depth with --seat-depth; see undecided/report\.html$' err.txt ||
  fail "no way on from cracks at the contact: $(cat err.txt)"
study 0 'cracked.json#box' --pull 0,0,40mm --clearance 0mm --seat-depth 0.2mm --voxel-size 0.5mm --no-pictures -o accepted
python3 - <<'END' || fail "a mesh with cracks: $(cat cracked/verdict.txt undecided/verdict.txt)"
import json, re
verdicts = {name: json.load(open(name + "/verdict.json")) for name in ("cracked", "undecided", "accepted")}
words = r"a collision with cracked of up to ([0-9.]+) mm is not ruled out, because the meshes have cracks"
for name, begin, end in (("cracked", "Comes out, ", "."), ("accepted", "Comes out, ", "."), ("undecided", "Undecided, straight along +z: ", " (0 mm of clearance required).")):
    verdict = verdicts[name]
    [seat] = verdict["seat_depths"]
    [told] = re.findall(words + re.escape(end) + "$", verdict["sentence"])
    assert verdict["sentence"].startswith(begin) and seat["settled"], verdict["sentence"]
    depth_m = 2e-4 if name == "accepted" else 0  # --seat-depth
    assert 0.02 < float(told) < 0.2 and 0 <= float(told) - 1e3 * (seat["allowed_m"] - seat["installed_m"] - depth_m) <= 1e-3, (told, seat)
END
study 6 'leaky.json#open' --pull 0,0,40mm --voxel-size 0.5mm --no-pictures -o leaky
grep -q '; close all open edges of one of the two meshes, and repeat the study; see leaky/report\.html$' err.txt ||
  fail "no way on from two open meshes: $(cat err.txt)"
# A wall that is exactly as far away as required is no object of the seat: the part may not come nearer to it.
printf 't_s,x_mm,y_mm,z_mm\n0,0,0,0\n1,0.1,0,0\n2,0.1,0,60\n' >toward.csv
study 6 'walled.json#box' --path toward.csv --voxel-size 0.5mm --clearance 1mm --no-pictures -o walled
grep -q '^Does not keep the clearance, .* comes as near as 0\.9 mm (measured to wall, ' walled/verdict.txt || fail "nearer than required to a wall: $(cat walled/verdict.txt)"
# A nearer one is, whatever the voxels.
for size in 0.2mm 0.5mm 2mm; do
  study 0 'walled.json#box' --path toward.csv --voxel-size $size --clearance 1.001mm --no-pictures -o walled
  grep -q ' and passes wall with a gap of 0\.9 mm for the first ' walled/verdict.txt || fail "a wall of the seat, $size: $(cat walled/verdict.txt)"
done
# Where a straight path is too near to something, the answer is how near: no hand's path is checked.
study 6 'walled.json#box' --pull 0.1mm,0,60mm --voxel-size 0.5mm --clearance 1mm --no-pictures -o slanted
grep -q '^Does not keep the clearance, ' slanted/verdict.txt && [ ! -e slanted/hand.json ] || fail "a slanted pull: $(cat slanted/verdict.txt)"
# All that is in the way is named, each with a place in it.
study 6 'posts.json#box' --pull 0,0,40mm --voxel-size 0.5mm --no-pictures -o posts --json posts_study.json
python3 - <<'END' || fail "twenty posts: $(cat posts_study.json)"
import json
report = json.load(open("posts_study.json"))
assert sorted(report["blocked_by"]) == sorted(f"post{n}" for n in range(20)), report["blocked_by"]
deep = [v for v in report["check"]["violations"] if v.get("depth_m", 0) > 0]
assert len(deep) > 15, deep
for v in deep:
    low, high = -4.2 + 0.4 * int(v["object"][4:]), 22
    x, y, z = (1e3 * c for c in v["point_m"])
    assert low - 1e-3 < x < low + 0.2 + 1e-3 and abs(y) < 1.001 and 19.999 < z < high + 1e-3, v
END
# A report of a study has the status of the study.
python3 -c 'import json; assert json.load(open("leaky/verdict.json"))["exit_status"] == 6 and json.load(open("walled/verdict.json"))["exit_status"] == 0' ||
  fail "the status in a report of a study"
study 7 'press.json#thick' --pull 0,0,100mm --no-pictures -o press --json press_report.json
grep -q '^Comes out, straight along +z, if force overcomes its overlap with plate (at least 0\.3 mm when installed): slides along plate for the first 41 mm, otherwise stays 1[0-9.]* mm away or more (measured to plate, ' press/verdict.txt &&
  grep -q '^  where the part is installed, it overlaps plate by at least 0\.3 mm; the force that this takes is not computed$' press/verdict.txt || fail "overlap as modelled: $(cat press/verdict.txt)"
grep -q '; if the overlap is intended, accept exit status 7; see press/report\.html$' err.txt || fail "an overlap says nothing to a pipeline: $(cat err.txt)"
says_no press/verdict.xml press/straight.csv
python3 - <<'END' || fail "all reports of an overlap: $(cat press/verdict.json)"
import json
report, verdict = json.load(open("press_report.json")), json.load(open("press/verdict.json"))
assert [(r["kind"], r["verdict"], r["exit_status"]) for r in (report, verdict)] == 2 * [("comes out with overlap", "not clear", 7)], verdict
assert f'class="verdict force"><strong>{verdict["heading"]}</strong>' in open("press/report.html").read(), "the page"
END
if [ -x "$bin/voxplan" ]; then
  for size in auto 0.3mm; do
    study 0 'beside.json#left' --clearance 0.2mm --voxel-size $size --no-pictures -o beside
    grep -q '^\$ voxplan ' out.txt && grep -q '^Comes out, .*: stays 0\.345 mm away or more (measured to near, .*; 0\.2 mm required)\.$' beside/verdict.txt ||
      fail "0.345 mm beside another object, voxels of $size: $(cat out.txt beside/verdict.txt)"
  done
  # Where the files prove too little to search at all (0.58 mm are 2.9 voxels), the meshes prove a straight path.
  study 0 'apart.json#left' --clearance 0.534mm --no-pictures -o apart --json apart_report.json
  python3 - <<'END' || fail "where the files prove too little: $(cat apart_report.json)"
import json
report = json.load(open("apart_report.json"))
assert report["voxel_sizes_tried"] == [] and report["voxel_size_m"] == 2e-4, report["voxel_sizes_tried"]
assert report["sentence"].startswith("Comes out, ") and "stays 0.58 mm away" in report["sentence"], report["sentence"]
END
fi

# A part that has left its seat hits something: the seat ends where its own objects are far, as without the other object.
python3 - <<'END'
import json
from bore import block
block("shelf.obj", 50, 75, 85)
block("bar.obj", 50, 120, 130)
block("table.obj", 50, -40, 0)
block("sunk.obj", 10, -9, 30)
block("pressed.obj", 5, -0.3, 10)
manifest = json.load(open("bore.json"))
manifest["parts"] += [{"name": name, "mesh": name + ".obj", "units": "mm"} for name in ("shelf", "bar")]
json.dump(manifest, open("shelved.json", "w"))
for part in "sunk", "pressed":
    json.dump({"parts": [{"name": name, "mesh": name + ".obj", "units": "mm"} for name in ("table", part)]}, open(part + ".json", "w"))
END
for files in "" --files-alone; do
  # shellcheck disable=SC2086  # a word or none
  study 6 'shelved.json#pin' --pull 0,0,150mm --voxel-size 2mm --no-pictures -o "shelved$files" --json report.json $files
  python3 - "$files" <<'END' || fail "the end of the seat $files: $(cat report.json)"
import json, re, sys
report = json.load(open("report.json"))
[seated] = report["check"]["seated"]
end_mm, within_mm = (42.4, 1.5) if sys.argv[1] else (41, 0.05)
assert abs(1e3 * seated["to_m"] - end_mm) < within_mm and seated["object"] == "plate", seated
# By the files alone contact in the seat is not certain.
words = "goes into shelf .too near from 1[234]." if sys.argv[1] else "meets shelf.* .contact from 1"
assert re.match(r"Does not come out, straight along \+z: " + words + "[0-9.]+ mm on, worst after ", report["sentence"])
if not sys.argv[1]:  # each that is met, though the part meets the second before it has left the first
    assert sorted(report["blocked_by"]) == ["bar", "shelf"], report["blocked_by"]
    hits = {hit["object"]: [1e3 * hit[key] for key in ("from_m", "to_m")] for hit in report["check"]["violations"]}
    contact = {hit["object"]: 1e3 * hit["contact_from_m"] for hit in report["check"]["violations"]}
    for name, stretch_mm in ("shelf", (14, 86)), ("bar", (59, 131)):
        assert max(abs(a - b) for a, b in zip(hits[name], stretch_mm)) < 0.05, hits
        assert abs(contact[name] - stretch_mm[0] - 1) < 0.05, contact  # too near 1 mm before
    assert report["check"]["min_clearance"]["object"] == "shelf", "not the object that the sentence names"
END
done
# The output is the answer, once, and none of a simulated hand's.
[ "$(grep -c 'oes not come out' out.txt)" = 1 ] || fail "more than one answer: $(cat out.txt)"
# Where smaller voxels give no answer, that of larger ones stays, with the reason. An answer is open without the meshes.
study 6 'sunk.json#sunk' --pull 0,0,100mm --no-pictures -o sunk --files-alone
grep -q '^  voxels of 1 mm, the smallest that gave an answer; voxels of 0\.2 mm gave no answer: voxrun ended with status 2: ' sunk/verdict.txt ||
  fail "an answer is lost: $(cat out.txt err.txt)"
# With the meshes an overlap of 9 mm is a finding, and no advice about options of a bake.
for size in auto 0.5mm; do
  study 7 'sunk.json#sunk' --pull 0,0,100mm --voxel-size $size --no-pictures -o deep
  grep -q '^Comes out, straight along +z, if force overcomes its overlap with table (at least 9 mm when installed): slides along table for the first 10 mm, ' deep/verdict.txt &&
    ! grep -hE -- '--(range|free-seed|units)' err.txt deep/verdict.txt || fail "an overlap of 9 mm, $size: $(cat deep/verdict.txt err.txt)"
done
# Deeper distances are stored where the part overlaps a neighbor by more than half of a voxel: no step is refused then.
study 7 'pressed.json#pressed' --pull 0,0,40mm --no-pictures -o pressed
[ "$(wc -l <err.txt)" = 1 ] && grep -q '^Comes out, .*, if force overcomes its overlap with table (at least 0\.3 mm when installed): leaves table ' pressed/verdict.txt &&
  grep -q '^  voxels of 0\.1 mm, chosen: ' pressed/verdict.txt || fail "0.3 mm of overlap: $(cat pressed/verdict.txt err.txt)"
# A run of the same files has the same words and status.
status=0
"$bin/voxrun" pressed/scene.vox pressed/part.pshell --pull 0,0,40mm --as-fast-as-possible --json pulled.json >out.txt 2>err.txt || status=$?
[ $status = 7 ] && grep -q '^Comes out, if force overcomes its overlap with table (at least 0\.[0-9]* mm when installed): the part leaves table after ' out.txt &&
  grep -q '^voxrun: .*: comes out, if force overcomes .*; if the overlap is intended, accept exit status 7$' err.txt &&
  grep -q '"exit_status": 7' pulled.json || fail "a run of a part that overlaps: status $status: $(cat out.txt err.txt)"
# Nor was a clearance given: then it is 1 mm, as of voxcheck.
python3 -c 'import json; assert json.load(open("sunk/verdict.json"))["required_clearance_m"] == 0.001' ||
  fail "the default of --clearance: $(cat sunk/verdict.json)"
# A measurement needs no folder, and is no answer.
study 0 'gearbox.glb#Cover' --plan --clearance 12.7mm
grep -q '^smallest gap when installed: ' out.txt && [ ! -s err.txt ] || fail "a measurement: $(cat out.txt err.txt)"
study 2 'gearbox.glb#Cover'
grep -q '^forcelayer: --output: is required; see forcelayer study --help$' err.txt || fail "no folder: $(cat err.txt)"

# One pose, in seconds since 1970: ticks of its curve's nanosecond are nearer than doubles.
printf 't_s,x_m,y_m,z_m\n1700000000,0,0,0.2\n' >late.csv
(ulimit -v 4000000
 "$bin/forcelayer" study 'gearbox.glb#Pin' --voxel-size 2mm --path late.csv --clearance 1mm -o late) >out.txt 2>&1 ||
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
grep -q '^forcelayer: pointshell: ended with status 3, so the study is not finished; see the error above$' err.txt ||
  fail "a name that is wrong stays wrong: $(cat err.txt)"
study 1 'gearbox.glb#Pin' --voxel-size 1mm --path none.csv -o nowhere
[ ! -s out.txt ] && [ ! -e nowhere ] || fail "something was baked for a path that is not there: $(cat out.txt)"
# All verdicts have lengths and places in mm. Times are only those of the computation.
! grep -nE '[0-9)] [ms]([,;:). ]|$)' */verdict.txt | grep -vE ':(  time: |  voxels of |  the answer is still open |  smaller voxels |No path found: .*a search of )' || fail "meters or seconds in a verdict"
finish
