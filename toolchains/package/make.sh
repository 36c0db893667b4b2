#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# make.sh BUILD: every package of what was built there, into BUILD/packages, each checked by lintian where it is installed.
# Exit 1 when lintian has an error or a warning.
set -euo pipefail
build=$1
rm -rf "$build/packages"
(cd "$build" && cpack -G DEB -B packages) >"$build/packages.log" 2>&1 || { tail -20 "$build/packages.log" >&2; exit 1; }
# What CPack unpacked on its way.
rm -rf "$build/packages/_CPack_Packages"
(cd "$build/packages" && sha256sum -- *.deb | tee SHA256SUMS)
command -v lintian >/dev/null || { echo "package: no lintian: install it to have the packages checked" >&2; exit 0; }
root=()
[ "$(id -u)" -ne 0 ] || root=(--allow-root)
lintian "${root[@]}" --fail-on error,warning "$build"/packages/*.deb
