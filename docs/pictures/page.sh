#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# page.sh [BUILD]: makes the pictures of the page again (default: build beside the sources; root, chromium).
# The browser test runs the simulated cell and leaves pictures of its views; three are copied here.
# The refused scan is the golden upper, which has no sole: biteline and its result's own page.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=${1:-$here/../../build}
rm -f "$build"/web_pictures/cell_{live,scan,work}_1280.png
ctest --test-dir "$build" -R '^web_cell$' --output-on-failure
for picture in live scan work; do
  if ! cp "$build/web_pictures/cell_${picture}_1280.png" "$here/page_$picture.png"; then
    echo "page.sh: the test was skipped; its own words say why: ctest --test-dir $build -R web_cell -V" >&2
    exit 1
  fi
done
refused=$(mktemp -d)
trap 'rm -rf "$refused"' EXIT
"$build/bin/biteline" extract "$here/../../tests/golden/upper/cloud.ply" --out "$refused" --quiet || [ $? -eq 3 ]
BITELINE_WEB_SOURCE=$here/../../host/web node "$here/refused.mjs" "$refused" "$here/page_refused.png"
ls -l "$here"/page_*.png
