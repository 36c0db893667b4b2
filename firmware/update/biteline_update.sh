#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# biteline-update: another version of the sensor's program, from a signed folder; back by itself when that is no good.
set -euo pipefail
umask 022

usage() {
  cat <<'TEXT'
biteline-update: another version of the sensor's program, from a signed folder.

  biteline-update begin FOLDER     the unit's first version: check the signature, put it in place
  biteline-update install FOLDER   check the signature, put the version in place, try it, keep it or go back
  biteline-update recover          go back if a trial was cut short; the unit does so before each start
  biteline-update status           which version runs, which there are, whether a trial is on
  biteline-update sign KEY FOLDER VERSION
                                   on the builder's machine: sign FOLDER/biteline-sensor with a private ed25519 key (PEM)

Options:
  --root DIR        where versions are kept (/var/lib/biteline-update)
  --trusted FILE    public ed25519 key (/etc/biteline/update.pem)
  --board FILE      board whose devices the new version must open (/etc/biteline/board.yaml)
  --head FILE       calibration with whose rate it must keep up, in the dark (/etc/biteline/sensor.yaml; none there: not tried)
  --env FILE        the unit's options, for their --settings (/etc/biteline/sensor.env)
  --service PROGRAM called with stop, start and is-active (systemctl on biteline-sensor)
  --patience N      seconds at most for the check, the stop and the start each (25)
  --help

Exit status: 0 done; 2 wrong use, or a folder that is not taken; 3 tried and gone back; 4 gone back, and the old one does not start.
TEXT
}

say() { echo "biteline-update: $*"; }
refuse() { echo "biteline-update: $*" >&2; exit 2; }

root=/var/lib/biteline-update
trusted=/etc/biteline/update.pem
board=/etc/biteline/board.yaml
head=/etc/biteline/sensor.yaml
env=/etc/biteline/sensor.env
service_program=
patience=25
words=()
while [ $# -gt 0 ]; do
  case $1 in
    --help) usage; exit 0 ;;
    --root | --trusted | --board | --head | --env | --service | --patience)
      [ $# -gt 1 ] || refuse "$1 needs a value (see --help)"
      case $1 in
        --root) root=$2 ;;
        --trusted) trusted=$2 ;;
        --board) board=$2 ;;
        --head) head=$2 ;;
        --env) env=$2 ;;
        --service) service_program=$2 ;;
        --patience) patience=$2 ;;
      esac
      shift ;;
    -*) refuse "unknown option $1 (see --help)" ;;
    *) words+=("$1") ;;
  esac
  shift
done
[[ $patience =~ ^[1-9][0-9]?$ ]] || refuse "--patience: 1 to 99 seconds expected, '$patience' given"

# Without the lock: who outlives this program must not keep it.
service() {
  if [ -n "$service_program" ]; then
    timeout --kill-after=1 "$patience" "$service_program" "$1" 9>&-
  else
    timeout --kill-after=1 "$patience" systemctl "$1" --quiet biteline-sensor.service 9>&-
  fi
}

# The version that `current` leads to; nothing: none.
current() {
  local link
  link=$(readlink "$root/current") || return 0
  basename "$link"
}

# lead_to VERSION: in one step, on the disk before it counts.
lead_to() {
  ln -sfn "versions/$1" "$root/current.part"
  sync -f "$root"
  mv -T "$root/current.part" "$root/current"
  sync -f "$root"
}

# What may be a version's name, and so a folder's.
is_version() {
  [[ $1 =~ ^[0-9A-Za-z][0-9A-Za-z.+~-]{0,63}$ ]]
}

# verify FOLDER: prints the version that a good signature and checksum vouch for.
verify() {
  local folder=$1 file version sum
  for file in manifest manifest.sig biteline-sensor; do
    [ -f "$folder/$file" ] && [ ! -L "$folder/$file" ] || { echo "$folder: no $file"; return 1; }
  done
  openssl pkeyutl -verify -rawin -pubin -inkey "$trusted" -in "$folder/manifest" -sigfile "$folder/manifest.sig" >/dev/null 2>&1 ||
    { echo "$folder: not signed by $trusted"; return 1; }
  version=$(sed -n '1s/^version //p' "$folder/manifest")
  is_version "$version" || { echo "$folder: manifest: no version in its first line"; return 1; }
  sum=$(sed -n '2s/^sha256 //p' "$folder/manifest")
  [[ $sum =~ ^[0-9a-f]{64}$ ]] && [ "$sum" = "$(sha256sum <"$folder/biteline-sensor" | cut -d' ' -f1)" ] ||
    { echo "$folder: biteline-sensor is not the file that was signed"; return 1; }
  echo "$version"
}

# A stopped program lights nothing: it is stopped before anything is replaced.
start_old() {
  local old=$1
  service stop || true
  rm -rf "$root"/*.part
  # Where nothing was changed nothing needs room on a disk that is full.
  [ "$(current)" = "$old" ] || lead_to "$old"
  rm -f "$root/trial"
  sync -f "$root"
  service start || { say "version $old does not start either: look at the journal" >&2; exit 4; }
}

# reaches_rates PROGRAM: three seconds of pictures in the dark, with the unit's own head and settings.
reaches_rates() {
  local program=$1 settings options=()
  [ -f "$head" ] || return 0
  # A version from before this check is tried without.
  timeout --kill-after=1 "$patience" "$program" --help 9>&- 2>/dev/null | grep -q -e --check-rate || return 0
  settings=$(sed -nE 's/^[^#]*--settings[ =]"?([^" ]+).*/\1/p' "$env" 2>/dev/null | tail -1 || true)
  [ -z "$settings" ] || options=(--settings "$settings")
  timeout --kill-after=1 "$patience" "$program" --check-rate --source "board:$board" --sensor "$head" "${options[@]}" 9>&-
}

# The program's own check (camera, lines, laser, rights, rates), then a start that lasts.
passes() {
  local program=$root/versions/$1/biteline-sensor turn
  timeout --kill-after=1 "$patience" "$program" --check --source "board:$board" 9>&- ||
    { say "version $1 does not pass its own check"; return 1; }
  reaches_rates "$program" || { say "version $1 does not reach its rates"; return 1; }
  service start || { say "version $1 does not start"; return 1; }
  for ((turn = 0; turn < patience * 2; ++turn)); do
    service is-active || { say "version $1 started and ended"; return 1; }
    sleep 0.2
  done
}

# place FOLDER: sets `version`, which stands whole among the versions, and on the disk.
place() {
  local folder=$1 staged
  version=$(verify "$folder") || refuse "$version"
  [ "$version" != "$(current)" ] || refuse "version $version runs already"
  staged=$root/versions/.$version.part
  rm -rf "$staged"
  mkdir "$staged"
  cp "$folder/manifest" "$folder/manifest.sig" "$folder/biteline-sensor" "$staged/"
  # What was copied is what was signed, whatever the folder holds by now.
  [ "$(verify "$staged")" = "$version" ] || refuse "$folder: changed while it was read"
  chmod 755 "$staged/biteline-sensor"
  sync -f "$staged"
  rm -rf "$root/versions/$version"
  mv -T "$staged" "$root/versions/$version"
}

begin() {
  [ -z "$(current)" ] || refuse "version $(current) is there already: biteline-update install"
  place "$1"
  lead_to "$version"
  say "version $version is the first"
}

install_version() {
  # Not local: the trap needs it.
  old=$(current)
  [ -n "$old" ] || refuse "$root: no version to go back to: biteline-update begin"
  place "$1"
  # Whatever fails from here on, a full disk too, ends with the old version.
  trap 'start_old "$old"; say "back at version $old"; exit 3' EXIT
  service stop
  echo "$old" >"$root/trial.part"
  sync -f "$root"
  mv -T "$root/trial.part" "$root/trial"
  sync -f "$root"
  lead_to "$version"
  passes "$version" || exit 3
  rm "$root/trial"
  trap - EXIT
  sync -f "$root"
  say "version $version runs"
}

# A trial whose end nobody lived to see.  While an installation holds the lock, the trial is its own.
recover() {
  local old
  flock -n 9 || return 0
  rm -rf "$root"/versions/.*.part "$root"/*.part
  [ -f "$root/trial" ] || return 0
  old=$(cat "$root/trial")
  lead_to "$old"
  rm "$root/trial"
  sync -f "$root"
  say "a trial was cut short: back at version $old"
}

status() {
  local version
  say "version $(current) runs$([ -f "$root/trial" ] && echo ", on trial for $(cat "$root/trial")")"
  for version in "$root"/versions/*/; do if [ -d "$version" ]; then echo "  $(basename "$version")"; fi; done
}

sign() {
  local key=$1 folder=$2 version=$3
  [ -f "$folder/biteline-sensor" ] || refuse "$folder: no biteline-sensor"
  is_version "$version" || refuse "'$version': a version of letters, digits, . + ~ and - expected, 64 at most"
  printf 'version %s\nsha256 %s\n' "$version" "$(sha256sum <"$folder/biteline-sensor" | cut -d' ' -f1)" >"$folder/manifest"
  openssl pkeyutl -sign -rawin -inkey "$key" -in "$folder/manifest" -out "$folder/manifest.sig" || refuse "$key: no private ed25519 key"
}

case ${words[0]:-} in
  sign)
    [ ${#words[@]} -eq 4 ] || refuse "sign KEY FOLDER VERSION expected (see --help)"
    sign "${words[@]:1}"
    exit 0 ;;
  begin | install) [ ${#words[@]} -eq 2 ] || refuse "${words[0]} FOLDER expected (see --help)" ;;
  recover | status) [ ${#words[@]} -eq 1 ] || refuse "${words[0]} takes nothing (see --help)" ;;
  *) refuse "begin, install, recover, status or sign expected (see --help)" ;;
esac
if [ "${words[0]}" = begin ]; then mkdir -p "$root/versions"; fi
[ -d "$root/versions" ] || refuse "$root: no versions there: biteline-update begin"
exec 9>"$root/lock"
case ${words[0]} in
  status) status ;;
  recover) recover ;;
  begin | install)
    flock -n 9 || refuse "another installation is on"
    [ ! -f "$root/trial" ] || refuse "a trial was cut short: biteline-update recover, then again"
    [ -f "$trusted" ] || refuse "$trusted: no key to trust"
    if [ "${words[0]}" = begin ]; then begin "${words[1]}"; else install_version "${words[1]}"; fi ;;
esac
