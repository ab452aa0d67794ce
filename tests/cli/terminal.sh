#!/usr/bin/env bash
# The habits of all commands on a terminal: help that fits, with examples; "did you mean"; colors and progress where they
# are wanted; reports of failures; completion; a signal that says what was left.
source "$FORCELAYER_SOURCE_DIR/tests/support/command_test.sh"
commands=()
for name in voxelize pointshell voxinfo voxrun voxcheck voxplan voxview forcelayer; do
  [ ! -x "$bin/$name" ] || commands+=("$name")
done
[ ${#commands[@]} -ge 2 ] || fail "no commands"
"$bin/make_runtime_files" .

for name in "${commands[@]}"; do
  "$bin/$name" --help >help.txt || fail "$name --help"
  awk 'length($0) > 100' help.txt | grep . && fail "$name: lines above 100 columns"
  grep -q $'\x1b' help.txt && fail "$name: colors in a pipe"
  grep -q '^Options:' help.txt && fail "$name: options in no group"
  grep -A 4 '^Every command:' help.txt | grep -q -- '--help' || fail "$name: no group for every command"
  for option in --json --quiet --version; do grep -q -- "^  $option" help.txt || fail "$name has no $option"; done
  sed -n '/^Examples:/,$p' help.txt | grep -qE "^  (.* )?$name " || fail "$name: no example"
  "$bin/$name" --version | grep -qE "^$name [0-9.]+( \(.*\))?$" || fail "$name --version: $("$bin/$name" --version)"
  "$bin/$name" --josn x 2>err.txt && fail "$name took --josn"
  grep -q 'did you mean --json?' err.txt || fail "$name: $(cat err.txt)"
  # Completion, from the same help.
  source "$FORCELAYER_SOURCE_DIR/scripts/completion.bash"
  COMP_WORDS=("$bin/$name" --js) COMP_CWORD=1
  _forcelayer_complete
  [ "${COMPREPLY[*]}" = --json ] || fail "$name: --js completes to '${COMPREPLY[*]}'"
done
COMP_WORDS=("$bin/voxrun" a b --device s) COMP_CWORD=4
_forcelayer_complete
[ "${COMPREPLY[*]}" = "sim spacemouse" ] || fail "--device s completes to '${COMPREPLY[*]}'"
COMP_WORDS=("$bin/voxinfo" ver) COMP_CWORD=1
_forcelayer_complete
[ "${COMPREPLY[*]}" = verify ] || fail "voxinfo ver completes to '${COMPREPLY[*]}'"
COMP_WORDS=("$bin/voxrun" do) COMP_CWORD=1
_forcelayer_complete
[ "${COMPREPLY[*]}" = doctor ] || fail "voxrun do completes to '${COMPREPLY[*]}'"
COMP_WORDS=("$bin/forcelayer" st) COMP_CWORD=1
_forcelayer_complete
[ "${COMPREPLY[*]}" = study ] || fail "forcelayer st completes to '${COMPREPLY[*]}'"
subs=('voxinfo verify' 'voxinfo sample' 'voxinfo export' 'voxinfo path' 'voxrun doctor' 'forcelayer study')
[ ! -x "$bin/pointshell" ] || subs+=('pointshell verify')
for sub in "${subs[@]}"; do
  read -r name word <<<"$sub"
  "$bin/$name" "$word" --help >help.txt
  for option in --json --quiet; do grep -q -- "^  $option" help.txt || fail "$sub has no $option"; done
  sed -n '/^Examples:/,$p' help.txt | grep -qE "^  (.* )?$sub " || fail "$sub: no example"
  awk 'length($0) > 100' help.txt | grep . && fail "$sub: lines above 100 columns"
  grep -q '^Options:' help.txt && fail "$sub: options in no group"
  [ "$sub" = 'voxrun doctor' ] && continue
  # A letter is missing.
  "$bin/$name" "${word:0:2}${word:3}" floor.vox 2>err.txt && fail "$sub without a letter"
  [ "$(cat err.txt)" = "$name: ${word:0:2}${word:3}: is neither a file nor a subcommand; did you mean $word?" ] ||
    fail "$sub: $(cat err.txt)"
done
"$bin/forcelayer" --json listed.json --quiet >out.txt && [ ! -s out.txt ] || fail "forcelayer --quiet: $(cat out.txt)"
grep -q '"name": "voxrun"' listed.json && grep -q '"schema_version": 1' listed.json || fail "forcelayer --json"
"$bin/voxrun" doctor --clock 0 --quiet --json doctor.json
grep -q '"tool": "voxrun"' doctor.json || fail "the report of voxrun doctor"

# Each option that takes a number says its bounds, and lengths and times have theirs.
for call in "${commands[@]}" 'voxrun doctor' 'pointshell verify'; do
  read -r name word <<<"$call"
  [ -x "$bin/$name" ] || continue
  # shellcheck disable=SC2086  # no word, or one
  "$bin/$name" $word --help >help.txt
  python3 - <<'END' || fail "$call: an option without bounds"
import re
text = open("help.txt").read()
options = re.split(r"\n  (?=-)", text)[1:]
numbers = [option for option in options if re.match(r"\S+ (N|NUMBER|INT|UINT|FLOAT)\b", option)]
without = [n for n in numbers if not re.match(r"\S+ (N|NUMBER)\b", n) or not re.search(r"[-\d.e]+ to [-\d.e]+", " ".join(n.split()))]
assert not without, without
assert "Examples:" not in text or "Lengths are at most 1e9m, and durations at most 10000h." in text
END
done

"$bin/voxinfo" verify --help | tr '\n' ' ' | grep -q 'counts.*clearance.*hole.*distance.*object' || fail "voxinfo verify does not say what it proves"

# --version says which formats and devices this build has.
for name in voxelize pointshell voxview; do
  [ ! -x "$bin/$name" ] || "$bin/$name" --version | grep -qE '; (reads|without) STEP and IGES\)$' || fail "$name --version"
done
for name in voxrun voxcheck; do
  "$bin/$name" --version | grep -qE '\bvectors [A-Z0-9_]+\)$' || fail "$name --version"
done

# A report on failure too, with what was read.
head -c 3000 floor.vox >cut.vox
for call in "voxinfo cut.vox" "voxinfo verify cut.vox" "voxrun cut.vox ball.pshell --duration 1ms"; do
  read -r name words <<<"$call"
  # shellcheck disable=SC2086  # words
  "$bin/$name" $words --json report.json 2>err.txt
  status=$?
  python3 - "$status" "$(cut -d' ' -f2- err.txt)" <<'END' || fail "$call: $(cat report.json)"
import json, sys
report = json.load(open("report.json"))
assert report["schema_version"] == 1 and report["exit_status"] == int(sys.argv[1]) == 4
assert report["error"]["line"] == sys.argv[2], report["error"]
assert report["input_files"][0]["path"] == "cut.vox" and len(report["input_files"][0]["xxh3"]) == 16
END
  rm report.json
done
# So is a wrong command line, and what a command refuses before it looks at its files.
for call in "voxrun floor.vox ball.pshell --set rate_hz=0" "voxrun floor.vox ball.pshell --pull 1,2,3" "voxcheck floor.vox" \
  "voxinfo floor.vox --nothing" "voxrun floor.vox ball.pshell --trace run.stl"; do
  read -r name words <<<"$call"
  rm -f report.json
  # shellcheck disable=SC2086  # words
  "$bin/$name" $words --json report.json 2>err.txt
  [ $? = 2 ] && grep -q '"exit_status": 2' report.json || fail "$call: $(cat err.txt)"
  "$bin/$name" $words --json=report.json 2>err.txt  # replaces a report
  cp press.csv table.json
  # shellcheck disable=SC2086
  "$bin/$name" $words --nothing --json table.json 2>err.txt
  cmp -s press.csv table.json || fail "$call: the report of a wrong command line replaced another file"
done
# An answer that reaches nobody is a failure.
for call in "voxrun floor.vox ball.pshell --start 0.1m,0.1m,0.2m --as-fast-as-possible --duration 10ms" \
  "voxrun doctor --clock 0" "voxinfo floor.vox" "voxinfo verify floor.vox" "forcelayer"; do
  read -r name words <<<"$call"
  [ -x "$bin/$name" ] || continue
  # shellcheck disable=SC2086  # words
  "$bin/$name" $words >/dev/full 2>err.txt
  status=$?
  [ $status = 1 ] && grep -qx "$name.*: standard output: cannot be written" err.txt ||
    fail "$call >/dev/full: status $status: $(cat err.txt)"
done
# The help that is named is that of the command that lacks something.
for call in "voxinfo path" "forcelayer study a.glb#Pin"; do
  read -r name word words <<<"$call"
  # shellcheck disable=SC2086  # words
  "$bin/$name" "$word" $words 2>err.txt
  [ $? = 2 ] && grep -qE "^$name: .* is required; see $name $word --help$" err.txt || fail "$call: $(cat err.txt)"
done
# An output that cannot be written is reported before any work, and before a missing input.
while read -r name words; do
  [ -x "$bin/$name" ] || continue
  # shellcheck disable=SC2086  # words
  "$bin/$name" $words >out.txt 2>err.txt
  status=$?
  [ $status = 1 ] && [ ! -s out.txt ] &&
    grep -qE "^$name( doctor)?: no/a\.[a-z]+: cannot be written: No such file or directory; create the folder first$" err.txt ||
    fail "$name $words: status $status: $(cat out.txt err.txt)"
done <<'END'
voxelize none.glb --voxel-size 1mm -o no/a.vox
voxelize none.glb --voxel-size 1mm -o a.vox --json no/a.json
pointshell none.glb --voxel-size 1mm -o no/a.pshell
pointshell none.glb --voxel-size 1mm -o a.pshell --json no/a.json
pointshell verify none.pshell none.glb --json no/a.json
voxinfo none.vox --json no/a.json
voxinfo verify none.vox --json no/a.json
voxinfo sample none.vox --json no/a.json
voxinfo export none.vox no/a.ply
voxinfo path none.csv -o no/a.csv
voxrun none.vox none.pshell --json no/a.json
voxrun none.vox none.pshell --trace no/a.csv
voxrun none.vox none.pshell --save-path no/a.csv
voxrun none.vox none.pshell --record no/a.flr
voxrun doctor --json no/a.json
voxcheck none.vox none.pshell none.csv --json no/a.json
voxcheck none.vox none.pshell none.csv --report csv:no/a.csv
voxcheck none.vox none.pshell none.csv --report junit:no/a.xml
voxcheck none.vox none.pshell none.csv --report picture:no/a.png
voxcheck none.vox none.pshell none.csv --report gitlab:no/a.json
voxplan none.vox none.pshell -o no/a.csv
voxplan none.vox none.pshell -o a.csv --json no/a.json
voxview none.glb --screenshot no/a.png
voxview none.glb --screenshot a.png --json no/a.json
forcelayer --json no/a.json
forcelayer study none.glb#Pin --voxel-size 1mm -o study --json no/a.json
END
[ ! -e study ] || fail "a study that cannot report leaves its folder"
"$bin/voxrun" floor.vox ball.pshell --motion press.csv --as-fast-as-possible --fail-on contact --json report.json --quiet 2>err.txt
[ $? = 6 ] || fail "--fail-on contact: $(cat err.txt)"
grep -q '"exit_status": 6' report.json && grep -q '"frames"' report.json || fail "the report of a 'no'"

# Ctrl-C: the files hold the run up to there. Twice at once, as `timeout` sends it to the command and to its group, is once.
for times in 1 2; do
  rm -f run.csv
  python3 - "$bin" "$times" >ended.txt 2>&1 <<'END' || fail "SIGINT, $times: $(cat ended.txt)"
import os, signal, subprocess, sys, time
bin, times = sys.argv[1:]
run = subprocess.Popen([bin + "/voxrun", "floor.vox", "ball.pshell", "--start", "0.1m,0.1m,0.2m", "--duration", "600s",
                        "--trace", "run.csv", "--quiet"], stderr=subprocess.PIPE, text=True)
while not [name for name in os.listdir() if name.startswith(".run.csv.") and os.path.getsize(name) > 0]:
    assert run.poll() is None
    time.sleep(0.02)
for n in range(int(times)):
    run.send_signal(signal.SIGINT)
words = run.communicate()[1]
print(words, run.returncode, os.listdir())
assert run.returncode == 130
assert "the output files contain the run up to this point" in words and open("run.csv").readline().startswith("t_s,")
assert not [name for name in os.listdir() if name.endswith(".tmp")]
END
done
# A program that another one starts says it too, and a study that it goes on.
python3 - "$bin" "$FORCELAYER_SOURCE_DIR/sample_data" >ended.txt 2>&1 <<'END' || fail "SIGINT: $(cat ended.txt)"
import os, re, signal, subprocess, sys, time
bin, data = sys.argv[1:]
def interrupted(name, words, begun):
    run = subprocess.Popen([bin + "/" + words[0], *words[1:], "--quiet"], stderr=subprocess.PIPE, text=True)
    while not begun(run.pid):
        assert run.poll() is None, name
        time.sleep(0.02)
    run.send_signal(signal.SIGINT)
    told = run.communicate()[1]
    print(name, told, run.returncode)
    assert run.returncode == 130 and "ended by SIGINT; no incomplete file is left" in told
    return told
def measures(pid):
    status = open(f"/proc/{pid}/status").read()
    return "voxrun-doctor" in status and int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) & 1 << signal.SIGINT - 1
interrupted("doctor", ["voxrun", "doctor", "--clock", "600"], measures)
if os.path.exists(bin + "/voxelize"):
    told = interrupted("study", ["forcelayer", "study", data + "/gearbox.glb#Pin", "--voxel-size", "1mm", "--pull", "0,0,60mm",
                                 "-o", "pin"], lambda pid: os.path.exists("pin"))
    assert "forcelayer: pin contains the finished steps; the same command continues from there" in told
END

# On a terminal: an error is colored, unless that is not wanted.
if command -v script >/dev/null; then
  on_terminal() { script -qec "$1" /dev/null </dev/null; }
  TERM=xterm on_terminal "$bin/voxinfo none.vox" >seen.txt
  grep -q $'^\x1b\[1;31mvoxinfo:\x1b\[0m none.vox: no such file' seen.txt || fail "no color: $(cat -v seen.txt)"
  for plain in "NO_COLOR=1 TERM=xterm" TERM=dumb; do
    on_terminal "env $plain $bin/voxinfo none.vox" >seen.txt
    grep -q $'\x1b' seen.txt && fail "colors in spite of $plain"
  done
  # Not by the clock: --quiet says when a loop is late. Without --quiet, these frames show a progress line.
  run="$bin/voxrun floor.vox ball.pshell --start 0.1m,0.1m,0.2m"
  TERM=xterm on_terminal "$run --duration 600s --as-fast-as-possible --quiet" >seen.txt
  [ ! -s seen.txt ] || fail "--quiet on a terminal: $(cat -v seen.txt)"
  # The progress line is gone at the end, and tells no time before a tenth is done.
  TERM=xterm on_terminal "$run --duration 2s" >seen.txt
  python3 - <<'END' || fail "progress: $(cat -v seen.txt)"
import re
seen = open("seen.txt", errors="replace").read()
shown = re.findall(r"running +(\d+)%(?:  (\d+) s left)?", seen)
assert len(shown) > 5, shown
for share, left in shown:
    assert bool(left) == (int(share) > 10) or int(share) in (9, 10), shown
    if left and "the loop was late" not in seen:  # a machine that is too busy for the loop takes longer than it says
        assert abs(int(left) - 2 * (1 - int(share) / 100)) <= 1, (share, left)
assert not re.search(r"left[^\x1b]*$", seen), "it stands at the end"
END
fi
finish
