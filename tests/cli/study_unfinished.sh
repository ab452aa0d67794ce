#!/usr/bin/env bash
# forcelayer study: a page, a verdict and a JUnit file that say why, however a study ends; none of an earlier study stays.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
cp "$data/gearbox.glb" .
cp "$FORCELAYER_SOURCE_DIR/tests/support/bore.py" .
python3 -c 'from bore import bore; bore()'

# study STATUS ARGUMENTS...
study() {
  local wanted=$1 status=0
  shift
  "$bin/forcelayer" study "$@" --no-pictures >out.txt 2>err.txt || status=$?
  [ "$status" -eq "$wanted" ] || fail "status $status instead of $wanted: $*: $(cat out.txt err.txt)"
}

# says FOLDER KIND PATTERN [EXIT_STATUS]: all files of a verdict say the same.
says() {
  python3 - "$@" <<'END' || fail "$1 does not say '$2': $(cat "$1"/verdict.*)"
import html, json, re, sys, xml.etree.ElementTree as tree
folder, kind, pattern, *status = sys.argv[1:]
text = open(f"{folder}/verdict.txt").read()
verdict = json.load(open(f"{folder}/verdict.json"))
[box] = re.findall('<p class="verdict (.*?)">(.*?)</p>', open(f"{folder}/report.html").read(), re.S)
assert html.unescape(re.sub("<[^>]*>", "", box[1])).strip() == text.strip(), box
assert text.startswith(verdict["sentence"]) and verdict["kind"] == kind, verdict
assert re.search(pattern, verdict["sentence"]), verdict["sentence"]
is_yes = kind == "comes out"
assert verdict["verdict"] == ("clear" if is_yes else "not clear")
assert box[0] == ("yes" if is_yes else "open" if kind in ("undecided", "no path found", "refused") else "no"), box[0]
assert not status or verdict["exit_status"] == int(status[0]), verdict["exit_status"]
suite = next(tree.parse(f"{folder}/verdict.xml").getroot().iter("testsuite"))
wrong = [int(suite.get(key)) for key in ("failures", "errors")]
assert wrong == ([0, 0] if is_yes else [0, 1] if "not finished" in text else [1, 0]), wrong
END
}

# no_foreign_options: what a reader sees names no option that a study does not have. Commands that were run do.
no_foreign_options() {
  "$bin/forcelayer" study --help | grep -oE -- '--[a-z][a-z-]+' | sort -u >own.txt
  grep -v '^\(\$\|unchanged:\|  voxview\) ' out.txt | cat - err.txt | grep -oE -- '--[a-z][a-z-]+' | sort -u | comm -13 own.txt - >foreign.txt
  [ ! -s foreign.txt ] || fail "a study names $(cat foreign.txt): $(cat out.txt err.txt)"
}

pin=('gearbox.glb#Pin' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm)
study 0 "${pin[@]}" -o pin
says pin "comes out" '^Comes out, '

# After a study that comes out, each one that fails in the same folder says so, in the words of its command.
study 3 'gearbox.glb#Pim' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o pin --json pim.json
says pin refused "^Refused: the study is not finished: pointshell ended with status 3: .*#Pim: no node has this name; the nearest names are: [^()]*\.$" 3
python3 -c 'import json; r = json.load(open("pim.json")); assert r["exit_status"] == 3 and r["kind"] == "refused" and r["error"]["code"] // 100 == 3, r' ||
  fail "the report of a study that failed"
[ ! -e pin/curve.csv ] || fail "the curve of another answer stays"
study 0 "${pin[@]}" -o pin
says pin "comes out" '^Comes out, '
study 1 'gearbix.glb#Pin' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o pin
says pin undecided 'not finished: gearbix.glb: no such file' 1
study 0 "${pin[@]}" -o pin

# The same study again leaves all as it was, and a step that failed is tried again.
cp -r pin before
study 0 "${pin[@]}" -o pin
grep -q '^\$' out.txt && fail "done again: $(cat out.txt)"
cmp -s before/report.html pin/report.html && cmp -s before/verdict.json pin/verdict.json || fail "the same study says something else"
(
  ulimit -f 8
  study 1 'gearbox.glb#Pin' --voxel-size 1mm --pull 0,0,60mm --clearance 1mm -o pin
) || exit 1
says pin undecided 'pointshell ended with status 1: .*part.pshell: cannot be written' 1
study 0 'gearbox.glb#Pin' --voxel-size 1mm --pull 0,0,60mm --clearance 1mm -o pin
says pin "comes out" '^Comes out, '

# The last part of an assembly has nothing that could block it, whichever way the others were left out.
for words in 'bore.json#pin --without plate' 'gearbox.glb#Gearbox'; do
  # shellcheck disable=SC2086  # words
  study 3 $words --voxel-size 2mm --pull 0,0,60mm -o last
  says last refused 'not finished: voxelize ended with status 3: .*; nothing can block the last part of an assembly' 3
done

# A mesh that is broken, and a part that lies deeper in its neighbor than can be stored.
head -c 3000 "$data/gearbox.glb" >broken.glb
study 3 'broken.glb#Pin' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o broken
says broken refused 'not finished: pointshell ended with status 3: broken.glb: ' 3
python3 - <<'END'
import json
from bore import block
block("table.obj", 50, -40, 0)
block("sunk.obj", 10, -20, 30)
block("shelf.obj", 50, 60, 70)
json.dump({"parts": [{"name": name, "mesh": name + ".obj", "units": "mm"} for name in ("table", "sunk", "shelf")]},
          open("sunk.json", "w"))
END
study 2 'sunk.json#sunk' --voxel-size 0.5mm --pull 0,0,100mm --clearance 1mm -o sunk
says sunk refused 'not finished: voxcheck ended with status 2: .*the part starts more than [0-9.]* mm inside the scene; check --units; leave out the objects that enclose or overlap the part' 2
no_foreign_options
if [ -x "$bin/voxplan" ]; then
  study 2 'sunk.json#sunk' --voxel-size 0.5mm --time 1s --clearance 1mm -o sunk
  says sunk refused 'not finished: voxplan ended with status 2: .*the part starts more than' 2
  no_foreign_options
fi

# A part in a closed cavity, which voxels fill: the meshes say that it does not come out, and what holds it.
cp "$FORCELAYER_SOURCE_DIR/tests/support/boxes.py" .
python3 - <<'END'
import json
from boxes import boxes
boxes("cube.obj", ((-5, -5, -5), (5, 5, 5)))
boxes("case.obj", ((-25, -25, -25), (25, 25, 25)))
boxes("hollow.obj", ((-20, -20, -20), (20, 20, 20)))
outer, inner = (open(name + ".obj").read().splitlines() for name in ("case", "hollow"))
turned = [" ".join(["f", *line.split()[:0:-1]]) if line.startswith("f ") else line for line in inner]
open("case.obj", "w").write("\n".join(outer + turned) + "\n")
half = lambda lines: lines[:-1] + [" ".join(lines[-1].split()[:4])]  # of its last face, a triangle is left
open("torn.obj", "w").write("\n".join(half(outer) + half(turned)) + "\n")
for scene, case in ("cased", "case"), ("torn", "torn"):
    json.dump({"parts": [{"name": name, "mesh": name + ".obj", "units": "mm"} for name in (case, "cube")]}, open(scene + ".json", "w"))
END
for size in 2mm auto; do
  study 6 'cased.json#cube' --voxel-size $size --pull 0,0,100mm -o cased
  says cased "does not come out" '^Does not come out, straight along [+]z: meets case, at least [45](\.[0-9]+)? mm deep \(contact from 15 mm on, ' 6
  grep -q '^  case encloses the part on all sides, so no other path leads out either$' cased/verdict.txt || fail "$(cat cased/verdict.txt)"
  no_foreign_options
done
grep -q '^  when installed, no object is nearer than the required clearance$' cased/verdict.txt || fail "as installed: $(cat cased/verdict.txt)"
# A path that ends in the cavity leads nowhere.
study 6 'cased.json#cube' --voxel-size 2mm --pull 0,0,10mm -o cased --json cased_report.json
says cased "does not come out" '^Does not come out, straight along [+]z: the part is enclosed on all sides \(1 mm of clearance required\); blocked by case\.$' 6
study 2 'cased.json#cube' --voxel-size 2mm --pull 0,0,100mm --files-alone -o cased
says cased refused 'ended with status 2: .*inside the scene; check --units; leave out the objects that enclose or overlap the part \(--without\), or use' 2
no_foreign_options
if [ -x "$bin/voxplan" ]; then
  # No search is needed, whatever the voxels, and it says how far the part moves.
  for size in 2mm auto; do
    study 6 'cased.json#cube' --voxel-size $size --time 60s -o cased --json cased_report.json
    says cased "does not come out" '^Does not come out: the part is enclosed on all sides, and moves at most 15(\.001)? mm straight along the axes x, y and z \(1 mm of clearance required\); blocked by case\.$' 6
    python3 -c 'import json; r = json.load(open("cased_report.json")); assert r["blocked_by"] == ["case"] and not r.get("voxel_sizes_tried"), r' ||
      fail "what encloses the cube: $(cat cased_report.json)"
    no_foreign_options
  done
  # At the smallest size the answer is as open, where a mesh proves nothing.
  study 6 'torn.json#cube' --clearance 10mm --time 60s -o cased --json cased_report.json
  says cased "no path found" '^No path found: ' 6
  grep -qE '^  (voxels of 0\.[25] mm; with smaller ones, down to 0\.1 mm, no path was found either; |smaller voxels might change the answer; none are smaller than 0\.1 mm: )with smaller voxels the required clearance would have too many voxels to search$' cased/verdict.txt ||
    fail "the smallest size: $(cat cased/verdict.txt)"
  no_foreign_options
fi

# A part that has room, in a box with a small window: the search says how far it moved, also where the clearance is larger
# than what is stored around the box.
if [ -x "$bin/voxplan" ]; then
  python3 - <<'END'
import json
from boxes import boxes
boxes("box.obj", ((-25, -25, -25), (25, 25, -20)), ((-25, -25, -20), (-20, 25, 20)), ((20, -25, -20), (25, 25, 20)), ((-20, -25, -20), (20, -20, 20)),
      ((-20, 20, -20), (20, 25, 20)), ((-25, -25, 20), (-2, 25, 25)), ((2, -25, 20), (25, 25, 25)), ((-2, -25, 20), (2, -2, 25)), ((-2, 2, 20), (2, 25, 25)))
json.dump({"parts": [{"name": name, "mesh": name + ".obj", "units": "mm"} for name in ("box", "cube")]}, open("box.json", "w"))
END
  for size in 1mm 2mm; do
    study 6 'box.json#cube' --voxel-size $size --clearance 10mm --time 6s -o box
    says box "no path found" '^No path found: straight along x, y and z it gets at most (5|10)(\.[0-9]+)? mm far \(along [-+][xyz]\), and a search of .* s' 6
  done
fi

# A search that finds nothing, and after it, in the same folder, a path that is clear.
if [ -x "$bin/voxplan" ]; then
  study 6 'gearbox.glb#Cover' --voxel-size 2mm --clearance 1mm --time 1s -o cover
  says cover "no path found" '^No path found: ' 6
  study 0 "${pin[@]}" -o cover
  says cover "comes out" '^Comes out, '
fi
study 6 'gearbox.glb#Cover' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm -o cover
says cover "does not come out" '^Does not come out, '

# Stopped at each stage: by a signal that it can answer, it says which; by SIGKILL, that it is not finished.
cat >stop.py <<'END'
"""stop.py SIGNAL PROGRAM ARGUMENTS...: sends the signal when a study runs the program; its exit status, 128+n on signal n."""
import os, signal, subprocess, sys, time
name, program = sys.argv[1:3]
number = getattr(signal, "SIG" + name)
study = subprocess.Popen(sys.argv[3:], stdout=subprocess.PIPE, stderr=open("err.txt", "w"), text=True)
for line in study.stdout:
    if line.startswith("$ " + program):
        # The files say so before the program starts.
        page = os.path.join(sys.argv[sys.argv.index("-o") + 1], "report.html")
        while f"the step {program} is running" not in open(page).read():
            time.sleep(0.01)
        study.send_signal(number)
        study.send_signal(number)  # as `timeout` sends it, to the command and to its group
        break
else:
    sys.exit("it does not run " + program)
status = study.wait(timeout=60)
sys.exit(128 - status if status < 0 else status)
END
# A study finds its programs beside itself, else in PATH: here one that does not end.
mkdir slow
cp "$bin/forcelayer" slow
export PATH=$bin:$PATH
# stopped STATUS SIGNAL PROGRAM ARGUMENTS...
stopped() {
  local wanted=$1 signal=$2 program=$3 status=0
  shift 3
  printf '#!/bin/sh\nexec sleep 60\n' >"slow/$program"
  chmod +x "slow/$program"
  cp -r before "stopped$signal$program"
  python3 stop.py "$signal" "$program" slow/forcelayer study "$@" --no-pictures -o "stopped$signal$program" || status=$?
  rm "slow/$program"
  [ "$status" -eq "$wanted" ] || fail "status $status instead of $wanted: SIG$signal in $program: $(cat err.txt)"
}
cover=('gearbox.glb#Cover' --voxel-size 2mm --pull 0,0,60mm --clearance 1mm)
for program in voxelize pointshell voxrun voxcheck; do
  stopped 143 TERM $program "${cover[@]}"
  says stoppedTERM$program undecided "^Undecided: the study is not finished: SIGTERM stopped the step $program\\.$" 143
done
stopped 130 INT voxelize "${cover[@]}"
says stoppedINTvoxelize undecided 'SIGINT stopped the step voxelize\.$' 130
grep -q 'contains the finished steps; the same command continues from there$' err.txt || fail "no line says how to go on: $(cat err.txt)"
if [ -x "$bin/voxplan" ]; then
  stopped 129 HUP voxplan 'gearbox.glb#Cover' --voxel-size 2mm --clearance 1mm
  says stoppedHUPvoxplan undecided 'SIGHUP stopped the step voxplan\.$' 129
fi
stopped 137 KILL voxrun "${cover[@]}"
says stoppedKILLvoxrun undecided '^Undecided: the study is not finished: the step voxrun is running, or was stopped\.$'
study 6 "${cover[@]}" -o stoppedKILLvoxrun
says stoppedKILLvoxrun "does not come out" '^Does not come out, '
# A study with a voxel size of its own choice goes on with the files that are whole, and does not take its first look again.
if [ -x "$bin/voxplan" ]; then
  stopped 130 INT voxplan 'gearbox.glb#Pin' --clearance 1mm
  study 0 'gearbox.glb#Pin' --clearance 1mm -o stoppedINTvoxplan
  says stoppedINTvoxplan "comes out" '^Comes out, straight along '
  ! grep -qE '^\$ (voxelize|pointshell)' out.txt || fail "whole files are baked again: $(cat out.txt)"
  # It has a limit all the same, and says so, and where the time went.
  grep -qE '^\$ voxplan .* --time 3[0-9](\.[0-9]+)?s$' out.txt || fail "a search without a limit: $(cat out.txt)"
  grep -qE '^  time: [0-9.]+ of 120 s \(bakes [0-9.]+ s, checks [0-9.]+ s, search [0-9.]+ s\); --time changes the limit$' stoppedINTvoxplan/verdict.txt ||
    fail "where the time went: $(cat stoppedINTvoxplan/verdict.txt)"
fi
# Where --time stops smaller voxels, the answer of larger ones stays, with all its files.
if [ -x "$bin/voxplan" ]; then
  cat >slow/voxplan <<'END'
#!/bin/bash
# Searches for one second. From the second time on, as if a path were found.
while [ "${1:-}" != --time ]; do words+=("$1"); shift; done
if [ -e searched ]; then
  cp up.csv late/path.csv && echo '{}' >late/plan.json
else
  touch searched
  exec "$bin/voxplan" "${words[@]}" --time 1s
fi
END
  cat >slow/voxcheck <<'END'
#!/bin/bash
# Gives the check of that path no time.
words=("$@")
for n in "${!words[@]}"; do [ ! -e late/path.csv ] || [ "${words[n]}" != --time ] || words[n + 1]=1e-9s; done
exec "$bin/voxcheck" "${words[@]}"
END
  chmod +x slow/voxplan slow/voxcheck
  printf 't_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0.06\n' >up.csv
  for again in "" again; do
    status=0
    bin=$bin slow/forcelayer study 'gearbox.glb#Cover' --clearance 1mm --time 100s --no-pictures -o late --json late.json >out.txt 2>err.txt || status=$?
    [ $status = 6 ] && grep -q '^  voxels of 1 mm, the smallest that gave an answer; --time (100s) ended before voxels of 0\.5 mm gave an answer$' late/verdict.txt ||
      fail "an answer is lost $again: $status $(cat late/verdict.txt err.txt)"
    says late "no path found" '^No path found: ' 6
    python3 - <<'END' || fail "the files of the answer $again: $(ls late) $(cat late.json)"
import json, os
report, scene = json.load(open("late.json")), json.load(open("late/scene.json"))
assert report["voxel_size_m"] == scene["voxel_size_m"] == 1e-3 and report["voxel_sizes_tried"] == [], report
assert not os.path.exists("late/larger_voxels") and not os.path.exists("late/motion.glb") and os.path.exists("late/farthest.csv")
END
  done
  grep -q '^\$' out.txt && fail "the answer that stays is done again: $(cat out.txt)"
  # Without --time, the last check is finished, and the verdict says how to change the limit of the rest.
  rm -r searched late
  status=0
  bin=$bin slow/forcelayer study 'gearbox.glb#Cover' --clearance 1mm --no-pictures -o late >out.txt 2>err.txt || status=$?
  [ $status = 6 ] && grep -q '^Does not come out, straight along +z: ' late/verdict.txt &&
    grep -qE '^  time: [0-9.]+ of 120 s \(.*\); --time changes the limit$' late/verdict.txt ||
    fail "a check without a limit: $status $(cat late/verdict.txt err.txt)"
  rm slow/voxcheck
  # So it does where Ctrl-C stops smaller voxels, and the same command goes on with them.
  rm searched
  cat >slow/voxplan <<'END'
#!/bin/bash
# Searches for one second. The second time, Ctrl-C is pressed.
if [ -e searched ]; then
  kill -INT $PPID
  exec sleep 60
fi
touch searched
while [ "${1:-}" != --time ]; do words+=("$1"); shift; done
exec "$bin/voxplan" "${words[@]}" --time 1s
END
  status=0
  bin=$bin slow/forcelayer study 'gearbox.glb#Cover' --clearance 1mm --time 100s --no-pictures -o ended --json ended.json >out.txt 2>err.txt || status=$?
  [ $status = 6 ] && grep -q '^  voxels of 1 mm, the smallest that gave an answer; SIGINT stopped the study before voxels of 0\.5 mm gave an answer; the same command continues from there$' ended/verdict.txt ||
    fail "Ctrl-C loses an answer: $status $(cat ended/verdict.txt err.txt)"
  says ended "no path found" '^No path found: ' 6
  python3 - <<'END' || fail "the files of the answer after Ctrl-C: $(ls ended) $(cat ended.json)"
import json, os
report, scene = json.load(open("ended.json")), json.load(open("ended/scene.json"))
assert report["voxel_size_m"] == scene["voxel_size_m"] == 1e-3 and report["kind"] == "no path found", report
assert not os.path.exists("ended/larger_voxels") and os.path.exists("ended/farthest.csv")
END
  rm slow/voxplan
fi
# Where reading the meshes takes long, no bake is begun that would leave too little time: the files of the first look serve.
cat >slow/voxelize <<'END'
#!/bin/bash
# Says that it read the meshes for 30 s.
"$bin/voxelize" "$@" || exit
for word in "$@"; do
  case $word in */scene.json) sed -i 's/"read": [0-9.e-]*/"read": 30/; s/"total": [0-9.e-]*/"total": 30.1/' "$word" ;; esac
done
END
chmod +x slow/voxelize
status=0
bin=$bin slow/forcelayer study 'gearbox.glb#Cover' --pull 0,0,60mm --clearance 1mm --time 100s --no-pictures -o reading >out.txt 2>err.txt || status=$?
[ $status = 6 ] && [ "$(grep -c '^\$ voxelize [^-]' out.txt)" = 1 ] &&
  grep -q '^  voxels of .* mm, chosen: smaller voxels would leave too little of --time (100s)$' reading/verdict.txt || fail "a bake too many: $status $(cat out.txt err.txt)"
rm slow/voxelize
# A program that the system ends is no answer, and is tried again.
printf '#!/bin/sh\nkill -s KILL $$\n' >slow/voxcheck
chmod +x slow/voxcheck
status=0
slow/forcelayer study "${pin[@]}" --no-pictures -o ended >out.txt 2>err.txt || status=$?
[ $status = 1 ] && grep -q '^forcelayer: voxcheck: was ended by SIGKILL, so the study is not finished; .*; the same command continues from there$' err.txt ||
  fail "a program that is killed: $status $(cat err.txt)"
says ended undecided 'voxcheck was ended by SIGKILL' 1
study 0 "${pin[@]}" -o ended
says ended "comes out" '^Comes out, '
finish
