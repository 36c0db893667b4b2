#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# bundle_test.sh BUNDLE SENSOR BOARD: a unit's bundle has what it promises and no secret, whatever its commands do.
set -euo pipefail
bundle=$1 sensor=$2 board=$3
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-bundle-XXXXXX")
trap 'rm -rf "$work"' EXIT
bad() { echo "$1"; exit 1; }

mkdir -p "$work/etc"
cp "$board" "$work/etc/board.yaml"
"$sensor" --make-keys "$work/etc/keys" >/dev/null
secret=$(find "$work/etc/keys" -name '*.secret' -exec cat {} + | awk 'length($0) >= 16' | head -1)
[ -n "$secret" ] || bad "no secret to look for"
# Somebody wrote it where it must not be, and made a link to a file of others.
printf 'note: "%s"\n' "$secret" >"$work/etc/careless.yaml"
ln -s /etc/passwd "$work/etc/linked.yaml"

cd "$work"
"$bundle" --etc "$work/etc" --program "$sensor" --lines 20 "$work/told.tar.gz" >"$work/told" || bad "no bundle"
mkdir open && tar -xzf told.tar.gz -C open
inside=$(echo open/*)
for file in version check update unit upkeep journal kernel machine command_line processors memory interrupts disks network packages files; do
  [ -s "$inside/$file.txt" ] || bad "no $file.txt"
done
grep -q '[0-9]\.[0-9]' "$inside/version.txt" || bad "no version"
grep -q 'devices and rights are missing' "$inside/check.txt" || bad "no check: $(cat "$inside/check.txt")"
cmp -s "$board" "$inside/settings/board.yaml" || bad "no board.yaml"
! grep -rqFe "$secret" open || bad "the secret is in it"
grep -q 'holds a secret' "$inside/settings/careless.yaml" || bad "what was left out is not told"
[ ! -e "$inside/settings/linked.yaml" ] || bad "a link was followed"
[ "$(stat -c %a told.tar.gz)" = 600 ] || bad "others may read it"

# A folder of keys elsewhere is searched, too.
mkdir "$work/moved" && mv "$work/etc/keys" "$work/moved/keys" && ln -s "$work/moved/keys" "$work/etc/keys"
"$bundle" --etc "$work/etc" --program "$sensor" --lines 1 "$work/linked.tar.gz" >/dev/null || bad "no bundle where the keys are elsewhere"
[ "$(tar -xzOf linked.tar.gz | grep -cFe "$secret")" = 0 ] || bad "the secret is in it where the keys are elsewhere"
status=0
"$bundle" --etc "$work/etc" --program "$sensor" --lines 1 "$work/open" >"$work/told" 2>&1 || status=$?
[ $status -eq 2 ] && grep -q 'not written' "$work/told" || bad "a folder in place of the file: exit $status"

# A program that is not there costs its own part; a place that cannot be written is told.
"$bundle" --etc "$work/nowhere" --program "$work/none" --lines 1 "$work/poor.tar.gz" >/dev/null || bad "no bundle of a poor unit"
tar -xzOf poor.tar.gz --wildcards '*/version.txt' | grep -q 'exit status' || bad "a missing program is not told"
status=0
"$bundle" --etc "$work/etc" --program "$sensor" "$work/no/such/place.tar.gz" >"$work/told" 2>&1 || status=$?
[ $status -eq 2 ] && grep -q 'not written' "$work/told" || bad "a place that is none: exit $status"
[ -z "$(find "$work" -maxdepth 1 -name '*.part')" ] || bad "a part is left"
status=0
"$bundle" --lines many >"$work/told" 2>&1 || status=$?
[ $status -eq 2 ] || bad "--lines many: exit $status"
echo "$(tar -tzf told.tar.gz | wc -l) entries, no secret"
