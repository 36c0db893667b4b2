#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# update_test.sh UPDATE SENSOR BOARD [EACH]: whatever happens to an installation, the unit runs one whole version that was signed.
# It is cut short at every EACHth of its commands; 1: at every one.
set -euo pipefail
update=$1 sensor=$2 board=$3 each=${4:-1}
command -v openssl >/dev/null || { echo "skipped: no openssl"; exit 77; }
. "$(dirname "${BASH_SOURCE[0]}")/work_folder.sh"
work=$(work_folder biteline-update)
trap 'rm -rf "$work"' EXIT
bad() { echo "$1"; [ ! -f "$work/told" ] || cat "$work/told"; exit 1; }
root=$work/root

for name in own other; do
  openssl genpkey -algorithm ed25519 -out "$work/$name.key" 2>/dev/null
  openssl pkey -in "$work/$name.key" -pubout -out "$work/$name.pem"
done

# In place of systemd: the program that `current` leads to says by itself whether it goes on.
cat >"$work/service" <<TEXT
#!/bin/sh
echo "\$1 \$(basename "\$(readlink $root/current)")" >>$work/calls
case \$1 in
  start) $root/current/biteline-sensor --start ;;
  is-active) $root/current/biteline-sensor --active ;;
esac
TEXT
chmod +x "$work/service"

# package NAME VERSION CHECK START ACTIVE [KEY]: a folder whose program does so when it is checked, started, asked.
package() {
  mkdir -p "$work/$1"
  printf '#!/bin/sh\n# %s\ncase $1 in --check) %s ;; --start) %s ;; --active) %s ;; esac\n' "$2" "$3" "$4" "$5" >"$work/$1/biteline-sensor"
  "$update" sign "$work/${6:-own}.key" "$work/$1" "$2"
}
run() {
  local status=0
  "$update" --root "$root" --trusted "$work/own.pem" --board "$board" --head "${head:-$work/no_head}" --env "$work/sensor.env" \
    --service "$work/service" --patience "${patience:-3}" "$@" >"$work/told" 2>&1 || status=$?
  return $status
}
# A unit that runs version 1: begun once, and copied from then on.
fresh() {
  rm -rf "$root" "$work/calls"
  if [ -d "$work/begun" ]; then
    cp -a "$work/begun" "$root"
    return
  fi
  run begin "$work/first" || bad "no first version"
  grep -q 'version 1 is the first' "$work/told" || bad "the first version told nothing"
  cp -a "$root" "$work/begun"
}
# One whole version that was signed, and nothing left over.
expect_whole() {
  local folder
  folder=$root/$(readlink "$root/current")
  openssl pkeyutl -verify -rawin -pubin -inkey "$work/own.pem" -in "$folder/manifest" -sigfile "$folder/manifest.sig" >/dev/null 2>&1 ||
    bad "$2: what runs is not signed"
  [ "$(sed -n '2s/^sha256 //p' "$folder/manifest")" = "$(sha256sum <"$folder/biteline-sensor" | cut -d' ' -f1)" ] || bad "$2: what runs is not whole"
  [ -x "$folder/biteline-sensor" ] || bad "$2: what runs cannot run"
  [ ! -e "$root/trial" ] || bad "$2: still on trial"
  [ -z "$(find "$root" -name '*.part')" ] || bad "$2: parts are left: $(find "$root" -name '*.part')"
  [[ " $1 " == *" $(basename "$folder") "* ]] || bad "$2: version $(basename "$folder") runs, not one of: $1"
}
# expect CASE STATUS VERSION FOLDER WORDS
expect() {
  local status=0
  fresh
  run install "$work/$4" || status=$?
  [ $status -eq "$2" ] || bad "$1: exit $status, not $2"
  grep -q "$5" "$work/told" || bad "$1: told otherwise than '$5'"
  expect_whole "$3" "$1"
  # Nothing is replaced under a program that runs.
  if [ -e "$work/calls" ]; then [ "$(head -1 "$work/calls")" = "stop 1" ] || bad "$1: replaced while it ran: $(head -1 "$work/calls")"; fi
}

package first 1 'exit 0' 'exit 0' 'exit 0'
package good 2 'exit 0' 'exit 0' 'exit 0'
package blind 2 'echo "missing camera"; exit 4' 'exit 0' 'exit 0'
package hangs 2 'exec sleep 30' 'exit 0' 'exit 0'
package stays_out 2 'exit 0' 'exit 1' 'exit 0'
package ends 2 'exit 0' 'exit 0' 'exit 1'
package foreign 2 'exit 0' 'exit 0' 'exit 0' other
package spoiled 2 'exit 0' 'exit 0' 'exit 0'
echo '# one line more' >>"$work/spoiled/biteline-sensor"
package renamed 2 'exit 0' 'exit 0' 'exit 0'
sed -i 's/^version 2/version 3/' "$work/renamed/manifest"
package climbs 2 'exit 0' 'exit 0' 'exit 0'
# Signed by hand: biteline-update signs no such name.
sed -i '1s,.*,version ../../1,' "$work/climbs/manifest"
openssl pkeyutl -sign -rawin -inkey "$work/own.key" -in "$work/climbs/manifest" -out "$work/climbs/manifest.sig"
package same 1 'exit 0' 'exit 0' 'exit 0'
cp -r "$work/good" "$work/bare" && rm "$work/bare/manifest.sig"
cp -r "$work/good" "$work/linked" && ln -sf "$work/good/biteline-sensor" "$work/linked/biteline-sensor"
mkdir "$work/real" "$work/garbage"
cp "$sensor" "$work/real/biteline-sensor" && "$update" sign "$work/own.key" "$work/real" 2
# Of a program only its first bytes: made-up ones might be taken for a script.
printf '\177ELF\002\001\001' >"$work/garbage/biteline-sensor" && head -c 5000 /dev/zero >>"$work/garbage/biteline-sensor" && "$update" sign "$work/own.key" "$work/garbage" 2

# A program that knows --check-rate, and what it says of them.
knows_rates() {
  mkdir -p "$work/$1"
  cat >"$work/$1/biteline-sensor" <<TEXT
#!/bin/sh
case "\$1 \$2" in
  "--help ") echo "  --check-rate   ..." ;;
  "--check-rate --source") echo "\$*" >$work/asked; $2 ;;
esac
TEXT
  "$update" sign "$work/own.key" "$work/$1" 2
}
knows_rates quick 'exit 0'
knows_rates slow 'echo "missing rate"; exit 4'
knows_rates stuck 'exec sleep 30'

expect 'a good version' 0 2 good 'version 2 runs'
expect 'a check that fails' 3 1 blind 'does not pass its own check'
expect 'a check that hangs' 3 1 hangs 'does not pass its own check'
expect 'a program that does not start' 3 1 stays_out 'version 2 does not start'
expect 'a program that ends' 3 1 ends 'started and ended'
expect 'a program that is none' 3 1 garbage 'does not pass its own check'
touch "$work/head.yaml"
head=$work/head.yaml expect 'a version that knows no rates' 0 2 good 'version 2 runs'
head=$work/head.yaml expect 'a version that keeps its rates' 0 2 quick 'version 2 runs'
grep -q -e "--sensor $work/head.yaml\$" "$work/asked" || bad "rates: asked $(cat "$work/asked")"
echo 'BITELINE_SENSOR_OPTIONS="--keys /k --settings /etc/biteline/settings --stay"' >"$work/sensor.env"
head=$work/head.yaml expect 'a version that is too slow' 3 1 slow 'version 2 does not reach its rates'
grep -q -e "--settings /etc/biteline/settings\$" "$work/asked" || bad "rates: asked $(cat "$work/asked")"
head=$work/head.yaml expect 'a version whose pictures do not come' 3 1 stuck 'version 2 does not reach its rates'
expect 'no head to have rates' 0 2 slow 'version 2 runs'
# A name that no unit would take is not signed either.
for name in 'a b' '../1' '' "$(printf 'v%.0s' $(seq 65))"; do
  "$update" sign "$work/own.key" "$work/bare" "$name" >"$work/told" 2>&1 && bad "version '$name' was signed"
  grep -q 'a version of letters' "$work/told" || bad "version '$name': $(cat "$work/told")"
  [ ! -e "$work/bare/manifest" ] || [ "$(sed -n 1p "$work/bare/manifest")" != "version $name" ] || bad "version '$name' left a manifest"
done
expect 'another signature' 2 1 foreign 'not signed by'
expect 'no signature' 2 1 bare 'no manifest.sig'
expect 'another file' 2 1 spoiled 'not the file that was signed'
expect 'another manifest' 2 1 renamed 'not signed by'
expect 'a version that leads elsewhere' 2 1 climbs 'no version in its first line'
expect 'the same version' 2 1 same 'runs already'
expect 'a link in place of the program' 2 1 linked 'no biteline-sensor'
expect 'no folder' 2 1 nowhere 'no manifest'
# The sensor's own program, on a machine without that board's devices.
# It may take its time to say so: on a busy machine, too.
patience=25 expect 'the real program without its devices' 3 1 real 'does not pass its own check'
grep -q 'devices and rights are missing' "$work/told" || bad "the real program told nothing of its devices"

# What cannot be written down is not tried.
fresh
mkdir "$root/trial.part"
status=0
run install "$work/good" || status=$?
[ $status -eq 3 ] || bad "a trial that cannot be written: exit $status"
expect_whole 1 'a trial that cannot be written'
[ "$(tail -1 "$work/calls")" = "start 1" ] || bad "a trial that cannot be written: the old version was not started"
run begin "$work/good" && bad "a second beginning"

# One at a time, and nothing while a trial waits to be looked at.
fresh
exec 8>"$root/lock"
flock 8
run install "$work/good" && bad "two at a time"
grep -q 'another installation' "$work/told" || bad "two at a time: told otherwise"
run recover || bad "no recovery beside an installation"
flock -u 8

# Killed before each of its commands, as by a cut of the power: then the unit starts again.
killer=$work/killer
cat >"$killer" <<'TEXT'
set -T
killer_count=0
trap 'if [ $BASHPID = $$ ] && [ $((killer_count += 1)) -eq $KILL_AT ]; then kill -9 $$; fi' DEBUG
TEXT
for folder in good blind; do
  tries=0 old=0 new=0
  for ((cuts = 1; ; cuts += each)); do
    tries=$((tries + 1))
    fresh
    status=0
    # The braces take the shell's own word of who was killed.
    {
      BASH_ENV=$killer KILL_AT=$cuts "$update" --root "$root" --trusted "$work/own.pem" --board "$board" --service "$work/service" \
        --patience 3 install "$work/$folder" >"$work/told" 2>&1 || status=$?
    } 2>/dev/null
    [ $status -eq 137 ] || break
    run recover || bad "$folder, cut $cuts: recovery fails"
    expect_whole "$([ $folder = good ] && echo '1 2' || echo 1)" "$folder, cut $cuts"
    if [ "$(readlink "$root/current")" = versions/2 ]; then new=$((new + 1)); else old=$((old + 1)); fi
    # Once more, undisturbed: nothing that was left is in the way.
    if [ $((tries % 8)) -eq 0 ] && [ "$(readlink "$root/current")" = versions/1 ]; then
      run install "$work/good" || bad "$folder, cut $cuts: no second try"
      expect_whole 2 "$folder, cut $cuts, second try"
    fi
  done
  [ $cuts -gt 50 ] && [ $((old * each)) -gt 40 ] || bad "$folder: only $cuts cuts"
  [ $status -eq "$([ $folder = good ] && echo 0 || echo 3)" ] || bad "$folder: exit $status at its end"
  echo "$folder version: cut short at $((tries - 1)) of its $cuts commands; $old times back, $new times there"
done
