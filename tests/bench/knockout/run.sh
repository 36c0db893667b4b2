#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# run.sh [WORK [ROWS]]: the product with one heuristic less at a time, in a copy of the tree in WORK (default: build/knockout).
# ROWS picks by name (a regular expression, default: all).
# Prints for each how many of the cases change their verdict, and which; knockouts.txt says what is knocked out.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source=$(cd "$here/../../.." && pwd)
work=${1:-$source/build/knockout}
rows=${2:-.}
tree=$work/tree
mkdir -p "$tree"
(cd "$source" && git ls-files -z | tar --null -T - -cf - 2>/dev/null) | tar -xf - -C "$tree"
export BITELINE_DATA=${BITELINE_DATA:-$source/../shared/data}
launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
cmake -S "$tree" --preset release -DBITELINE_UNITY=OFF "${launcher[@]}" >"$work/configure.log" 2>&1 || { cat "$work/configure.log" >&2; exit 1; }

# verdicts FILE: builds and runs what is in the tree now.
verdicts() {
  cmake --build "$tree/build" -j "${JOBS:-2}" --target knockout_verdicts >"$work/build.log" 2>&1 || { tail -20 "$work/build.log" >&2; return 1; }
  "$tree/build/tests/knockout_verdicts" >"$1"
}

verdicts "$work/as_it_is.tsv"
echo "$(wc -l <"$work/as_it_is.tsv") cases; the product as it is: $(cut -f2 "$work/as_it_is.tsv" | grep -c '^right$') right"
echo "| knocked out | serves | verdicts changed | worse by more than a tenth and 0.005 mm |"
echo "| --- | --- | --- | --- |"
number=0
grep -v '^#' "$tree/tests/bench/knockout/knockouts.txt" | while IFS='|' read -r name file expression serves; do
  number=$((number + 1))
  name=$(xargs -0 <<<"$name") file=$(tr -d ' ' <<<"$file") serves=$(xargs -0 <<<"$serves")
  expression=$(sed 's/^ //; s/ $//' <<<"$expression")
  [[ $name =~ $rows ]] || continue
  cp "$tree/$file" "$work/original"
  sed -i "$expression" "$tree/$file"
  if cmp -s "$tree/$file" "$work/original"; then
    echo "run.sh: '$name' changes nothing in $file: mend knockouts.txt" >&2
    exit 1
  fi
  verdicts "$work/$number.tsv" </dev/null
  changed=$(paste "$work/as_it_is.tsv" "$work/$number.tsv" | awk -F'\t' '$2 != $5 { printf "%s%s: %s -> %s", s, $1, $2, $5; s = "; " }')
  worse=$(paste "$work/as_it_is.tsv" "$work/$number.tsv" | awk -F'\t' '$2 == $5 && $6 > 1.1 * $3 + 0.005 { printf "%s%s: %.3f -> %.3f mm", s, $1, $3, $6; s = "; " }')
  echo "| $name | $serves | ${changed:-none} | ${worse:-none} |"
  cp "$work/original" "$tree/$file"
done
