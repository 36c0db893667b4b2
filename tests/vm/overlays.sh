#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# overlays.sh BOARDS: every device-tree overlay compiles without a warning.
set -euo pipefail
command -v dtc >/dev/null || { echo "skipped: no dtc"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-dtc-XXXXXX")
trap 'rm -rf "$work"' EXIT
count=0
for overlay in "$1"/*/dts/*.dtso; do
  dtc -@ -I dts -O dtb -o "$work/overlay.dtbo" "$overlay" 2>"$work/log" || { cat "$work/log"; exit 1; }
  if [ -s "$work/log" ]; then echo "$overlay:"; cat "$work/log"; exit 1; fi
  count=$((count + 1))
done
[ "$count" -gt 0 ] && echo "$count overlays"
