#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# run.sh [WORK [ROWS]]: the product with one heuristic less at a time, in a copy of the tree in WORK (default: build/knockout).
# run.sh --check: only whether each row of knockouts.txt still changes its file.
# ROWS picks by name (a regular expression, default: all).
# Prints for each how many of the cases change their verdict, and which; knockouts.txt says what is knocked out.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source=$(cd "$here/../../.." && pwd)

# rows COMMAND...: called with each row's name, file, sed expression and what it serves.
rows() {
  local name file expression serves
  while IFS='|' read -r name file expression serves; do
    name=$(sed 's/ *$//' <<<"$name") file=$(tr -d ' ' <<<"$file") serves=$(sed 's/^ *//; s/ *$//' <<<"$serves")
    expression=$(sed 's/^ //; s/ $//' <<<"$expression")
    "$@" "$name" "$file" "$expression" "$serves" </dev/null
  done < <(grep -v '^#' "$here/knockouts.txt")
}

# changes NAME FILE EXPRESSION: the file is another one without it.
changes() {
  if sed "$3" "$source/$2" | cmp -s - "$source/$2"; then
    echo "run.sh: '$1' changes nothing in $2: mend knockouts.txt" >&2
    return 1
  fi
}
all_change=yes
changes_or_tell() { changes "$@" || all_change=no; }
rows changes_or_tell
[[ $all_change == yes ]] || exit 1
[[ ${1:-} != --check ]] || exit 0

work=${1:-$source/build/knockout}
chosen=${2:-.}
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
knock_out() {
  local name=$1 file=$2 expression=$3 serves=$4 changed worse
  number=$((number + 1))
  [[ $name =~ $chosen ]] || return 0
  cp "$tree/$file" "$work/original"
  sed -i "$expression" "$tree/$file"
  verdicts "$work/$number.tsv"
  changed=$(paste "$work/as_it_is.tsv" "$work/$number.tsv" | awk -F'\t' '$2 != $5 { printf "%s%s: %s -> %s", s, $1, $2, $5; s = "; " }')
  worse=$(paste "$work/as_it_is.tsv" "$work/$number.tsv" | awk -F'\t' '$2 == $5 && $6 > 1.1 * $3 + 0.005 { printf "%s%s: %.3f -> %.3f mm", s, $1, $3, $6; s = "; " }')
  echo "| $name | $serves | ${changed:-none} | ${worse:-none} |"
  cp "$work/original" "$tree/$file"
}
rows knock_out
