#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# host_packages.sh BUILD: a cell's and a centre's programs, and the library, as packages; installed in a bare Debian 12 folder.
# The programs run there as an ordinary user, an upgrade keeps what was taught and settings that a person wrote, and a purge leaves
# the memory.  Two strangers' programs, one of C++ and one of Python, are made with the library's packages alone.
set -euo pipefail
build=$1
tests=$(dirname "$(dirname "$(readlink -f "$0")")")
skip() { echo "skipped: $1"; exit 77; }
bad() { echo "$1"; exit 1; }
[ "$(id -u)" -eq 0 ] || skip "a bare folder needs root"
command -v debootstrap >/dev/null || skip "no debootstrap"
[ -e "$build/share/biteline/web/app.js" ] || skip "the page was not built"
grep -q 'fsanitize' "$build/CMakeCache.txt" && skip "a build with sanitizers"
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-packages-XXXXXX")
root=$work/root
finish() {
  for place in proc dev/null; do ! mountpoint -q "$root/$place" || umount "$root/$place"; done
  rm -rf "$work"
}
trap finish EXIT

(cd "$build" && cpack -G DEB -B "$work/packages") >"$work/cpack.log" 2>&1 ||
  { tail -20 "$work/cpack.log"; exit 1; }
host=$(echo "$work"/packages/biteline-host_*.deb) web=$(echo "$work"/packages/biteline-web_*.deb)
gige=$(echo "$work"/packages/biteline-gige_*.deb)
libraries=$(echo "$work"/packages/libbiteline*.deb "$work"/packages/python3-biteline_*.deb)
uplink=$(echo "$work"/packages/biteline-uplink_*.deb) fleet=$(echo "$work"/packages/biteline-fleet_*.deb)
# holds DEB FILE...: each is in it.
holds() {
  local deb=$1 file
  dpkg-deb -c "$deb" >"$work/files"
  shift
  for file in "$@"; do grep -q "$file\$" "$work/files" || bad "$deb lacks $file"; done
}
holds "$host" usr/bin/biteline usr/bin/biteline-host usr/share/biteline/processes/grind.yaml usr/share/biteline/web/viewer.js \
  usr/share/biteline/reader/biteline_scan.hpp usr/share/biteline/reader/biteline_scan.py usr/share/biteline/reader/read_live.cpp \
  usr/lib/systemd/system/biteline-host.service usr/lib/sysusers.d/biteline-host.conf usr/share/doc/biteline/LICENSE \
  usr/share/doc/biteline/docs/pictures/section.svg usr/share/man/man1/biteline.1.gz usr/share/man/man1/biteline-host.1.gz \
  usr/share/bash-completion/completions/biteline etc/biteline/host.env
holds "$web" usr/bin/biteline-web usr/share/biteline/web/app.js usr/share/biteline/web/centre/index.html usr/share/biteline/openapi.yaml usr/share/man/man1/biteline-web.1.gz \
  usr/lib/systemd/system/biteline-web.service etc/biteline/web.env
holds "$gige" usr/bin/biteline-gige usr/share/man/man1/biteline-gige.1.gz usr/lib/systemd/system/biteline-gige.service \
  usr/lib/sysusers.d/biteline-gige.conf etc/biteline/gige.env
holds "$uplink" usr/bin/biteline-uplink usr/share/man/man1/biteline-uplink.1.gz usr/lib/systemd/system/biteline-uplink.service \
  usr/lib/sysusers.d/biteline-uplink.conf etc/biteline/uplink.env
holds "$fleet" usr/bin/biteline-fleet usr/share/man/man1/biteline-fleet.1.gz usr/lib/systemd/system/biteline-fleet.service \
  usr/lib/sysusers.d/biteline-fleet.conf etc/biteline/fleet.env usr/share/biteline/migrations/0001_cells_and_shoes.sql \
  usr/share/biteline/migrations/0002_releases.sql usr/share/biteline/migrations/0003_switch_cells.sql usr/share/biteline/migrations/0004_fetches.sql \
  usr/share/biteline/migrations/0005_signed_switches.sql usr/share/biteline/migrations/0006_kept_recordings.sql usr/share/biteline/migrations/0007_refused_orders.sql \
  usr/share/biteline/migrations/0008_dead_letters.sql usr/share/biteline/migrations/0009_factory_day.sql usr/share/biteline/migrations/0010_shoe_numbers.sql usr/share/biteline/migrations/0012_log_links.sql \
  usr/share/biteline/broker/mosquitto.conf usr/share/biteline/broker/acl usr/share/biteline/prometheus/board.json usr/share/biteline/prometheus/prometheus.yml usr/share/biteline/prometheus/rules.yml \
  usr/share/doc/biteline-fleet/LICENSE
for deb in "$host" "$web" "$gige" "$uplink" "$fleet"; do holds "$deb" usr/share/doc/biteline-[a-z]*/{sbom.cdx.json,notices.gz}; done
for deb in "$work"/packages/*.deb; do holds "$deb" usr/share/doc/[a-z0-9-]*/{copyright,changelog.gz}; done
# Somebody else's code in the page comes with its licence.
dpkg-deb --fsys-tarfile "$web" | tar -xO ./usr/share/doc/biteline-web/notices.gz | gzip -d >"$work/notices"
for part in preact three uplot nlohmann-json3-dev; do
  grep -q "^== $part [0-9]" "$work/notices" || bad "biteline-web has no notice of $part"
done
twice=$(for deb in "$work"/packages/*.deb; do dpkg-deb -c "$deb" | awk '!/\/$/ {print $6}'; done | sort | uniq -d)
[ -z "$twice" ] || bad "in more than one package: $twice"
! dpkg-deb -f "$host" Depends | grep -q biteline || bad "biteline-host depends on itself"

debootstrap --variant=minbase bookworm "$root" >"$work/debootstrap.log" 2>&1 || skip "no bare folder: $(tail -1 "$work/debootstrap.log")"
mount -t proc proc "$root/proc"
in_root() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive HOME=/tmp "$@"; }
cp "$host" "$web" "$gige" "$uplink" "$fleet" "$root/tmp/"
in_root apt-get update -qq
in_root sh -c 'apt-get install -y -qq --no-install-recommends /tmp/biteline-*.deb' >"$work/install.log" 2>&1 ||
  { tail -20 "$work/install.log"; exit 1; }

# Two strangers, who have the library's packages and a compiler: both find the same line.
cp $libraries "$tests"/library/stranger.{cpp,py} "$tests/golden/sample/cloud.ply" "$root/tmp/"
in_root sh -c 'apt-get install -y -qq --no-install-recommends /tmp/libbiteline*.deb /tmp/python3-biteline_*.deb g++ pkg-config' \
  >"$work/install.log" 2>&1 || { tail -20 "$work/install.log"; exit 1; }
in_root sh -c 'cd /tmp && g++ -std=c++20 stranger.cpp -o stranger $(pkg-config --cflags --libs biteline)' || bad "a stranger's program is not built"
compiled=$(in_root /tmp/stranger /tmp/cloud.ply) && scripted=$(in_root python3 /tmp/stranger.py /tmp/cloud.ply) || bad "a stranger's program fails"
[[ $compiled =~ ^[0-9.]+\ [0-9.]+$ && $compiled == "$scripted" ]] || bad "two strangers found '$compiled' and '$scripted'"

# An ordinary user, to whom the programs' folder is read-only.
in_root useradd -m anna
as_anna() { in_root su anna -c "$1"; }
version=$(dpkg-deb -f "$host" Version)
for program in biteline biteline-host biteline-web biteline-gige biteline-uplink biteline-fleet; do
  as_anna "$program --version" | grep -q "${version%%-*}" || bad "$program tells another version than $version"
done
as_anna 'biteline plan --help >/dev/null'
as_anna 'mkdir /tmp/out && printf "a long password\n" | biteline-web --add-user ada --role administrator --out /tmp/out'
as_anna 'biteline-host --out /tmp/out --library /tmp/models --backup /tmp/cell.tar' | grep -q 'memory, 0 models' || bad "no backup"
# Nothing listens here: each says in one line whom it misses.  The tables' versions are found where they were installed.
as_anna 'timeout 3 biteline-uplink --results /tmp/out --cell cell-1 --broker mqtt://127.0.0.1:9 2>&1' >"$work/said" || [ $? -eq 124 ]
grep -q '^biteline-uplink: .*broker 127.0.0.1 port 9' "$work/said" || bad "biteline-uplink said: $(cat "$work/said")"
as_anna 'biteline-fleet --list --database "host=127.0.0.1 port=9" 2>&1' >"$work/said" && bad "a list without a database"
grep -q '^biteline-fleet: .*database' "$work/said" || bad "biteline-fleet said: $(cat "$work/said")"
# Its page, whole, without a service behind it.
as_anna 'biteline-web --listen 127.0.0.1:8089 --control tcp://127.0.0.1:9 >/tmp/web.log 2>&1 & echo $!' >"$work/pid"
for turn in $(seq 100); do
  page=$(in_root bash -c 'exec 3<>/dev/tcp/127.0.0.1/8089 && printf "GET /app.js HTTP/1.0\r\nHost: localhost\r\n\r\n" >&3 && cat <&3 | head -1' 2>/dev/null) && break
  sleep 0.2
done
kill "$(cat "$work/pid")"
case $page in *" 200 "*) ;; *) bad "the page's program said '$page' in turn $turn" ;; esac
in_root bash -c 'source /usr/share/bash-completion/completions/biteline; COMP_WORDS=(biteline mod); COMP_CWORD=1; _biteline; [ "${COMPREPLY[*]}" = model ]' ||
  bad "the completion does not know model"

# What a person wrote and what the cell was taught outlive upgrade and purge.
echo 'BITELINE_HOST_OPTIONS=--sensor tcp://192.0.2.1:7117' >"$root/etc/biteline/host.env"
mkdir -p "$root/var/lib/biteline-host" && echo kept >"$root/var/lib/biteline-host/memory.sqlite"
in_root sh -c 'dpkg -i /tmp/biteline-host_*.deb' >/dev/null 2>&1
grep -q 192.0.2.1 "$root/etc/biteline/host.env" || bad "an upgrade overwrote host.env"
in_root dpkg --purge biteline-host biteline-web biteline-gige biteline-uplink biteline-fleet >"$work/purge.log" 2>&1
grep -q 'remove it by hand' "$work/purge.log" || bad "the purge says nothing of the memory"
grep -q 'the database stays' "$work/purge.log" || bad "the purge says nothing of the database"
for left in etc/biteline/uplink.env etc/biteline/fleet.env usr/bin/biteline-uplink usr/bin/biteline-fleet usr/share/biteline; do
  [ ! -e "$root/$left" ] || bad "the purge left $left"
done
[ -e "$root/var/lib/biteline-host/memory.sqlite" ] && [ ! -e "$root/etc/biteline/host.env" ] && [ ! -e "$root/usr/bin/biteline" ] ||
  bad "the purge took the memory, or left programs or settings"
echo "$(basename "$host"): $(stat -c %s "$host") bytes; $(basename "$web"): $(stat -c %s "$web") bytes; $(basename "$uplink"): $(stat -c %s "$uplink") bytes;
$(basename "$fleet"): $(stat -c %s "$fleet") bytes; installed, run, upgraded, purged"
