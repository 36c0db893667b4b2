#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# build.sh FOLDER: the firmware with all its backends and its tests for 64-bit Arm, into FOLDER.
# Exit 77 and the reason when this machine lacks a tool.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
for tool in aarch64-linux-gnu-g++ qemu-aarch64-static apt-get dpkg-deb; do
  command -v "$tool" >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
BITELINE_ARM64_SYSROOT=$("$root/toolchains/arm64_sysroot.sh")
export BITELINE_ARM64_SYSROOT
launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
# Tests are compiled quickly, as in `./run build`: a fifth of the time.
cmake --preset arm64 -S "$root" -B "$1" -DBITELINE_QUICK=ON -DBITELINE_ROOMY_COMPILER=ON "${launcher[@]}"
cmake --build "$1"
