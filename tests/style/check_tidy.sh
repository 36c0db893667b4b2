#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# check_tidy.sh ROOT BUILD --changed | --all | FILE...: the checks of .clang-tidy, with the compile commands of BUILD.
#   --changed  the sources that differ from the commit BITELINE_STYLE_BASE (default: the one before the last), at
#              most 10 and within 150 s, so that every test run can afford it
#   --all      the whole tree, by the units that BUILD compiles: headers that many sources share are read once for
#              up to sixteen of them
# What clang-tidy 14 cannot parse (some of the library's newer templates) is no finding: only named checks count.
# What it does not begin to read is one.
set -u
root=$(cd "$1" && pwd)
build=$(cd "$2" 2>/dev/null && pwd) || { echo "skipped: no build folder $2"; exit 77; }
shift 2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
most_files=10 most_s=150
command -v python3 >/dev/null || { echo "skipped: python3 is not installed"; exit 77; }
command -v clang-tidy >/dev/null || { echo "skipped: clang-tidy is not installed"; exit 77; }
[ -f "$build/compile_commands.json" ] || { echo "skipped: $build has no compile_commands.json"; exit 77; }
cd "$root" || exit 1

commands=$(mktemp -d)
trap 'rm -rf "$commands"' EXIT
# own [--units]: the build's commands as clang reads them.  Only what the build compiles has one.
own() { "$here/own_commands.py" "$@" "$build/compile_commands.json" >"$commands/compile_commands.json"; }

case ${1:-} in
  --all)
    own --units || exit 1
    # What a generator wrote is not ours to name; a unit, which includes our sources, lies among it.
    files=$(sed -n 's/^"file": "\(.*\)",*$/\1/p' "$commands/compile_commands.json" | sort -u | grep 'pp$\|xx$' |
      awk -v build="$build/" 'index($0, build) != 1 || /\/Unity\/unity_/')
    echo "tidy: $(grep -c . <<<"$files") units"
    most_s=14400
    ;;
  --changed)
    own || exit 1
    base=${BITELINE_STYLE_BASE:-HEAD~1}
    git rev-parse -q --verify "$base^{commit}" >/dev/null 2>&1 || { echo "skipped: no commit $base here"; exit 77; }
    changed=$(git diff --name-only --diff-filter=d "$base" -- '*.cpp')
    files=$(grep -vE '^tests/bench/' <<<"$changed" | head -n "$most_files")
    echo "tidy: $(grep -c . <<<"$files") of $(grep -c . <<<"$changed") sources changed since $base"
    ;;
  *)
    own || exit 1
    files=$(printf '%s\n' "$@")
    ;;
esac
files=$(while read -r file; do
  [ -n "$file" ] && grep -qF "\"file\": \"$(realpath -s "$file")\"" "$commands/compile_commands.json" && echo "$file"
done <<<"$files")
[ -n "$files" ] || exit 0

said=$commands/said
timeout "$most_s" xargs -P "$(nproc)" -n 1 clang-tidy --quiet --config-file=.clang-tidy --extra-arg=-ferror-limit=0 -p "$commands" >"$said" 2>/dev/null <<<"$files"
[ $? -eq 124 ] && echo "tidy: stopped after $most_s s; the rest is for --all"
if grep -qE '^error: .*PCH' "$said"; then
  echo "tidy: clang does not take these commands of $build; mend own_commands.py:"
  grep -E '^error: .*PCH' "$said" | sort | uniq -c
  exit 1
fi
found=$(grep -E '(warning|error): .*\[[a-z]+-[a-z0-9,-]+\]$' "$said" | grep -v 'clang-diagnostic' | sort -u)
if [ -n "$found" ]; then
  echo "$found"
  exit 1
fi
