#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# make.sh [BIN [OUT]]: makes the golden set again, with the simulated cell in BIN (default: build/bin).
# Same program, same files; another compiler's last digits may differ.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bin=${1:-$here/../../build/bin}
out=${2:-$here}

# A child's shoe: small enough for whole clouds below 1 MB.
shoe=(--shoe deep --seed 8 --within-reach-of ur5e)

rm -rf "$out/part" "$out/sample" "$out/upper" "$out/head"
"$bin/biteline-cell" record "${shoe[@]}" --from-mm 120 --length-mm 8 --out "$out/part"
# Coarser than a scan (1 mm, 0.07 mm), for the size of the files.
"$bin/biteline-cell" record-cloud "${shoe[@]}" --profile-step-mm 1.2 --column-step-mm 0.4 --out "$out/sample"
"$bin/biteline-cell" record-cloud "${shoe[@]}" --upper --place 9 --profile-step-mm 1.2 --column-step-mm 0.4 \
  --out "$out/upper"
# Means of many exposures: pictures without noise pack well.
"$bin/biteline-cell" record-calibration --head 5 --seed 3 --camera-views 4 --laser-views 3 --handeye-views 4 \
  --averaged 1000 --out "$out/head"
du -sh "$out"/*/
find "$out" -type f -size +1000k -exec ls -l {} +
