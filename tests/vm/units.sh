#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# units.sh BOARDS: systemd takes the service and every board's drop-in without a word: an unknown key is ignored in silence on
# a unit.
set -euo pipefail
command -v systemd-analyze >/dev/null || { echo "skipped: no systemd-analyze"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-units-XXXXXX")
trap 'rm -rf "$work"' EXIT
unit=biteline-sensor.service
# The program is looked for on this machine.
sed 's#^ExecStart=[^ ]*#ExecStart=/bin/true#' "$1/common/systemd/$unit" > "$work/$unit"
count=0
for drop_in in "$1"/*/systemd/"$unit".d; do
  rm -rf "$work/$unit.d"
  cp -r "$drop_in" "$work/"
  SYSTEMD_UNIT_PATH="$work:" systemd-analyze verify "$work/$unit" >"$work/log" 2>&1 || true
  if grep "$work" "$work/log"; then echo "$drop_in"; exit 1; fi
  count=$((count + 1))
done
[ "$count" -gt 0 ] && echo "$count boards"
