#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# backup_test.sh BACKUP SENSOR BOARD [EACH]: a unit comes back from one file; a spoiled file and a cut restore change nothing; secrets only when asked.
# A restore is cut at every EACHth of its commands; 1: at every one.
set -euo pipefail
backup=$1 sensor=$2 board=$3 each=${4:-1}
. "$(dirname "${BASH_SOURCE[0]}")/work_folder.sh"
work=$(work_folder biteline-backup)
trap 'rm -rf "$work"' EXIT
bad() { echo "$1"; exit 1; }
cd "$work"

cat >stopped <<'TEXT'
#!/bin/sh
exit 3
TEXT
cat >running <<'TEXT'
#!/bin/sh
exit 0
TEXT
chmod +x stopped running

make_unit() {
  mkdir -p "$1/etc/settings" "$1/state"
  cp "$board" "$1/etc/board.yaml"
  echo 'camera: {exposure_us: 250}' >"$1/etc/settings/start-up.yaml"
  echo 'BITELINE_SENSOR_OPTIONS=' >"$1/etc/sensor.env"
  printf 'starts: 7\nboots: 2\nrun_s: 10\nlaser_s: 1\nlightings: 3\nboot_id: "8f-1"\n' >"$1/state/upkeep.yaml"
  "$sensor" --make-keys "$1/etc/keys" >/dev/null
  ln -s /etc/passwd "$1/etc/linked.yaml"
}
run() { "$backup" --etc "$1/etc" --state "$1/state" --service "$work/stopped" "${@:2}"; }
# All that a unit is, name by name.
look() { (cd "$1" && find etc state -type f | sort | xargs sha256sum); }

make_unit one
run one save plain.backup >told || bad "not saved"
[ "$(stat -c %a plain.backup)" = 600 ] || bad "others may read it"
[ "$(tar -tzf plain.backup | grep -cE 'secret|linked')" = 0 ] || bad "a secret or a link is in it"
run one check plain.backup >told || bad "a good file is refused"
grep -qx 'etc/settings/start-up.yaml' told && grep -qx 'keys: no' told || bad "what is in it is not told"

# Into a unit with keys of its own: they stay, all else is as saved.
make_unit two
echo 'camera: {exposure_us: 999}' >two/etc/settings/start-up.yaml
rm two/etc/sensor.env
echo 'a note' >two/etc/note.txt
secret=$(cat two/etc/keys/*.secret | sha256sum)
look two >two.before
[ "$("$backup" --etc two/etc --state two/state --service "$work/running" restore plain.backup 2>&1 >/dev/null; echo $?)" != 0 ] || bad "restored beside a sensor that runs"
look two | diff - two.before || bad "a refused restore changed something"
run two restore plain.backup >told || bad "not restored"
cmp -s one/etc/settings/start-up.yaml two/etc/settings/start-up.yaml || bad "settings are not as saved"
cmp -s one/etc/sensor.env two/etc/sensor.env || bad "what was missing is not back"
cmp -s one/state/upkeep.yaml two/state/upkeep.yaml || bad "the count is not as saved"
[ "$(cat two/etc/keys/*.secret | sha256sum)" = "$secret" ] || bad "the unit's own key is gone"
[ "$(cat two/etc/note.txt)" = 'a note' ] || bad "a file of others is gone"
grep -q 999 two/etc.before/settings/start-up.yaml || bad "what was before is gone"
[ ! -e two/etc.restored ] || bad "something is left over"

# With keys: another machine is that unit.
run one save --with-keys keys.backup >/dev/null
[ "$(tar -tzf keys.backup | grep -c 'secret$')" -gt 0 ] || bad "the keys are not in it"
mkdir three
run three restore keys.backup >/dev/null || bad "not restored into nothing"
[ -z "$(find three/etc/keys -type f 2>/dev/null)" ] || bad "keys came without being asked for"
rm -r three && mkdir three
run three restore --with-keys keys.backup >/dev/null || bad "not restored into nothing with its keys"
[ "$(cat three/etc/keys/*.secret)" = "$(cat one/etc/keys/*.secret)" ] || bad "the key is another"
for key in three/etc/keys/*.secret; do [ "$(stat -c %a "$key")" = 600 ] || bad "others may read $key"; done

# Whom a unit trusts is no setting: a file whose sums are all right may be anybody's.
make_unit own
echo 'the key of who signs' >own/etc/update.pem
echo 'host-1 public-key-1' >own/etc/keys/hosts.allowed
rm -rf open && mkdir open && tar -xzf keys.backup -C open
mkdir -p open/etc/trust open/etc/keys/more
for name in update.pem other.pem settings/update.pem keys/hosts.allowed trust/hosts.allowed keys/stranger.public keys/sensor.secret keys/more/x.secret \
  keys/hosts.yaml update.env more.env notes; do
  echo 'BITELINE_SENSOR_OPTIONS="--keys /etc/biteline/trust"' >"open/etc/$name"
done
echo 'LD_PRELOAD=/tmp/evil.so' >open/etc/more.env
echo 'camera: {exposure_us: 123}' >open/etc/settings/start-up.yaml
(cd open && find about etc state -type f | sort | xargs sha256sum && echo '# end') >stranger.sums && mv stranger.sums open/sums
tar -C open -czf stranger.backup about sums etc state
(cd own/etc && find . -type f ! -path './settings/*' ! -name sensor.env ! -name board.yaml | sort | xargs sha256sum) >trust.before
run own restore stranger.backup >told || bad "a stranger's settings are not restored: $(cat told)"
grep -q 123 own/etc/settings/start-up.yaml || bad "settings are not as saved"
(cd own/etc && find . -type f ! -path './settings/*' ! -name sensor.env ! -name board.yaml | sort | xargs sha256sum) | diff - trust.before || bad "a restore changed whom the unit trusts"
grep -q 'not changed.*update.pem' told && grep -q 'keys/hosts.allowed' told || bad "what was left as it is, is not told"
run own restore --with-trust stranger.backup >told || bad "not restored with its hosts"
grep -q 'lets in the 1 hosts' told && grep -q trust own/etc/keys/hosts.allowed || bad "the hosts are not those of the file, or it is not told"
[ "$(cat own/etc/update.pem)" = 'the key of who signs' ] && [ ! -e own/etc/other.pem ] && [ ! -e own/etc/more.env ] || bad "who signs is another, or foreign files came"

# Spoiled files change nothing.
look two >two.before
spoiled() {
  local status=0
  run two restore "$1" >told 2>&1 || status=$?
  [ $status -eq 2 ] || bad "$1: exit $status, 2 expected: $(cat told)"
  look two | diff - two.before >/dev/null || bad "$1 changed something"
}
size=$(stat -c %s plain.backup)
for part in 0 100 $((size / 2)) $((size - 20)); do head -c "$part" plain.backup >cut.backup && spoiled cut.backup; done
rm -rf open && mkdir open && tar -xzf plain.backup -C open
echo 'camera: {exposure_us: 1}' >open/etc/settings/start-up.yaml
tar -C open -czf changed.backup about sums etc state && spoiled changed.backup
rm open/etc/settings/start-up.yaml && tar -C open -czf lacking.backup about sums etc state && spoiled lacking.backup
rm -rf open && mkdir open && tar -xzf plain.backup -C open && echo 'x: 1' >open/etc/more.yaml
tar -C open -czf more.backup about sums etc state && spoiled more.backup
rm -rf open && mkdir -p open && tar -xzf plain.backup -C open && ln -s /etc/shadow open/etc/link.yaml
tar -C open -czf link.backup about sums etc state && spoiled link.backup
echo evil >evil.yaml && tar -P -czf out.backup ../"$(basename "$work")"/evil.yaml && spoiled out.backup
echo text >none.backup && spoiled none.backup
spoiled no-such.backup

# Cut at every EACHth command: the old unit or the new one, never a mixture; the next restore is whole.
rm -rf two/etc.before
sed '2,$s/^set -euo pipefail$/&\nbackup_step=0\ntrap '"'"'backup_step=$((backup_step+1)); [ $backup_step -ne "${BACKUP_CUT:-0}" ] || kill -9 $$'"'"' DEBUG\nset -T/' "$backup" >cut.sh
chmod +x cut.sh
make_unit fresh
echo 'camera: {exposure_us: 999}' >fresh/etc/settings/start-up.yaml
(cd fresh/etc && find . -type f | sort | xargs sha256sum) >old
steps=0
for cut in $(seq 1 "$each" 400); do
  rm -rf trial && cp -a fresh trial
  status=0
  # Bash itself tells of a kill.
  { BACKUP_CUT=$cut ./cut.sh --etc trial/etc --state trial/state --service "$work/stopped" restore plain.backup >/dev/null 2>&1; } 2>/dev/null || status=$?
  [ $status -ne 0 ] || { steps=$cut; break; }
  for place in trial/etc trial/etc.before trial/etc.restored; do [ -d trial/etc ] || [ -d "$place" ] || bad "cut at $cut: nothing is left"; done
  if [ -d trial/etc ]; then
    (cd trial/etc && find . -type f | sort | xargs sha256sum) >now
    cmp -s old now || cmp -s one/etc/settings/start-up.yaml trial/etc/settings/start-up.yaml || bad "cut at $cut: a mixture"
  fi
  run trial restore plain.backup >/dev/null || bad "cut at $cut: the next restore is refused"
  cmp -s one/etc/settings/start-up.yaml trial/etc/settings/start-up.yaml || bad "cut at $cut: not as saved"
  [ -z "$(find trial -mindepth 1 -maxdepth 1 ! -name etc ! -name etc.before ! -name state)" ] || bad "cut at $cut: left over"
done
[ $steps -gt 30 ] || bad "only $steps steps were cut"

status=0
"$backup" save >told 2>&1 || status=$?
[ $status -eq 2 ] || bad "no file named: exit $status"
echo "one file, $(tar -tzf plain.backup | grep -vc '/$') files in it; cut at every ${each}th of $steps commands"
