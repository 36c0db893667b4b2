#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# package.sh FOLDER: packs an arm64 build as a .deb, which must hold program, unit, rules and boards, and depend on the package
# of every library that the program names (as this machine's own packages know them).
set -euo pipefail
[ -e "$1/bin/biteline-sensor" ] || { echo "skipped: no arm64 build in $1"; exit 77; }
cd "$1"
rm -f ./*.deb
cpack -G DEB >cpack.log 2>&1 || { cat cpack.log; exit 1; }
deb=$(echo biteline-firmware_*_arm64.deb)
[ "$(dpkg-deb -f "$deb" Architecture)" = arm64 ]
depends=" $(dpkg-deb -f "$deb" Depends | sed 's/([^)]*)//g; s/,/ /g') "
for library in $(aarch64-linux-gnu-objdump -p bin/biteline-sensor | sed -n 's/^ *NEEDED *//p'); do
  case $library in ld-linux-*) continue ;; esac
  package=$(dpkg -S "*/$library" | sed -n 's/:amd64: .*//p' | head -1)
  case $depends in *" $package "*) ;; *) echo "$deb does not depend on $package ($library)"; exit 1 ;; esac
done
dpkg-deb -c "$deb" > files.log
for file in usr/bin/biteline-sensor lib/systemd/system/biteline-sensor.service lib/udev/rules.d/90-biteline.rules \
  lib/sysusers.d/biteline.conf lib/sysctl.d/90-biteline.conf share/biteline/boards/rpi-cm4/board.yaml; do
  grep -q "$file\$" files.log || { echo "$deb lacks $file"; exit 1; }
done
echo "$deb: $(stat -c %s "$deb") bytes,$depends"
