#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# unit.sh FOLDER: the unit tests of an arm64 build, under user emulation.
set -euo pipefail
[ -e "$1/CTestTestfile.cmake" ] || { echo "skipped: no arm64 build in $1"; exit 77; }
exec ctest --test-dir "$1" -L unit --output-on-failure --parallel "$(nproc)"
