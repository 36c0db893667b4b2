#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A Slurm of two nodes on loopback, without systemd and control groups.  Sourced: start_cluster FOLDER, start_slurmd N;
# sets SLURM_CONF, slurmd_1, slurmd_2 and adds every process to `daemons`.

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
