#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# services.sh ROOT: systemd's own measure of what a service may do is at most 3.0 of 10, with every board's drop-in, and
# no unit opens raw packets.
set -euo pipefail
command -v systemd-analyze >/dev/null || { echo "skipped: no systemd-analyze"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-services-XXXXXX")
trap 'rm -rf "$work"' EXIT
bad=0

# measure NAME FILE...: the unit as systemd puts it together, later files over earlier ones.
measure() {
  local name=$1 unit=$work/${1##*/}
  shift
  # The program is looked for on this machine.
  cat "$@" | sed 's#^ExecStart=[^ ][^ ]*#ExecStart=/bin/true#' >"$unit"
  if ! systemd-analyze security --offline=true --no-pager --threshold=30 "$unit" >"$work/log" 2>&1; then
    echo "$name: $(grep -F 'Overall exposure' "$work/log" || tail -1 "$work/log")"
    bad=1
  fi
  if grep -E '^(RestrictAddressFamilies|AmbientCapabilities|CapabilityBoundingSet)=.*(AF_PACKET|CAP_NET_RAW)' "$unit"; then
    echo "$name: raw packets"
    bad=1
  fi
}

sensor=$1/boards/common/systemd/biteline-sensor.service
measure sensor.service "$sensor"
count=2
for drop_in in "$1"/boards/*/systemd/biteline-sensor.service.d/*.conf; do
  board=${drop_in#"$1"/boards/}
  measure "sensor-${board%%/*}.service" "$sensor" "$drop_in"
  count=$((count + 1))
done
measure sensor-update.service "$sensor" "$1/firmware/update/systemd/biteline-update.conf"
measure host.service "$1/host/apps/biteline-host/systemd/biteline-host.service"
measure web.service "$1/host/apps/biteline-web/systemd/biteline-web.service"
for name in uplink fleet gige; do
  measure $name.service "$1/host/apps/biteline-$name/systemd/biteline-$name.service"
done
count=$((count + 5))
for name in host web uplink fleet gige; do
  SYSTEMD_LOG_LEVEL=warning systemd-analyze verify "$work/$name.service" >"$work/log" 2>&1 || true
  if grep "$work" "$work/log"; then bad=1; fi
done
[ $bad -eq 0 ] && echo "$count services"
exit $bad
