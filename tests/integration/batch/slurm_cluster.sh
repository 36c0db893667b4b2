#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A Slurm of two nodes on loopback, without systemd and control groups, that ends with the script that sources this.
#   begin_cluster BITELINE   sets root (a folder), SLURM_CONF, slurmd_1, slurmd_2; leaves with 77 where it cannot be
#   start_slurmd N           once more, after it was killed
#   lose_a_step BATCH        a running task of this batch's folder and its slurmstepd end at once; Slurm is told
#   wait_until SECONDS WORDS COMMAND...
# Who starts a process that must end with the script adds it to `daemons`.  What failed is told with run.txt and the logs.

skip() { echo "skipped: $1" >&2; exit 77; }
fail() { echo "FAILED: $1" >&2; exit 1; }

daemons=()
end_cluster() {
  # Without a cluster of its own these would speak to the machine's.
  [ "${SLURM_CONF:-}" = "$root/slurm.conf" ] && squeue --noheader --format=%A 2>/dev/null | sort -u | xargs -r scancel 2>/dev/null
  local pid
  for pid in "${daemons[@]}"; do kill "$pid" 2>/dev/null; done
  for pid in "${daemons[@]}"; do wait "$pid" 2>/dev/null; done
  rm -rf "$root"
}

begin_cluster() {
  export PATH=$PATH:/usr/sbin
  local program
  for program in munged slurmctld slurmd sbatch squeue scancel python3; do
    command -v "$program" >/dev/null || skip "$program is not installed"
  done
  [ -x "$1" ] || skip "$1 was not built"
  [ "$(id -u)" -eq 0 ] || skip 'slurmd runs jobs of other users: it needs root'
  root=$(mktemp -d /tmp/biteline-slurm-XXXXXX)
  trap end_cluster EXIT
  start_cluster "$root" || { tail -n 20 "$root"/*.log >&2; fail 'the cluster did not start'; }
}

wait_until() {
  local left=$((10 * $1)) words=$2
  shift 2
  until "$@"; do
    left=$((left - 1))
    [ "$left" -gt 0 ] || { tail -n 20 "$root/run.txt" "$root"/*.log >&2; squeue >&2; fail "$words"; }
    sleep 0.1
  done
}

parent_of() { awk '/^PPid:/ { print $2 }' "/proc/$1/status" 2>/dev/null; }

lost_step() { # BATCH: true once one was met and killed; sets `lost`
  local task step
  for task in $(pgrep -f -- "batch run $1 --shard "); do
    step=$(parent_of "$task")
    [ -n "$step" ] && grep -q '^slurmstepd' "/proc/$step/comm" 2>/dev/null || continue
    lost=$(tr '\0' '\n' <"/proc/$task/environ" | sed -n 's/^SLURM_JOB_ID=//p')
    [ -n "$lost" ] && kill -KILL "$step" "$task" 2>/dev/null && return 0
  done
  return 1
}

lose_a_step() {
  wait_until 300 'no step was met running' lost_step "$1"
  # Slurm itself finds the loss and does the same, but only after two minutes.
  scontrol requeue "$lost" || fail "the lost task $lost cannot be queued again"
}

free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'; }

start_slurmd() {
  slurmd -D -N "bl$1" -f "$SLURM_CONF" >>"$cluster/slurmd_$1.log" 2>&1 &
  printf -v "slurmd_$1" %s $!
  daemons+=($!)
}

start_cluster() {
  cluster=$1
  local host node_1 node_2
  host=$(hostname -s)
  node_1=$(free_port)
  node_2=$(free_port)
  mkdir -p "$cluster/munge" "$cluster/state" "$cluster/spool_bl1" "$cluster/spool_bl2"
  chmod 755 "$cluster"
  head -c 1024 /dev/urandom >"$cluster/munge/munge.key"
  chmod 700 "$cluster/munge"
  chmod 400 "$cluster/munge/munge.key"
  chmod 755 "$cluster/munge"
  cat >"$cluster/slurm.conf" <<CONF
ClusterName=biteline
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
AuthType=auth/munge
AuthInfo=socket=$cluster/munge/socket,cred_expire=5
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
MpiDefault=none
SlurmUser=root
ReturnToService=2
SlurmdTimeout=20
MaxArraySize=100001
StateSaveLocation=$cluster/state
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdSpoolDir=$cluster/spool_%n
SlurmdPidFile=$cluster/%n.pid
SwitchType=switch/none
NodeName=bl1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$node_1 CPUs=1
NodeName=bl2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$node_2 CPUs=1
PartitionName=all Nodes=bl[1-2] Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$cluster/slurm.conf
  munged --foreground --force --key-file="$cluster/munge/munge.key" --socket="$cluster/munge/socket" \
    --pid-file="$cluster/munge/pid" --log-file="$cluster/munge/log" --seed-file="$cluster/munge/seed" \
    >"$cluster/munged.log" 2>&1 &
  daemons+=($!)
  slurmctld -D -f "$SLURM_CONF" >"$cluster/slurmctld.log" 2>&1 &
  daemons+=($!)
  start_slurmd 1
  start_slurmd 2
  local i
  for i in $(seq 600); do
    [ "$(sinfo --noheader --Node --format=%t 2>/dev/null | grep -c idle)" -eq 2 ] && return 0
    sleep 0.1
  done
  return 1
}
