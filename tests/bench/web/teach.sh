#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# teach.sh BUILD SOURCE [SHOE]...: made shoes ("CLASS SEED", or ten of its own) are taught in the page by the clock.
# Each has a cell of its own (root, node, chromium).
# The goal: 60 s and five decisions for a sample that needs no mending.
set -uo pipefail
build=$1
source=$2
shift 2
[ $# -gt 0 ] || set -- 'deep 11' 'deep 12' 'step 13' 'step 14' 'stitched 15' 'glossy 16' 'cupsole 17' 'midsole 18' 'welted 19' 'boot 20'
node=$(command -v node) || { echo 'skipped: no node'; exit 77; }
failed=0
for shoe in "$@"; do
  # shellcheck disable=SC2086
  BITELINE_WEB_SOURCE="$source/host/web" "$source/tests/web/in_own_network.sh" "$node" "$source/tests/web/teach_test.mjs" \
    "$build/bin" "$source" "$build/web_pictures" $shoe
  status=$?
  [ "$status" -eq 0 ] && continue
  echo "$shoe: ended with $status"
  [ "$status" -eq 77 ] || failed=1
done
exit "$failed"
