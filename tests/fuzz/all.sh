#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# all.sh BUILD SECONDS: builds the fuzz targets there and gives each an equal share of the time, in turn.  A table: cases,
# seconds, coverage of the code under test; 1 when one of them found something.
set -euo pipefail
build=$(realpath -m "$1") seconds=$2
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
command -v clang++-14 >/dev/null || { echo "skipped: no clang++-14"; exit 77; }
launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
mkdir -p "$build"
cmake --preset fuzz -B "$build" "${launcher[@]}" >"$build/configure.log" 2>&1 || { cat "$build/configure.log" >&2; exit 1; }
cmake --build "$build" --target fuzz_all >"$build/build.log" 2>&1 || { tail -40 "$build/build.log" >&2; exit 1; }
"$build/fuzz/fuzz_seeds" "$build/fuzz/seeds"
targets=()
for source in tests/fuzz/*.cpp; do  # those that are no target have no such program there
  target=$build/fuzz/fuzz_$(basename "$source" .cpp)
  if [ -x "$target" ]; then targets+=("$target"); fi
done
each=$((seconds / ${#targets[@]}))
bad=0
for target in "${targets[@]}"; do
  tests/fuzz/turn.sh "$target" $((each > 0 ? each : 1)) "$(cat "$target.length")" || bad=1
done
exit $bad
