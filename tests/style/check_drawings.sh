#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# check_drawings.sh ROOT: each drawing of the documents is what its own script draws.
set -euo pipefail
bad=0
for script in "$1"/docs/pictures/*.awk; do
  awk -f "$script" | cmp -s - "${script%.awk}.svg" || { echo "${script#"$1"/}: its .svg is another drawing; docs/pictures/make.sh"; bad=1; }
done
exit $bad
