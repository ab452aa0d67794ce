#!/usr/bin/env bash
# The examples of runtime/examples, as somebody would try them: the loop in another program's servo
# thread (C++ and C, with a part swapped while it runs), and the receiver of the pose stream.
set -euo pipefail
source "$FORCELAYER_SOURCE_DIR/tests/support/in_time.sh"
bin=$FORCELAYER_BIN_DIR
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
"$bin/make_runtime_files" .

fail() { echo "FAILED: $*" >&2; exit 1; }

lines=$(grep -c '' "$FORCELAYER_SOURCE_DIR/runtime/examples/embed.cpp")
[ "$lines" -lt 100 ] || fail "the example has $lines lines"

embed() {
  "$bin/example_embed" floor.vox ball.pshell >embed.txt
  grep -q 'trips 0' embed.txt || { echo "held up: a trip" >>embed.txt; return 1; }
}
in_time embed.txt embed || true
grep -qE 'peak force [1-8]\.[0-9]+ N, [1-9][0-9]* of 1000 frames in contact, 0 penetrating' embed.txt ||
  fail "$(cat embed.txt)"
status=0
"$bin/example_embed" none.vox ball.pshell 2>error.txt || status=$?
[ "$status" -eq 1 ] && grep -q 'none.vox' error.txt || fail "status $status: $(cat error.txt)"

embed_c() {
  "$bin/example_embed_c" floor.vox ball.pshell ball.pshell >embed_c.txt || fail "$(cat embed_c.txt)"
  grep -q 'last trip none' embed_c.txt || { echo "held up: a trip" >>embed_c.txt; return 1; }
}
in_time embed_c.txt embed_c || true
grep -qE 'at 0.8 s: output 1, peak force [1-9]' embed_c.txt || fail "$(cat embed_c.txt)"
# Swapped in at z = 60 mm, away from the floor, and armed again.
grep -qE 'at the end: output 1, part at z = 0\.060 m, last trip none' embed_c.txt ||
  fail "$(cat embed_c.txt)"
grep -qE 'the surfaces were at least 0\.[0-9]+ mm apart in 1[0-9]{3} frames of 1500' embed_c.txt ||
  fail "$(cat embed_c.txt)"
status=0
"$bin/example_embed_c" floor.vox none.pshell 2>error.txt || status=$?
[ "$status" -eq 1 ] && grep -q 'none.pshell' error.txt || fail "status $status: $(cat error.txt)"

# A free port, taken and given back.
port=$(python3 -c 'import socket; s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
poses() {
  local receiver status=0
  "$bin/example_pose_receiver" "$port" 3 >poses.txt &
  receiver=$!
  "$bin/voxrun" floor.vox ball.pshell --start 0.1m,0.1m,0.2m --duration 2s --udp "$port" --quiet 2>error.txt || status=$?
  wait $receiver && [ $status = 0 ]
}
in_time error.txt poses || fail "the receiver: $(cat error.txt poses.txt)"
[ "$(grep -c 'part   0.1000   0.1000   0.2000 m' poses.txt)" -ge 10 ] || fail "$(cat poses.txt)"
# Whoever made a scene chose the names of its objects: the receiver shows an escape sequence, and does not send it.
python3 - "$bin/example_pose_receiver" "$port" <<'PYTHON' || fail "a name with an escape sequence"
import select, socket, struct, subprocess, sys
receiver = subprocess.Popen(sys.argv[1:3] + ["30"], stdout=subprocess.PIPE)
pose = struct.pack("<7d", 0, 0, 0, 1, 0, 0, 0)
datagram = (struct.pack("<IHHQQQd", 0x53504C46, 2, 384, 1, 1, 0, 0) + pose + pose + bytes(72) + pose +
            struct.pack("<dII3d", 0.001, 2, 1, 0, 0, 0) + "wall\x1b[2J\u202e".encode().ljust(64, b"\0"))
assert len(datagram) == 384
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
line, sequence = b"", 0
while not line:
    sequence += 1
    sender.sendto(datagram[:16] + struct.pack("<Q", sequence) + datagram[24:], ("127.0.0.1", int(sys.argv[2])))
    if select.select([receiver.stdout], [], [], 0.05)[0]:
        line = receiver.stdout.readline()
        assert line, "the receiver ended"
receiver.kill()
assert line.endswith(b" to wall\\x1b[2J\\xe2\\x80\\xae\n"), line
PYTHON

# A plugin needs one header and a C compiler.
cc -std=c11 -shared -fPIC -I "$FORCELAYER_SOURCE_DIR/runtime" \
  "$FORCELAYER_SOURCE_DIR/runtime/examples/spring_plugin.c" -o spring_plugin.so -lm
plugin() {
  "$bin/voxrun" floor.vox ball.pshell --device plugin:library=./spring_plugin.so,args=depth=0.01 --quiet \
    --world-from-device 0.1m,0.1m,0.1m --duration 200ms --set stale_s=0.05 2>error.txt
}
in_time error.txt plugin || fail "the plugin: $(cat error.txt)"
status=0
"$bin/voxrun" floor.vox ball.pshell --device plugin:library=./spring_plugin.so,args=nonsense --quiet 2>error.txt || status=$?
[ "$status" -eq 5 ] && grep -q 'depth=METRES' error.txt || fail "status $status: $(cat error.txt)"

# doctor names what it looked at; whatever the machine, it ends with status 0.
"$bin/voxrun" doctor --clock 100ms >/dev/null 2>&1 && fail "a length of time without its option's form"
"$bin/voxrun" doctor --clock 0.2 --json doctor.json >doctor.txt || fail "doctor: status $?"
for what in 'real-time priority' 'memory locking' 'kernel preemption' 'frequency governor' \
  'virtual machine' 'udev rules' 'confinement of plugins' 'clock'; do
  grep -q "$what:" doctor.txt || fail "doctor says nothing of $what"
done
python3 - <<'PYTHON'
import json
findings = json.load(open("doctor.json"))["findings"]
assert all(f["verdict"] in ("good", "note", "change") and f["seen"] for f in findings)
assert all(f["mend"] for f in findings if f["verdict"] == "change")
PYTHON
# A refusal is named with the mend for it (as a user without privileges).
if [ "$(id -u)" -eq 0 ]; then
  chmod 755 "$scratch"
  cp "$bin/voxrun" "$bin/voxrun-doctor" .  # nobody may look into the folder of the build
  (ulimit -r 0 -l 64; setpriv --reuid=65534 --clear-groups --bounding-set=-all ./voxrun doctor \
    --clock 0 >refused.txt) || fail "doctor without privileges"
  grep -q 'change real-time priority: refused' refused.txt || fail "$(cat refused.txt)"
  grep -q 'change memory locking' refused.txt || fail "$(cat refused.txt)"
  grep -q '@realtime - rtprio 90' refused.txt || fail "$(cat refused.txt)"
fi
