#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# purge.sh POSTRM: the host package's script with a folder of this test in the place of the cell's memory.  It goes by a
# person's word alone.
set -euo pipefail
command -v script >/dev/null || { echo "skipped: no script(1), so no terminal to ask at"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
data=$work/biteline-host
grep -q '^data=/var/lib/biteline-host$' "$1" || { echo "$1 names its folder in another way"; exit 1; }
sed "s#^data=.*#data=$data#; s#/run/systemd/system#$work/no-systemd#" "$1" >"$work/postrm"
unset BITELINE_PURGE_DATA DEBIAN_FRONTEND

failed=0
# try stays|goes WORDS COMMAND...: what becomes of the folder, and that it is said.
try() {
  local wanted=$1 words=$2 found=goes
  shift 2
  mkdir -p "$data" && echo kept >"$data/memory.sqlite"
  "$@" >"$work/said" 2>&1 || { echo "$*: failed"; cat "$work/said"; failed=1; }
  [ ! -e "$data/memory.sqlite" ] || found=stays
  [ "$found" = "$wanted" ] || { echo "$*: it $found, expected that it $wanted"; failed=1; }
  [ -z "$words" ] || grep -q "$words" "$work/said" || { echo "$*: said '$(cat "$work/said")'"; failed=1; }
}
# At a terminal, where a person types the first word.
typed() {
  local word=$1
  shift
  echo "$word" | script -qec "$*" /dev/null
}
purge="sh $work/postrm purge"
try stays '' sh "$work/postrm" remove
try stays 'remove it by hand' sh "$work/postrm" purge
try goes 'is removed' env BITELINE_PURGE_DATA=yes sh "$work/postrm" purge
try goes 'is removed' typed delete "$purge"
try stays 'remove it by hand' typed yes "$purge"
try stays 'remove it by hand' typed '' "$purge"
try stays 'remove it by hand' typed delete env BITELINE_PURGE_DATA=no "$purge"
try stays 'remove it by hand' typed delete env DEBIAN_FRONTEND=noninteractive "$purge"
# Nothing there: nothing to ask.
rm -rf "$data"
sh "$work/postrm" purge </dev/null
exit $failed
