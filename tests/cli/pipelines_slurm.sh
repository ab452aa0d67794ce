#!/usr/bin/env bash
# scripts/pipelines/slurm.sh under Debian's Slurm: one node, all of it in the test's folder. What cli.pipelines shows of
# the others, and the bytes and verdicts of a run without Slurm.
set -euo pipefail
source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"
python=/usr/bin/python3
PATH=$PATH:/usr/sbin
for program in slurmctld slurmd munged sbatch; do skip_without slurm-wlm command -v $program; done
skip_without libvtk9-dev [ -x "$FORCELAYER_BIN_DIR/voxview" ]
skip_without xvfb command -v xvfb-run
skip_without python3-yaml "$python" -c 'import yaml'
folder=$(mktemp -d)
daemons=()
end() {
  for daemon in "${daemons[@]}"; do kill "$daemon" 2>/dev/null && wait "$daemon" || true; done
  rm -rf "$folder"
}
trap end EXIT
cd "$folder"
mkdir spool state
chmod 755 .  # else munged refuses its socket

read -r controller_port node_port < <("$python" - <<'PYTHON'
import socket
taken = [socket.socket() for _ in range(2)]
for one in taken:
    one.bind(("127.0.0.1", 0))
print(*(one.getsockname()[1] for one in taken))
PYTHON
)
name=$(hostname -s)
cat >slurm.conf <<CONF
ClusterName=forcelayer
SlurmctldHost=$name(127.0.0.1)
NodeName=$name NodeAddr=127.0.0.1 CPUs=2
PartitionName=all Nodes=ALL Default=YES State=UP
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthInfo=socket=$folder/munge.socket
SlurmctldPort=$controller_port
SlurmdPort=$node_port
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
MpiDefault=none
CONF
export SLURM_CONF=$folder/slurm.conf

head -c 128 /dev/urandom >munge.key
chmod 400 munge.key
munged --foreground --force --socket="$folder/munge.socket" --key-file="$folder/munge.key" --pid-file="$folder/munged.pid" \
  --log-file="$folder/munged.log" --seed-file="$folder/munge.seed" >munged.out 2>&1 &
daemons+=($!)
until [ -S munge.socket ]; do
  kill -0 "${daemons[0]}" 2>/dev/null || skip "munged does not run here: $(tail -n 1 munged.log munged.out)"
  sleep 0.1
done
slurmctld -D >slurmctld.out 2>&1 &
daemons+=($!)
slurmd -D >slurmd.out 2>&1 &
daemons+=($!)
for try in $(seq 300); do
  [ "$(timeout 5 sinfo --noheader --format=%t 2>sinfo.out)" != idle ] || break
  for daemon in "${daemons[@]}"; do
    kill -0 "$daemon" 2>/dev/null || skip "Slurm does not run here: $(tail -qn 2 slurmctld.log slurmd.log)"
  done
  [ "$try" -lt 300 ] || skip "Slurm's node does not come up: $(cat sinfo.out)"
  sleep 0.1
done

PATH=$FORCELAYER_BIN_DIR:$PATH "$python" -B "$FORCELAYER_SOURCE_DIR/tests/cli/pipelines.py" slurm
