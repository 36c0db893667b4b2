#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# core_only.sh SOURCE: libbiteline is configured where neither network nor database libraries are found.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-core-XXXXXX")
trap 'rm -rf "$work"' EXIT
off=()
for name in Boost SQLite3 Protobuf CLI11 OpenSSL PostgreSQL embree; do off+=("-DCMAKE_DISABLE_FIND_PACKAGE_$name=ON"); done
cmake -S "$1" -B "$work" -G Ninja -DBITELINE_CORE_ONLY=ON -DPKG_CONFIG_EXECUTABLE="$here/pkg-config" \
  "${off[@]}" >"$work/log" 2>&1 || { tail -20 "$work/log"; exit 1; }
inputs=$(ninja -C "$work" -t inputs lib/libbiteline.so)
for name in zmq sqlite mosquitto pqxx libpq boost crypto cli11; do
  ! grep -i "$name" <<<"$inputs" || { echo "the core links or compiles something of $name"; exit 1; }
done
grep -q 'find_bite_line.cpp\|unity_0' <<<"$inputs" || { echo "the core holds no line finder: this test sees nothing"; exit 1; }
# It is a test only if the same words are refused where they are asked for.
! "$here/pkg-config" --exists libzmq || { echo "libzmq is found in spite of all"; exit 1; }
