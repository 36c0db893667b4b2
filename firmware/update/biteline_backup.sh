#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# biteline-backup: all that makes a unit this unit as one file, and back.
set -euo pipefail
umask 077

usage() {
  cat <<'TEXT'
biteline-backup: all that makes a unit this unit as one file, and back.

  biteline-backup save FILE       settings, calibration, board, allowed hosts and the unit's count into FILE (tar, gzip)
  biteline-backup check FILE      is FILE whole, and what is in it
  biteline-backup restore FILE    put it all in place; what was there before stays beside it, in ETC.before

Options:
  --with-keys       save: the unit's own keys, too; whoever has FILE then is this unit
                    restore: the keys in FILE become this unit's
  --with-trust      restore: the hosts that FILE lets in (hosts.allowed) are let in, and no others
  --etc DIR         the unit's settings (/etc/biteline)
  --state DIR       where the unit keeps its count (/var/lib/biteline)
  --service PROGRAM called with is-active (systemctl on biteline-sensor)
  --help

A restore leaves whom this unit trusts as it is: allowed hosts and own keys change by the options above alone,
and who signs its updates (update.pem) never does: put that file in place by hand.
Exit status: 0 done; 2 wrong use, or a file that is not taken: nothing was changed.
TEXT
}

refuse() { echo "biteline-backup: $*" >&2; exit 2; }

etc=/etc/biteline
state=/var/lib/biteline
service_program=
with_keys=no
with_trust=no
words=()
while [ $# -gt 0 ]; do
  case $1 in
    --help) usage; exit 0 ;;
    --with-keys) with_keys=yes ;;
    --with-trust) with_trust=yes ;;
    --etc | --state | --service)
      [ $# -gt 1 ] || refuse "$1 needs a value (see --help)"
      case $1 in
        --etc) etc=${2%/} ;;
        --state) state=${2%/} ;;
        --service) service_program=$2 ;;
      esac
      shift ;;
    -*) refuse "unknown option $1 (see --help)" ;;
    *) words+=("$1") ;;
  esac
  shift
done
[ ${#words[@]} -eq 2 ] || refuse "save, check or restore with one FILE expected (see --help)"
what=${words[0]} file=${words[1]}
work=
part=
trap 'rm -rf ${work:+"$work"} ${part:+"$part"}' EXIT

# What is kept, below ETC; a link is followed nowhere.
wanted() {
  local keys=(-path './keys/hosts.allowed')
  [ $with_keys = no ] || keys+=(-o -path './keys/*.public' -o -path './keys/*.secret')
  find . -type f \( -path './*.yaml' -o -path './*.env' -o -path './*.pem' -o "${keys[@]}" \) ! -path './keys/*.yaml' | sort
}

# A file's names: plain, below etc/ or state/, no way out of them.
check_names() {
  local bad
  bad=$(tar -tzf "$1" 2>/dev/null | grep -vE '^(about|sums|(etc|state)(/[A-Za-z0-9_][A-Za-z0-9._-]*)*/?)$' | head -1) || true
  [ -z "$bad" ] || refuse "$file: holds '$bad', which is nothing of a unit's"
  # Counted to the end: a reader that leaves early would look like a good file.
  [ "$(tar -tvzf "$1" 2>/dev/null | grep -cv '^[-d]')" = 0 ] || refuse "$file: holds something that is no file"
}

# Unpacked into the empty folder $work, every sum right; or refused.
unpack() {
  [ -f "$file" ] || refuse "$file: no such file"
  check_names "$file"
  tar -xzf "$file" -C "$work" --no-same-owner --no-same-permissions 2>/dev/null || refuse "$file: cut short, or no backup"
  [ -f "$work/sums" ] && grep -qx 'kind: biteline-unit 1' "$work/about" 2>/dev/null || refuse "$file: no backup of a unit"
  # Each file has its sum, each sum its file, and the list has its own end.
  [ "$(tail -1 "$work/sums")" = "# end" ] || refuse "$file: its list is cut"
  (cd "$work" && grep -v '^#' sums | sha256sum --check --strict --quiet >/dev/null 2>&1) || refuse "$file: a file in it is changed or missing"
  local listed present
  listed=$(grep -v '^#' "$work/sums" | sed 's/^[0-9a-f]* [ *]//' | sort)
  present=$(cd "$work" && find about etc state -type f 2>/dev/null | sort)
  [ "$listed" = "$present" ] || refuse "$file: holds a file that its list does not name"
}

save() {
  [ -d "$etc" ] || refuse "$etc: no such folder"
  work=$(mktemp -d)
  mkdir "$work/etc" "$work/state"
  # Without rights find passes folders over: that would be a file that looks whole.
  (cd "$etc" && wanted) >"$work/names" 2>/dev/null || refuse "$etc: cannot be read: run as root"
  [ ! -d "$state" ] || [ -x "$state" ] || refuse "$state: cannot be read: run as root"
  local name
  while read -r name; do
    [[ ${name#./} =~ ^[A-Za-z0-9_][A-Za-z0-9._-]*(/[A-Za-z0-9_][A-Za-z0-9._-]*)*$ ]] || refuse "$etc/${name#./}: letters, digits, . _ and - expected in its name"
    mkdir -p "$work/etc/$(dirname "$name")"
    cp "$etc/$name" "$work/etc/$name" || refuse "$etc/$name: cannot be read: run as root"
  done <"$work/names"
  [ ! -f "$state/upkeep.yaml" ] || cp "$state/upkeep.yaml" "$work/state/"
  {
    echo 'kind: biteline-unit 1'
    echo "unit: $(hostname)"
    echo "time: $(date -u +%Y-%m-%dT%H:%M:%SZ)"
    echo "keys: $with_keys"
  } >"$work/about"
  (cd "$work" && find about etc state -type f | sort | xargs -r sha256sum && echo '# end') >"$work/sums"
  # A name that nobody can have taken before: this may run as root in a folder of all.
  part=$(mktemp "$file.XXXXXX.part" 2>/dev/null) || refuse "$file: not written"
  tar --force-local -C "$work" -czf "$part" about sums etc state 2>/dev/null && sync "$part" && mv -T "$part" "$file" 2>/dev/null ||
    refuse "$file: not written"
  echo "biteline-backup: $file, $(grep -vc '^#' "$work/sums") files, keys: $with_keys"
}

# Settings that name a place of keys, or that are no settings of ours, would say whom to trust by another name.
is_plain_env() {
  ! grep -qvE '^[[:space:]]*(#.*)?$|^BITELINE_[A-Z_]*=' "$1" && ! grep -qE -- '--(keys|trusted)' "$1"
}

# Takes out of the unpacked folder $1 what a restore does not change, and tells it.  What is left in are settings.
leave_trust() {
  local name told=()
  (cd "$1" && find . -type f | sort) >"$work/left"
  while read -r name; do
    name=${name#./}
    case $name in
      keys/hosts.allowed) [ $with_trust = no ] || continue ;;
      keys/*/*) ;;
      keys/*.public | keys/*.secret) [ $with_keys = no ] || continue ;;
      keys/*) ;;
      *.yaml) continue ;;
      *.env) if is_plain_env "$1/$name" || cmp -s "$1/$name" "$etc/$name"; then continue; fi ;;
    esac
    cmp -s "$1/$name" "$etc/$name" || told+=("$name")
    rm "$1/$name"
  done <"$work/left"
  [ ${#told[@]} -eq 0 ] || echo "biteline-backup: not changed by a restore: ${told[*]} (see --help)"
}

# As the unit's own files are: theirs where they are, else those of the folder.
own_as_before() {
  local name
  (cd "$1" && find . -mindepth 1 | sort) | while read -r name; do
    if [ -e "$etc/$name" ]; then
      chown --reference="$etc/$name" "$1/$name" && chmod --reference="$etc/$name" "$1/$name"
    else
      chown --reference="$etc" "$1/$name"
      # Its user reads its own key; another machine's file had another owner.
      case $name in *.secret) chmod 600 "$1/$name" && { chown biteline "$1/$name" 2>/dev/null || true; } ;; *) [ -d "$1/$name" ] && chmod 755 "$1/$name" || chmod 644 "$1/$name" ;; esac
    fi
  done
}

is_running() {
  if [ -n "$service_program" ]; then
    "$service_program" is-active
  else
    systemctl --quiet is-active biteline-sensor.service 2>/dev/null
  fi
}

restore() {
  local new=$etc.restored
  # An earlier restore was cut between its two last steps: the whole new folder is there.
  if [ ! -e "$etc" ] && [ -e "$new" ] && [ -e "$etc.before" ]; then
    mv -T "$new" "$etc"
    echo "biteline-backup: an earlier restore is finished: $etc"
  fi
  [ -d "$etc" ] || mkdir -p -m 755 "$etc"
  [ -d "$state" ] || mkdir -p -m 755 "$state"
  # Of one name: what a cut restore left, keys maybe, goes with the next.
  work=$etc.unpacked
  rm -rf "$work" "$new"
  mkdir "$work"
  unpack
  is_running && refuse "biteline-sensor runs: systemctl stop biteline-sensor, then again"
  # What is not in the file stays: keys, notes of others.
  cp -a "$etc" "$new"
  cp -rT "$work/etc" "$work/over"
  leave_trust "$work/over"
  [ $with_trust = no ] || [ ! -f "$work/over/keys/hosts.allowed" ] ||
    echo "biteline-backup: lets in the $(grep -cvE '^[[:space:]]*(#.*)?$' "$work/over/keys/hosts.allowed" || true) hosts of $file"
  own_as_before "$work/over"
  # A link in the unit's folder gives way to the file; what it leads to is another's.
  cp -a --remove-destination "$work/over/." "$new/"
  chown --reference="$etc" "$new" && chmod --reference="$etc" "$new"
  sync -f "$new"
  rm -rf "$etc.before"
  mv -T "$etc" "$etc.before"
  mv -T "$new" "$etc"
  if [ -f "$work/state/upkeep.yaml" ]; then
    cp "$work/state/upkeep.yaml" "$state/upkeep.yaml.new" && chown --reference="$state" "$state/upkeep.yaml.new"
    chmod 644 "$state/upkeep.yaml.new" && mv -T "$state/upkeep.yaml.new" "$state/upkeep.yaml"
  fi
  echo "biteline-backup: $etc is as in $file; before: $etc.before; start with: systemctl start biteline-sensor"
}

case $what in
  save) save ;;
  check)
    work=$(mktemp -d)
    unpack
    cat "$work/about"
    grep -v '^#' "$work/sums" | sed 's/^[0-9a-f]* [ *]//' ;;
  restore) restore ;;
  *) refuse "save, check or restore expected, not '$what' (see --help)" ;;
esac
