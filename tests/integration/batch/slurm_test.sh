#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# slurm_test.sh BITELINE: 40 recordings as an array job of a real Slurm on loopback.  One slurmd and one running step are
# killed in the middle: every recording is there, none twice, and the shards have the bytes that the local engine gives.
set -uo pipefail
biteline=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

skip() { echo "skipped: $1"; exit 77; }
fail() { echo "FAILED: $1"; exit 1; }
for program in munged slurmctld slurmd sbatch squeue scancel python3; do
  PATH=$PATH:/usr/sbin command -v "$program" >/dev/null || skip "$program is not installed"
done
[ "$(id -u)" -eq 0 ] || skip 'slurmd runs jobs of other users: it needs root'
export PATH=$PATH:/usr/sbin

root=$(mktemp -d /tmp/biteline-slurm-XXXXXX)
daemons=()
cleanup() {
  # Without a cluster of its own these would speak to the machine's.
  [ "${SLURM_CONF:-}" = "$root/slurm.conf" ] && squeue --noheader --format=%A 2>/dev/null | sort -u | xargs -r scancel 2>/dev/null
  for pid in "${daemons[@]}"; do kill "$pid" 2>/dev/null; done
  for pid in "${daemons[@]}"; do wait "$pid" 2>/dev/null; done
  rm -rf "$root"
}
trap cleanup EXIT

. "$here/slurm_cluster.sh"
start_cluster "$root" || { tail -n 20 "$root"/*.log; fail 'the cluster did not start'; }

# 40 recordings; the build that is judged answers after half a second with the recording itself as the line.
mkdir -p "$root/bin" "$root/clouds"
cat >"$root/bin/biteline" <<'PROGRAM'
#!/bin/sh
cloud=$2
while [ "$1" != --out ]; do shift; done
mkdir -p "$2"
echo "$PPID $(basename "$cloud")" >> "$(dirname "$0")/asked.txt"
sleep 0.5
case $cloud in */crash*) kill -SEGV $$ ;; esac
echo '{"status": "ok", "length_mm": 400, "confidence": 0.9}' > "$2/report.json"
cp "$cloud" "$2/line.csv"
PROGRAM
chmod +x "$root/bin/biteline"
python3 - "$root/clouds" <<'MAKE'
import math, sys
for number in range(40):
    name = ('crash' if number == 7 else 'shoe') + f'{number:02}.xyz'
    with open(f'{sys.argv[1]}/{name}', 'w') as cloud:
        for i in range(60):
            a = 2 * math.pi * i / 60
            c, s = math.cos(a), math.sin(a)
            cloud.write(f'{number + 63 * c:.6f},{63 * s:.6f},10,{c:.9f},{s:.9f},0,{-s:.9f},{c:.9f},0,0.9\n')
MAKE

"$biteline" batch plan "$root/clouds" --out "$root/slurm" --shard-s 2.5 || fail 'plan'
shards=$(python3 -c 'import json,sys; print(len(json.load(open(sys.argv[1]))["shards"]))' "$root/slurm/plan.json")
[ "$shards" -ge 8 ] || fail "$shards shards: at least 8 wanted"
"$biteline" batch run "$root/slurm" --program "$root/bin/biteline" --engine slurm --look-every-s 1 --attempts 5 \
  >"$root/run.txt" 2>&1 &
run=$!
daemons+=("$run")

finished() { ls "$root"/slurm/runs/*/shards/*.json 2>/dev/null | grep -c .; }
wait_until() { # SECONDS WORDS COMMAND...
  local left=$((10 * $1)) words=$2
  shift 2
  until "$@"; do
    left=$((left - 1))
    [ "$left" -gt 0 ] || { cat "$root/run.txt"; squeue; tail -n 5 "$root"/*.log; fail "$words"; }
    sleep 0.1
  done
}
some_finished() { [ "$(finished)" -ge "$1" ]; }
wait_until 300 'no shard was finished' some_finished 1

# A step: the task of the newest recording, and the slurmstepd above it, at once.
parent_of() { awk '/^PPid:/ { print $2 }' "/proc/$1/status" 2>/dev/null; }
step_killed() {
  local task step
  task=$(tail -n 1 "$root/bin/asked.txt" | cut -d' ' -f1)
  step=$(parent_of "$task") || return 1
  [ -n "$step" ] && grep -q '^slurmstepd' "/proc/$step/comm" 2>/dev/null || return 1
  lost=$(tr '\0' '\n' <"/proc/$task/environ" | sed -n 's/^SLURM_JOB_ID=//p')
  [ -n "$lost" ] && kill -KILL "$step" "$task" 2>/dev/null
}
wait_until 300 'no step was met running' step_killed
before=$(finished)
# Slurm itself finds the loss and does the same, but only after two minutes.
scontrol requeue "$lost" || fail "the lost task $lost cannot be queued again"
[ "$before" -lt "$shards" ] || fail 'the step was killed after all was done'

# A node's daemon, and another one in its place.
kill -KILL "$slurmd_2"
wait "$slurmd_2" 2>/dev/null
start_slurmd 2
wait_until 900 'the run did not end' eval '! kill -0 "$run" 2>/dev/null'
wait "$run" || { cat "$root/run.txt"; fail 'the run ended with a failure'; }

# All there, and the one that crashes named.
[ "$(finished)" -eq "$shards" ] || fail "$(finished) of $shards shards"
grep -q 'crash07.xyz: crashed' "$root/run.txt" || { cat "$root/run.txt"; fail 'the crash is not named'; }

# None twice: every name once in the shards, and one folder for each in the store.
python3 - "$root/slurm" <<'COUNT' || fail 'recordings are missing or there twice'
import glob, json, sys
names = [r['name'] for f in glob.glob(sys.argv[1] + '/runs/*/shards/*.json') for r in json.load(open(f))['results']]
stored = [f for f in glob.glob(sys.argv[1] + '/store/??/*/result.json')]
print(len(names), 'results of', len(set(names)), 'recordings;', len(stored), 'in the store')
sys.exit(not (len(names) == len(set(names)) == len(stored) == 40))
COUNT

# The same bytes as on this machine alone.
"$biteline" batch plan "$root/clouds" --out "$root/local" --shard-s 2.5 --quiet || fail 'plan'
"$biteline" batch run "$root/local" --program "$root/bin/biteline" --jobs 8 --quiet || fail 'the local run'
diff -r "$root"/slurm/runs/*/shards "$root"/local/runs/*/shards || fail 'Slurm and this machine give other bytes'
"$biteline" batch merge "$root/slurm" --program "$root/bin/biteline" --out "$root/a" --quiet || fail 'merge'
"$biteline" batch merge "$root/local" --program "$root/bin/biteline" --out "$root/b" --quiet || fail 'merge'
"$biteline" batch compare "$root/a" "$root/b" --out "$root/c" || fail 'the two runs differ'
echo "passed: $shards shards; $before were done when a step was killed"
