#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# measures.sh BUILD OUT [SEED]: what is measured of the line, in one go, some 40 minutes on two cores.  Each bench
# writes its rows to OUT; at the end the summaries are printed.  Give a SEED that nobody has looked at.
set -euo pipefail
build=$1 out=$2 seed=${3:-$(date +%y%m%d)00}
mkdir -p "$out"

# run NAME BENCH ARGUMENT...
run() {
  local name=$1 bench=$2
  shift 2
  echo "$name: $bench $*" >&2
  "$build/tests/$bench" "$@" >"$out/$name.jsonl" 2>"$out/$name.rows"
}

echo "seed $seed" >&2
run curve bench_curve --seed "$seed" --ordinary 60 --guards 30 --heels 20 --flush 40 --sewn 20
run sweep bench_line_sweep --seed $((seed + 11)) --count 600
run guards bench_line_sweep --seed $((seed + 12)) --count 150 --guard
run heels_35 bench_line_sweep --seed $((seed + 13)) --count 200 --heel 0.35
run heels_40 bench_line_sweep --seed $((seed + 14)) --count 200 --heel 0.4
run shapes bench_line_shapes --variants
run confidence bench_line_confidence --seed $((seed + 15)) --count 300 --fault sector
run u95 bench_line_u95 --seeds 12 --from "$seed"
for name in curve sweep guards heels_35 heels_40 shapes confidence u95; do
  echo "== $name"
  cat "$out/$name.jsonl"
done
