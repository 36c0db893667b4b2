#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# make.sh [BIN]: makes the pictures of the documents again, with the programs in BIN (default: build/bin).
# A sample and an upper of the simulated cell are recorded, worked out, and their pictures copied here.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bin=${1:-$here/../../build/bin}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for drawing in section check_lap laser_class second_look sensor_bracket sensor_wiring; do awk -f "$here/$drawing.awk" >"$here/$drawing.svg"; done

# The rate keeps the profiles some 1.4 mm apart: enough for a picture, and a minute's work.
"$bin/biteline-cell" record --seed 5 --shoe deep --rate-hz 70 --out "$work/sample-session"
"$bin/biteline-cell" record --seed 5 --shoe deep --upper --place 6 --rate-hz 70 --out "$work/upper-session"
"$bin/biteline" replay "$work/sample-session" --out "$work/sample" --quiet
# An upper has no groove: its cloud is what is wanted, and the refusal (exit status 3) is right.
"$bin/biteline" replay "$work/upper-session" --out "$work/upper" --quiet || [ $? -eq 3 ]
"$bin/biteline" transfer --sample "$work/sample" --upper "$work/upper/cloud.ply" --out "$work/carried" --quiet
"$bin/biteline-cell" record-cloud --seed 5 --shoe boot --size 42 --within-reach-of ur10e --out "$work/boot"
"$bin/biteline" extract "$work/boot/cloud.ply" --out "$work/boot-line" --quiet
"$bin/biteline" plan "$work/boot-line/line.csv" --robot UR10e --process "$here/../../host/robot/path/processes/cement.yaml" --out "$work/path" --quiet
/usr/bin/python3 "$here/shoe_line_tool.py" "$work/boot-line" "$work/path" >"$here/shoe_line_tool.svg"

for picture in 1_point_cloud 2_feature_points unrolled_curvature 6_sequence; do
  cp "$work/sample/stages/$picture.png" "$here/"
done
for picture in 1_alignment 3_carried_line; do cp "$work/carried/stages/$picture.png" "$here/"; done
ls -l "$here"/*.png
