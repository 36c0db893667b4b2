#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The count of the safety functions must be green on a small tree and red on each seeded violation.
set -u
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failed=0
faults=$tree/tests/integration/faults
docs=$tree/docs
mkdir -p "$faults" "$docs"

clean() {
  cat >"$faults/laser_test.cpp" <<'CODE'
TEST(Laser, DoorThatOpens) {}
ORDINARY_TIMED_TEST(Arm, BesideThePath) {}
TEST_GROUP(Gate) {};
CODE
  cat >"$faults/README.md" <<'TABLE'
| fault | laser | says | recovery | test |
| --- | --- | --- | --- | --- |
| door | off | so | next scan | `DoorThat...` |
| lost frame | on | so | none | `DoorThatOpens` |
TABLE
  cat >"$faults/ROBOT.md" <<'TABLE'
| fault | reason_code | noticed | exit | test |
| --- | --- | --- | --- | --- |
| beside | `off_path` | first state | 3 | `BesideThePath` |
| tool stays on | `tool_on` | 0.5 s | 4 | `Gate` (each row) |
| too old | the gate's row | before sending | 3 | `Gate`, `laser_test` |
| one no | asked again | - | - | `BesideThePath` |
TABLE
  cat >"$docs/safety-functions.md" <<'TEXT'
# Safety functions

<!-- counted by safety_functions.py -->
<!-- end -->

## What nothing finds

| function | failure | why | do |
| --- | --- | --- | --- |
| L | a | b | c |
| A | a | b | c |
| T | a | b | c |
| G | a | b | c |

## Else

| L | not | a | failure |
TEXT
  python3 "$here/safety_functions.py" "$tree" --write >"$tree/said" || { echo "a clean tree: $(cat "$tree/said")"; failed=1; }
  grep -q '| L | .* | 1 | 1 | 1 | 50 % | none |' "$docs/safety-functions.md" || { echo "other figures than counted by hand"; failed=1; }
}
# red WORDS: what was just done is found and told so.
red() {
  if python3 "$here/safety_functions.py" "$tree" >"$tree/said"; then
    echo "green although: $1"
    failed=1
  elif ! grep -q "$1" "$tree/said"; then
    echo "expected '$1', said: $(cat "$tree/said")"
    failed=1
  fi
}

clean
sed -i 's/50 %/99 %/' "$docs/safety-functions.md"
red 'other figures'
clean
sed -i '/^## What nothing finds/,/^## Else/s/^| L .*/&\n| L | one more | b | c |/' "$docs/safety-functions.md"
red 'other figures'
clean
sed -i 's/BesideThePath/Renamed/' "$faults/laser_test.cpp"
red 'names BesideThePath, and there is no such test'
clean
sed -i 's/`DoorThat...`/by hand/' "$faults/README.md"
red 'names no test'
clean
sed -i '/^| tool stays on/d' "$faults/ROBOT.md"
red 'a table was not read'
exit $failed
