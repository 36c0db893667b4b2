#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# sanitized_server.sh BUILD: builds the page's server with the address and undefined-behaviour sanitizers there, and runs
# the tests that send it garbled, oversized, slow and foreign requests.  Minutes: only ./run test --all has it.
set -euo pipefail
build=$(realpath -m "$1")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
tests=(web_test control_test accounts_test)
launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
mkdir -p "$build"
cmake --preset asan -DBITELINE_UNITY=ON -B "$build" "${launcher[@]}" >"$build/configure.log" 2>&1 || { cat "$build/configure.log" >&2; exit 1; }
cmake --build "$build" --target "${tests[@]}" >"$build/build.log" 2>&1 || { tail -40 "$build/build.log" >&2; exit 1; }
[ "$(nm "$build/tests/web_test" | grep -c __asan_report_load8)" -gt 0 ] || { echo "$build/tests/web_test: no sanitizer in it" >&2; exit 1; }
bad=0
for test in "${tests[@]}"; do
  echo "$test"
  (cd "$build" && timeout 1200 "tests/$test") || bad=1
done
exit $bad
