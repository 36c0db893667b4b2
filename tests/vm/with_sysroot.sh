#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# with_sysroot.sh COMMAND...: runs it with BITELINE_ARM64_EMULATOR, what runs an arm64 program here.
# Exit 77 and the reason when this machine lacks a tool.
set -euo pipefail
command -v qemu-aarch64-static >/dev/null || { echo "skipped: no qemu-aarch64-static"; exit 77; }
command -v qemu-system-aarch64 >/dev/null || { echo "skipped: no qemu-system-aarch64"; exit 77; }
sysroot=$("$(dirname "$0")/../../toolchains/arm64_sysroot.sh")
export BITELINE_ARM64_EMULATOR="qemu-aarch64-static -L $sysroot"
exec "$@"
