#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# check_names.sh ROOT: names of files, order of includes, and type names that would tell a reader two things.
set -u
root=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/files.sh"
cd "$root" || exit 1
bad=0

complain() {
  echo "$1"
  sed 's/^/  /' <<<"$2"
  bad=1
}

# biteline-host and its like are names of programs; X-inl.hpp is included once for each instruction set.
found=$(sources . '*.cpp' '*.hpp' '*.sh' '*.fbs' | sed -E 's/-inl\.hpp$/.hpp/; s,/biteline-(demo|fleet|gige|host|uplink|web)/,/,' |
  grep -vE '^([a-z][a-z0-9_]*/)*[a-z][a-z0-9_]*\.[a-z]+$')
[ -n "$found" ] && complain 'names: files and folders are snake_case' "$found"

# A file's own header (a test: the header under test) may come first; then <...>, then "...", from the root.
found=$(sources . '*.cpp' '*.hpp' | xargs awk '
  FNR == 1 { count = 0; ours = "" }
  /^[ \t]*#[ \t]*include/ {
    ++count
    name = $0; sub(/^[ \t]*#[ \t]*include[ \t]*/, "", name); sub(/[ \t].*$/, "", name)
    # Readers are taken out of the tree by those who use them.
    if (name ~ /^"/ && name !~ /\// && FILENAME !~ /^host\/records\/reader\//) print FILENAME ":" FNR ": " name " is not named from the root"
    if (name ~ /^"/ && count > 1) ours = name
    # Highway reads the file itself again: it must come where it comes.
    if (name ~ /^</ && name !~ /<hwy/ && ours != "") {
      print FILENAME ":" FNR ": " name " comes after " ours
      ours = ""
    }
  }')
[ -n "$found" ] && complain 'includes: the own header, then <...>, then "..."' "$found"

found=$(sources . '*.cpp' | while read -r file; do
  own=${file%.cpp}.hpp
  [ -f "$own" ] || continue
  grep -m1 -E '^[[:space:]]*#[[:space:]]*include' "$file" | grep -qF "\"$own\"" || echo "$file: $own"
done)
[ -n "$found" ] && complain 'includes: the own header comes first, so that it is known to stand alone' "$found"

# Words that several rooms of host would like to use, each for another thing.
for word in $(sed -e 's/#.*//' "$here/single_names.txt" 2>/dev/null || true); do
  found=$(sources . '*.cpp' '*.hpp' | grep '^host/' | xargs -r grep -nE "^(struct|class|enum class) $word\b[^;]*(\{|:|$)")
  [ "$(grep -c . <<<"$found")" -gt 1 ] && complain "names: two types of host are called $word" "$found"
done
exit $bad
