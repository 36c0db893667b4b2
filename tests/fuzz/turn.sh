#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# turn.sh TARGET SECONDS LENGTH [SEEDS]: one turn of a fuzz target, from the seeds and what it finds by itself.  Prints one
# row: target, cases, seconds, covered edges of all; a report is printed whole, and its case kept beside the target.
set -euo pipefail
target=$1 seconds=$2 length=$3 seeds=${4:-$(dirname "$1")/seeds/$(basename "$1")}
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-fuzz-XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/corpus"
[ -d "$seeds" ] || seeds=$work/corpus
# Twenty seconds or a gigabyte for one case is a hang or a leak.
if ! "$target" -max_total_time="$seconds" -max_len="$length" -timeout=20 -rss_limit_mb=1024 -print_final_stats=1 \
     -artifact_prefix="$target-" "$work/corpus" "$seeds" >"$work/log" 2>&1; then
  cat "$work/log"
  exit 1
fi
cases=$(sed -n 's/^stat::number_of_executed_units: *//p' "$work/log")
edges=$(grep -oE 'cov: [0-9]+' "$work/log" | tail -1 | tr -dc 0-9)
all=$(grep -oE '\([0-9]+ inline 8-bit counters\)|[0-9]+ inline 8-bit counters' "$work/log" | head -1 | tr -dc 0-9 | sed 's/8$//')
printf '%-18s %10s cases %6s s  %6s of %s edges\n' "$(basename "$target")" "${cases:-0}" "$seconds" "${edges:-0}" "${all:-?}"
