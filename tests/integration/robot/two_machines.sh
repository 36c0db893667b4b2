#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# two_machines.sh BIN ROOT: two services on two machines (network namespaces, each with a wire of its own to the robot's) want one
# arm: the second is refused by the controller's own word, and gets the arm once the first is gone.  Skipped by name where no
# such networks can be made.
set -euo pipefail
skip() { echo "skipped: $1"; exit 77; }
bin=$1 root=$2
[ "$(id -u)" -eq 0 ] || skip "networks need root"
for tool in unshare nsenter ip python3; do command -v $tool >/dev/null || skip "no $tool"; done
if [ "${3:-}" != robot ]; then
  unshare --net --mount true 2>/dev/null || skip "no namespaces here"
  exec unshare --net --mount "$0" "$bin" "$root" robot
fi
# This is the robot's machine.
ip link set lo up
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-machines-XXXXXX")
started=()
finish() {
  for process in "${started[@]}"; do kill -KILL "$process" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$work"
}
trap finish EXIT
trouble() { echo "$1"; tail -n 5 "$work"/*.out; exit 1; }

"$bin/biteline-cell" serve --seed 2 --arm ur5e --out "$work/cell" >"$work/cell.out" 2>&1 &
started+=($!)
for _ in $(seq 600); do
  grep -q '"rtde"' "$work/cell.out" && break
  sleep 0.1
done
port() { sed -n "s/.*\"$1\":\"127.0.0.1:\([0-9]*\)\".*/\1/p" "$work/cell.out" | head -1; }
[ -n "$(port rtde)" ] || trouble "no cell"

# The robot's own address, reached over either wire; its simulated controller listens on loopback only.
ip address add 10.77.0.1/32 dev lo
python3 - "$(port rtde)" "$(port script)" "$(port dashboard)" <<'PY' >"$work/relay.out" 2>&1 &
import socket, sys, threading

def pump(source, sink):
    try:
        while data := source.recv(65536):
            sink.sendall(data)
    except OSError:
        pass
    for end in (source, sink):
        try:
            end.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass

def serve(listener, port):
    while True:
        client = listener.accept()[0]
        controller = socket.create_connection(("127.0.0.1", port))
        for ends in ((client, controller), (controller, client)):
            threading.Thread(target=pump, args=ends, daemon=True).start()

threads = []
for outside, inside in zip((30004, 30002, 29999), map(int, sys.argv[1:])):
    threads.append(threading.Thread(target=serve, args=(socket.create_server(("10.77.0.1", outside)), inside)))
    threads[-1].start()
print("ready", flush=True)
PY
started+=($!)

# machine NAME NUMBER: a network with one wire to here.  Its first process stands for the machine.
declare -A machine
machine() {
  unshare --net sleep infinity &
  machine[$1]=$!
  started+=($!)
  until [ "$(readlink "/proc/${machine[$1]}/ns/net")" != "$(readlink /proc/self/ns/net)" ]; do sleep 0.05; done
  ip link add "to-$1" type veth peer name wire netns "${machine[$1]}" || skip "no pairs of network devices (veth)"
  ip address add "10.77.$2.1/24" dev "to-$1"
  ip link set "to-$1" up
  nsenter --net="/proc/${machine[$1]}/ns/net" sh -c \
    "ip link set lo up && ip address add 10.77.$2.2/24 dev wire && ip link set wire up && ip route add 10.77.0.1 via 10.77.$2.1"
}
machine left 1
machine right 2

# service MACHINE LOG: a service that wants the arm; the folder where machines keep their locks is each one's own, too.
service() {
  mkdir -p "$work/$2"
  nsenter --net="/proc/${machine[$1]}/ns/net" unshare --mount bash -c \
    'mount -t tmpfs none /run/lock && exec "$@"' bash \
    "$bin/biteline-host" --sensor tcp://127.0.0.1:1 --out "$work/$2" --robot UR5e --table-z 0 \
    --process "$root/host/robot/path/processes/grind.yaml" --rtde 10.77.0.1:30004 --script 10.77.0.1:30002 \
    --dashboard 10.77.0.1:29999 --send >"$work/$2.out" 2>&1 &
  last=$!
  started+=("$last")
}
holds() {
  for _ in $(seq 600); do
    grep -q 'holds the arm at 10.77.0.1' "$work/$1.out" && return 0
    kill -0 "$last" 2>/dev/null || return 1
    sleep 0.1
  done
  return 1
}
service left first
holds first || trouble "the first service does not get the arm"
holder=$last
service right second
status=0
wait "$last" || status=$?
[ $status -eq 4 ] || trouble "the second service ended with $status"
grep -q 'another service holds this arm' "$work/second.out" || trouble "the second service does not say why"
kill -0 "$holder" || trouble "the first service has ended"
kill -KILL "$holder"
service right third
holds third || trouble "the arm of a dead service is not free"
echo "refused on the second machine: $(grep 'another service' "$work/second.out")"
