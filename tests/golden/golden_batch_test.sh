#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# golden_batch_test.sh BITELINE [pin]: the golden set as a batch, against the baseline pinned beside it.  A build that is
# spoiled on purpose must be found, and its recording named.  `pin` writes the baseline anew.
set -uo pipefail
biteline=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $1"; exit 1; }

# A copy: names are relative to the folder that is searched.
mkdir "$work/set"
cp -r "$here/part" "$here/sample" "$here/upper" "$work/set"
"$biteline" batch plan "$work/set" --out "$work/batch" || fail 'plan'
"$biteline" batch run "$work/batch" || fail 'run'
if [ "${2:-}" = pin ]; then
  "$biteline" batch merge "$work/batch" --out "$work/result" --pin "$here/expected.json"
  exit
fi
"$biteline" batch merge "$work/batch" --out "$work/result" --expect "$here/expected.json" || fail 'worse than pinned'
"$biteline" batch run "$work/batch" | grep -q ' 0 computed now' || fail 'something was computed twice'

# The real program, but its lines are 0.8 mm beside the crease.
mkdir "$work/spoiled"
cat >"$work/spoiled/biteline" <<PROGRAM
#!/bin/sh
'$biteline' "\$@"
status=\$?
while [ \$# -gt 0 ] && [ "\$1" != --out ]; do shift; done
[ -f "\$2/line.csv" ] || exit \$status
awk -F, 'BEGIN { OFS = "," } /^#/ { print; next } { \$3 += 0.8; print }' "\$2/line.csv" >"\$2/moved.csv"
mv "\$2/moved.csv" "\$2/line.csv"
exit \$status
PROGRAM
chmod +x "$work/spoiled/biteline"
"$biteline" batch run "$work/batch" --program "$work/spoiled/biteline" --quiet || fail 'run of the spoiled build'
"$biteline" batch merge "$work/batch" --program "$work/spoiled/biteline" --out "$work/bad" \
  --expect "$here/expected.json" 2>"$work/words.txt"
[ $? -eq 3 ] || fail 'the spoiled build was let through'
cat "$work/words.txt"
grep -q '1 recording is worse: sample/cloud.ply' "$work/words.txt" || fail 'the recording is not named'
"$biteline" batch compare "$work/bad" "$work/result" --out "$work/back" | grep -q '1 better, 0 worse' ||
  fail 'the truth does not tell the sound build from the spoiled one'
echo passed
