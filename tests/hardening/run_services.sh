#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# run_services.sh ROOT BIN: sensor, host and page each under its own unit, as an ordinary user, by a systemd of its own in a container
# whose /usr is this machine's (read-only): sensor and host with keys, before the simulated cell.  A scan must become a line, and the
# page's API must hand it out.  The sensor's threads must be as urgent as its unit allows.  Skipped by name where there is no such container.
set -euo pipefail
root=$1 bin=$2
skip() { echo "skipped: $1"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "a container needs root"
command -v systemd-nspawn >/dev/null || skip "no systemd-nspawn (package systemd-container)"
for program in biteline biteline-cell biteline-sensor biteline-host biteline-web; do
  [ -x "$bin/$program" ] || { echo "no $bin/$program"; exit 1; }
done
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-units-XXXXXX")
name=biteline-test-$$
container=
finish() {
  # The container's first process goes with everything in it.
  if [ -n "$container" ]; then
    pkill -KILL -P "$container" 2>/dev/null || true
    kill -KILL "$container" 2>/dev/null || true
  fi
  rm -rf "$work"
}
trap finish EXIT
mkdir -p "$work/units" "$work/etc" "$work/out"

# unit FILE: as it is, but for the place of the programs; what comes after it on the line is the container's own.
unit() { sed "s#=/usr/bin/biteline#=/opt/biteline/biteline#" "$1" >"$work/units/$(basename "$1")"; }
unit "$root/boards/common/systemd/biteline-sensor.service"
unit "$root/host/apps/biteline-host/systemd/biteline-host.service"
unit "$root/host/apps/biteline-web/systemd/biteline-web.service"
drop_in() { mkdir -p "$work/units/$1.service.d" && cat >"$work/units/$1.service.d/test.conf"; }
# The simulated cell's wires are this container's.  $RT: see below.
drop_in biteline-sensor <<'TEXT'
[Service]
EnvironmentFile=/etc/biteline/sensor.env
ExecStart=
ExecStart=/opt/biteline/biteline-sensor --source board:/etc/biteline/board.yaml --sensor /etc/biteline/sensor.yaml \
  --listen tcp://0.0.0.0:7117 --keys /etc/biteline/keys --rt $RT
TEXT
cat >"$work/etc/web.env" <<'TEXT'
BITELINE_WEB_OPTIONS=--control tcp://127.0.0.1:7118 --keys /etc/biteline/keys --listen 127.0.0.1:8080
TEXT
cat >"$work/etc/host.env" <<'TEXT'
BITELINE_HOST_OPTIONS=--sensor tcp://127.0.0.1:7117 --control tcp://127.0.0.1:7118
TEXT
cat >"$work/units/biteline-cell.service" <<'TEXT'
[Service]
ExecStart=/opt/biteline/biteline-cell serve --seed 2 --rate-hz 50 --speed-mm-s 100 --out /run/cell
TEXT
cat >"$work/units/check.service" <<'TEXT'
[Unit]
After=basic.target
[Service]
Type=oneshot
ExecStart=/bin/bash /test/check
StandardOutput=tty
StandardError=tty
TTYPath=/dev/console
TEXT
cat >"$work/units/check.target" <<'TEXT'
[Unit]
Requires=basic.target check.service
After=basic.target
AllowIsolate=yes
TEXT
cat >"$work/etc/check" <<'TEXT'
say() { echo "TEST $*" >>/test-out/log; }
leave() { say "status $1"; sync; systemctl exit "$1" --force; exit 0; }
trouble() {
  say "$1"
  for unit in cell sensor host web; do journalctl -u biteline-$unit --no-pager -n 15 >>/test-out/log 2>&1; done
  leave 1
}
ip link set lo up
# There is no other network here to wait for.
systemctl mask --now systemd-networkd-wait-online.service systemd-networkd.service systemd-networkd.socket
groupadd --system biteline && useradd --system --gid biteline --home-dir /nonexistent biteline || trouble "no user"
for group in video gpio dialout; do getent group $group >/dev/null || groupadd --system $group; done
mkdir -p /etc/biteline/keys
cp /test/host.env /test/web.env /etc/biteline/
# Where this machine lets no systemd give real-time rights to an ordinary user, the sensor is told.
rt=required
systemd-run --wait --quiet -p User=biteline -p LimitRTPRIO=90 chrt -f 90 true || rt=ignore
echo "RT=$rt" >/etc/biteline/sensor.env
/opt/biteline/biteline-sensor --make-keys /etc/biteline/keys || trouble "no keys of the sensor"
/opt/biteline/biteline keys make --keys /etc/biteline/keys || trouble "no keys of the host"
/opt/biteline/biteline keys allow --keys /etc/biteline/keys here /etc/biteline/keys/host.public || trouble "host not let in"
systemctl start biteline-cell
for i in $(seq 300); do [ -s /run/cell/board.yaml ] && break; sleep 0.2; done
cp /run/cell/sensor.yaml /etc/biteline/ || trouble "no cell"
# On a unit systemd is one of the watchdogs; the unit waits for its first word.
sed 's/systemd: false/systemd: true/' /run/cell/board.yaml >/etc/biteline/board.yaml
chown -R biteline:biteline /etc/biteline
systemctl start biteline-sensor || trouble "biteline-sensor does not start"
systemctl start biteline-host || trouble "biteline-host does not start"
# The first account is made by whoever has the service's control end.
for i in $(seq 100); do
  echo correct-horse-battery | /opt/biteline/biteline-web --add-user anna --role administrator --control tcp://127.0.0.1:7118 >/tmp/account 2>&1 && break
  sleep 0.2
done
systemctl start biteline-web || trouble "biteline-web does not start"
for unit in sensor host web; do
  user=$(ps -o user= -p "$(systemctl show -p MainPID --value biteline-$unit)")
  [ "${user// /}" = biteline ] || trouble "biteline-$unit runs as '$user'"
done
# Without real-time rights the laser's guard may end a scan or two on a busy machine: the service takes the next one.
reports='/var/lib/biteline-host/scan-*/report.json'
for i in $(seq 900); do
  grep -qs '"status": "ok"' $reports && break
  sleep 0.2
done
if ! grep -qs '"status": "ok"' $reports; then
  cut_short=$(grep -ls 'the laser went off' $reports | wc -l)
  [ "$cut_short" -ge 3 ] && leave 77
  trouble "no line"
fi
say "a scan became a line"
api=http://127.0.0.1:8080/api/v1
token=$(curl -sf $api/sessions -H 'Content-Type: application/json' -d '{"name":"anna","password":"correct-horse-battery"}' |
  sed -n 's/.*"token": *"\([^"]*\)".*/\1/p')
[ -n "$token" ] || trouble "no login: $(cat /tmp/account)"
scan=$(basename "$(dirname "$(grep -ls '"status": "ok"' $reports | head -1)")")
# The report is written before the service notes the scan.
for i in $(seq 150); do
  curl -s $api/scans/$scan/files/line.csv -H "Authorization: Bearer $token" -o /tmp/line.csv
  cmp -s /tmp/line.csv /var/lib/biteline-host/$scan/line.csv && break
  sleep 0.2
done
cmp -s /tmp/line.csv /var/lib/biteline-host/$scan/line.csv || trouble "no line from the API: $(head -c 300 /tmp/line.csv)"
say "the API hands it out"
if [ $rt = required ]; then
  sensor=$(systemctl show -p MainPID --value biteline-sensor)
  for thread in bl-safety:70 bl-pose:60 bl-acq:50 bl-stream:40; do
    ps -L -o comm=,cls=,rtprio= -p "$sensor" | grep -qE "^${thread%:*} +FF +${thread#*:}\$" || trouble "$thread is not as urgent"
  done
  say "the sensor has its real-time rights"
else
  say "real-time rights were not tried: this machine gives none to an ordinary user"
fi
for unit in sensor host web; do
  systemctl is-active --quiet biteline-$unit || trouble "biteline-$unit has ended"
  say "biteline-$unit works as an ordinary user: $(systemctl show -p NRestarts --value biteline-$unit) restarts"
done
leave 0
TEXT
binds=()
for file in "$work"/units/*.service "$work"/units/*.target "$work"/units/*.d; do
  binds+=("--bind-ro=$file:/etc/systemd/system/$(basename "$file")")
done
# Alternatives are links through /etc.
systemd-nspawn --machine="$name" --register=no --keep-unit -D / --volatile=yes --private-network --console=read-only \
  --bind-ro=/etc/alternatives --bind-ro="$bin:/opt/biteline" --bind-ro="$work/etc:/test" --bind="$work/out:/test-out" \
  "${binds[@]}" --boot systemd.unit=check.target systemd.firstboot=no </dev/null >"$work/console" 2>&1 &
container=$!
for ((i = 0; i < 600; ++i)); do
  grep -qs '^TEST status' "$work/out/log" && break
  kill -0 "$container" 2>/dev/null || break
  sleep 0.5
done
if ! grep -qs '^TEST' "$work/out/log"; then
  tail -3 "$work/console"
  skip "no systemd starts in a container here"
fi
cat "$work/out/log"
if grep -q '^TEST status 77' "$work/out/log"; then
  skip "without real-time rights this machine is too busy for a whole scan"
fi
grep -q '^TEST status 0' "$work/out/log"
