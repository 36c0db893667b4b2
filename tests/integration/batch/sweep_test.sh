#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# sweep_test.sh BITELINE: made shoes of two classes, judged by their truth; the second time nothing is computed.
set -uo pipefail
biteline=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $1"; exit 1; }

sweep() {
  "$biteline" sweep --shoe deep bare --seeds 3-4 --out "$work/out" \
    --tell-cell=--profile-step-mm --tell-cell=1.2 --tell-cell=--column-step-mm --tell-cell=0.4
}
sweep >"$work/words.txt" || { cat "$work/words.txt"; fail 'sweep'; }
cat "$work/words.txt"
grep -q '4 recordings, 4 computed now, 2 ok, 2 refused' "$work/words.txt" || fail 'two lines and two bare uppers expected'
grep -q '0 of 2 judged lines wrong' "$work/out/index.html" || fail 'the lines are not judged by their truth'
sweep | grep -q '4 recordings, 0 computed now' || fail 'something was computed twice'
"$biteline" sweep --shoe deep --seeds 4-3 --out "$work/x" 2>"$work/words.txt"
[ $? -eq 2 ] || fail 'seeds that run backwards'
grep -q -- '--seeds 4-3' "$work/words.txt" || fail 'seeds that run backwards are not named'
"$biteline" sweep --shoe no_such_shoe --seeds 1-1 --out "$work/y" | grep -q '1 failed' || fail 'an unknown class'
echo passed
