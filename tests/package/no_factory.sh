#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# no_factory.sh SOURCE: without BITELINE_BUILD_FACTORY the tree is configured where neither broker nor database libraries are
# found, and nothing of the factory's programs is built or packed.
set -euo pipefail
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-no-factory-XXXXXX")
trap 'rm -rf "$work"' EXIT
# pkg-config that does not know what the factory alone needs.
cat >"$work/pkg-config" <<'SCRIPT'
#!/usr/bin/env bash
for word in "$@"; do case $word in libmosquitto* | libpqxx* | libpq*) exit 1 ;; esac; done
exec pkg-config "$@"
SCRIPT
chmod +x "$work/pkg-config"
configure() { cmake -S "$source" -B "$work/$1" -G Ninja -DPKG_CONFIG_EXECUTABLE="$work/pkg-config" "${@:2}" >"$work/log" 2>&1; }
source=$1
configure off -DBITELINE_BUILD_FACTORY=OFF -DCMAKE_DISABLE_FIND_PACKAGE_PostgreSQL=ON || { tail -20 "$work/log"; exit 1; }
ninja -C "$work/off" -t targets all >"$work/targets"
grep -q '^bin/biteline-host:' "$work/targets" || { echo "no biteline-host: this test sees nothing"; exit 1; }
! grep -E 'host/(fleet|interfaces/gige)/|biteline-(fleet|uplink|gige)\b' "$work/targets" || { echo "something of the factory is built"; exit 1; }
! grep -E 'COMPONENTS_ALL.*(fleet|uplink|gige)' "$work/off/CPackConfig.cmake" || { echo "something of the factory is packed"; exit 1; }
# It is a test only if the same machine is refused where the factory is asked for.
! configure on || { echo "the factory is configured without its libraries"; exit 1; }
grep -q libmosquitto "$work/log"
