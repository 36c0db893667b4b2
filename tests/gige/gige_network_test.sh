#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# gige_network_test.sh FACE SENSOR SESSION: two machines on one cable, made of network namespaces: the face is found by broadcast, answers
# only those it is told, and is refused where another GigE Vision device answers.  As an ordinary user, like the unit.
set -euo pipefail
face=$1 sensor=$2 session=$3
skip() { echo "skipped: $1"; exit 77; }
bad() { echo "$1"; exit 1; }
[ "$(id -u)" -eq 0 ] || skip "network namespaces need root"
if [ -z "${BITELINE_OWN_NETWORK:-}" ]; then
  unshare --net true 2>/dev/null || skip "no network namespaces here"
  BITELINE_OWN_NETWORK=1 exec unshare --net -- "$0" "$@"
fi
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-cable-XXXXXX")
started=()
finish() {
  for pid in "${started[@]}"; do kill "$pid" 2>/dev/null || true; done
  rm -rf "$work"
}
trap finish EXIT
# The other machine lives as long as this process in it.
unshare --net sleep 300 &
other=$!
started+=("$other")
ip link set lo up
for turn in $(seq 50); do [ "$(readlink /proc/$other/ns/net)" != "$(readlink /proc/self/ns/net)" ] && break || sleep 0.1; done
ip link add here type veth peer name there netns $other 2>"$work/told" || skip "no cable: $(cat "$work/told")"
ip address add 10.9.0.1/24 broadcast 10.9.0.255 dev here && ip link set here up
# No function: what is started is then the program itself, which can be ended.
on_other=(nsenter "--net=/proc/$other/ns/net" --)
"${on_other[@]}" ip address add 10.9.0.2/24 broadcast 10.9.0.255 dev there && "${on_other[@]}" ip link set there up && "${on_other[@]}" ip link set lo up
# Where that user may reach it.
chmod 755 "$work" && cp "$face" "$work/biteline-gige" && face=$work/biteline-gige
as_user=(setpriv --reuid=65534 --regid=65534 --clear-groups --no-new-privs)

# start OUT COMMAND...: in the background, until it has said a line.
start() {
  local out=$1
  shift
  "$@" >"$out" 2>"$out.fault" &
  started+=($!)
  for turn in $(seq 100); do [ -s "$out" ] && return 0 || sleep 0.1; done
  bad "$*: $(cat "$out.fault")"
}
start "$work/sensor" "${on_other[@]}" "$sensor" --source "replay:$session"
endpoint=$(sed 's/.*"endpoint":"\([^"]*\)".*/\1/' "$work/sensor")
start "$work/face" "${on_other[@]}" "${as_user[@]}" "$face" --sensor "$endpoint" --interface there --camera 192.168.40.2 --client 10.9.0.1 --serial 77

# Found by everybody's broadcast and by the network's own, with what it tells of itself.
found() {
  python3 - "$1" "$2" <<'TEXT'
import socket, sys
asking = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
asking.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
asking.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, b"here")
asking.bind((sys.argv[1], 0))
asking.settimeout(2)
asking.sendto(bytes.fromhex("4211000200000001"), (sys.argv[2], 3956))
try:
    answer, where = asking.recvfrom(1024)
except TimeoutError:
    sys.exit(1)
assert where[0] == "10.9.0.2" and answer[8 + 0xD8 :][:3] == b"77\0", (where, answer)
assert answer[8 + 0x24 :][:4] == bytes([10, 9, 0, 2]) and any(answer[8 + 0xA :][:6])
TEXT
}
for place in 255.255.255.255 10.9.0.255 10.9.0.2; do
  found 10.9.0.1 $place || bad "not found by $place"
done
ip address add 10.9.0.9/24 broadcast 10.9.0.255 dev here
for place in 10.9.0.255 10.9.0.2; do
  found 10.9.0.9 $place && bad "a stranger is answered at $place"
done

# Here it would stand beside that device, which might be the camera.
status=0
"${as_user[@]}" "$face" --sensor "$endpoint" --interface here --client 10.9.0.2 >"$work/told" 2>&1 || status=$?
[ $status -eq 2 ] && grep -q 'a GigE Vision device answers at 10.9.0.2 on here' "$work/told" || bad "not refused: $status $(cat "$work/told")"
status=0
"${as_user[@]}" "$face" --sensor "$endpoint" --interface here --client 10.9.0.2 --camera 10.9.0.2 >"$work/told" 2>&1 || status=$?
[ $status -eq 2 ] && grep -q 'reaches the camera at 10.9.0.2' "$work/told" || bad "not refused: $status $(cat "$work/told")"
status=0
"${as_user[@]}" "$face" --sensor "$endpoint" --interface here --camera 192.168.40.2 >"$work/told" 2>&1 || status=$?
[ $status -eq 2 ] && grep -q 'name who may connect' "$work/told" || bad "no client, and not refused: $status $(cat "$work/told")"
echo "found by broadcast, silent to strangers, refused beside another device; as an ordinary user"
