#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# biteline-bundle: what somebody who helps must know of a unit, as one file, without a secret.
set -euo pipefail
umask 077

usage() {
  cat <<'TEXT'
biteline-bundle: what somebody who helps must know of a unit, as one file, without a secret.

  biteline-bundle [FILE]   the file (biteline-bundle-HOST-TIME.tar.gz)

Options:
  --etc DIR         settings (/etc/biteline); only its *.yaml are taken, keys never
  --program FILE    the sensor's program (the unit's own version, else biteline-sensor)
  --lines N         of the journal, the newest (5000)
  --help

Exit status: 0 written; 2 wrong use, or not written.
TEXT
}
refuse() { echo "biteline-bundle: $*" >&2; exit 2; }

etc=/etc/biteline
program=
lines=5000
file=
while [ $# -gt 0 ]; do
  case $1 in
    --help) usage; exit 0 ;;
    --etc | --program | --lines)
      [ $# -gt 1 ] || refuse "$1 needs a value (see --help)"
      case $1 in
        --etc) etc=$2 ;;
        --program) program=$2 ;;
        --lines) lines=$2 ;;
      esac
      shift ;;
    -*) refuse "unknown option $1 (see --help)" ;;
    *)
      [ -z "$file" ] || refuse "one FILE expected (see --help)"
      file=$1 ;;
  esac
  shift
done
[[ $lines =~ ^[1-9][0-9]{0,5}$ ]] || refuse "--lines: 1 to 999999 expected, '$lines' given"
if [ -z "$program" ]; then
  program=/var/lib/biteline-update/current/biteline-sensor
  [ -x "$program" ] || program=biteline-sensor
fi
name=biteline-bundle-$(hostname)-$(date -u +%Y%m%dT%H%M%SZ)
file=${file:-$name.tar.gz}
work=$(mktemp -d)
part=
trap 'rm -rf "$work" ${part:+"$part"}' EXIT
mkdir -p "$work/$name/settings"

# note FILE COMMAND...: what it says; one that fails or hangs costs its own file alone.
note() {
  local to=$work/$name/$1 status=0
  shift
  { echo "\$ $*"; timeout --kill-after=1 20 "$@" 2>&1 || status=$?; } >"$to"
  [ $status -eq 0 ] || echo "(exit status $status)" >>"$to"
}

note version.txt "$program" --version
# The check opens the devices, and so stops the trigger of a scan.
if systemctl --quiet is-active biteline-sensor.service 2>/dev/null; then
  echo "left out: biteline-sensor runs; stop it and begin again" >"$work/$name/check.txt"
else
  note check.txt "$program" --check --source "board:$etc/board.yaml"
fi
note update.txt biteline-update status
note unit.txt systemctl status --no-pager --lines=0 biteline-sensor.service
note journal.txt journalctl --no-pager --lines="$lines" --unit=biteline-sensor.service
note kernel.txt journalctl --no-pager --lines="$lines" --dmesg
note upkeep.txt cat /var/lib/biteline/upkeep.yaml
note machine.txt uname -a
note command_line.txt cat /proc/cmdline
note processors.txt cat /proc/cpuinfo
note memory.txt cat /proc/meminfo
note interrupts.txt cat /proc/interrupts
note disks.txt df -h
note network.txt ip -statistics address
note packages.txt dpkg-query --show libaravis-0.8-0 libgpiod2 libzmq5 'linux-image-*' 'biteline-*'
note files.txt ls -lR "$etc"
for setting in "$etc"/*.yaml; do
  [ -f "$setting" ] && [ ! -L "$setting" ] || continue
  cp "$setting" "$work/$name/settings/" 2>/dev/null || echo "left out: it cannot be read" >"$work/$name/settings/${setting##*/}"
done

# No line of a file that is secret may stand anywhere.
if [ -d "$etc" ]; then
  find -L "$etc" -type f \( -name '*.secret' -o -name '*.secret.new' -o -name '*.key' \) -exec cat {} + >"$work/keys" 2>/dev/null ||
    refuse "$etc: a key cannot be read, so nothing can be searched for it: run as root"
  tr -d '\r' <"$work/keys" | awk 'length($0) >= 16' | sort -u >"$work/secrets"
  if [ -s "$work/secrets" ] && grep -rlFf "$work/secrets" "$work/$name" >"$work/leaks"; then
    while read -r leak; do
      echo "left out: it holds a secret" >"$leak"
    done <"$work/leaks"
  fi
fi
# A name that nobody can have taken before: this may run as root in a folder of all.
part=$(mktemp "$file.XXXXXX.part" 2>/dev/null) || refuse "$file: not written"
tar --force-local -C "$work" -czf "$part" "$name" 2>/dev/null && mv -T "$part" "$file" 2>/dev/null || refuse "$file: not written"
echo "biteline-bundle: $file, $(tar --force-local -tzf "$file" | grep -vc '/$') files"
