#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# slurm_test.sh BITELINE: 40 recordings as an array job of a real Slurm on loopback.  One slurmd and one running step are
# killed in the middle: every recording is there, none twice, and the shards have the bytes that the local engine gives.
set -uo pipefail
biteline=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

. "$here/slurm_cluster.sh"
begin_cluster "$biteline"

# 40 recordings; the build that is judged answers after half a second with the recording itself as the line.
mkdir -p "$root/bin" "$root/clouds"
cat >"$root/bin/biteline" <<'PROGRAM'
#!/bin/sh
cloud=$2
while [ "$1" != --out ]; do shift; done
mkdir -p "$2"
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

"$biteline" batch plan "$root/clouds" --out "$root/slurm" --shard-s 5 || fail 'plan'
shards=$(python3 -c 'import json,sys; print(len(json.load(open(sys.argv[1]))["shards"]))' "$root/slurm/plan.json")
[ "$shards" -ge 4 ] || fail "$shards shards: at least 4 wanted"
"$biteline" batch run "$root/slurm" --program "$root/bin/biteline" --engine slurm --look-every-s 1 --attempts 5 \
  >"$root/run.txt" 2>&1 &
run=$!
daemons+=("$run")

finished() { ls "$root"/slurm/runs/*/shards/*.json 2>/dev/null | grep -c .; }
some_finished() { [ "$(finished)" -ge "$1" ]; }
wait_until 300 'no shard was finished' some_finished 1

lose_a_step "$root/slurm"
before=$(finished)
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
"$biteline" batch plan "$root/clouds" --out "$root/local" --shard-s 5 --quiet || fail 'plan'
"$biteline" batch run "$root/local" --program "$root/bin/biteline" --jobs 8 --quiet || fail 'the local run'
diff -r "$root"/slurm/runs/*/shards "$root"/local/runs/*/shards || fail 'Slurm and this machine give other bytes'
"$biteline" batch merge "$root/slurm" --program "$root/bin/biteline" --out "$root/a" --quiet || fail 'merge'
"$biteline" batch merge "$root/local" --program "$root/bin/biteline" --out "$root/b" --quiet || fail 'merge'
"$biteline" batch compare "$root/a" "$root/b" --out "$root/c" || fail 'the two runs differ'
echo "passed: $shards shards; $before were done when a step was killed"
