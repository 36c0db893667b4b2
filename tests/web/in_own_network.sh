#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# in_own_network.sh COMMAND...: with a loopback of its own, as the camera's port is fixed and other cells may run here.
set -euo pipefail
if ! unshare -n true 2>/dev/null; then
  echo "skipped: a network namespace needs root"
  exit 77
fi
exec unshare -n bash -c 'ip link set lo up && exec "$@"' bash "$@"
