#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# rules_test.sh RULES ALARMS BOARD SCRAPES: the shipped alarms as Prometheus itself reads them, and what they make of made days;
# what the shipped board asks for; what the shipped settings read.  Spoiled ones must be found.
set -euo pipefail
command -v promtool >/dev/null || { echo "skipped: no promtool (Debian's prometheus)"; exit 77; }
promtool check rules "$1"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sed 's/expr: biteline_fleet_database_up == 0/expr: biteline_fleet_database_up ==/' "$1" >"$work/broken.yml"
! promtool check rules "$work/broken.yml" >/dev/null 2>&1 || { echo "promtool takes a rule without a right side"; exit 1; }
days() {
  sed "s|RULES|$1|" "$2" >"$work/days.yml"
  promtool test rules "$work/days.yml"
}
days "$(realpath "$1")" "$2"
sed 's/cell_waiting > 100/cell_waiting > 101/' "$1" >"$work/late.yml"
! days "$work/late.yml" "$2" >/dev/null 2>&1 || { echo "an alarm that comes too late is not found"; exit 1; }

# Each question of the board as a rule, so that Prometheus reads it; each panel has its place, and none lies on another.
questions() {
  python3 - "$1" <<'BOARD'
import json, sys
board = json.load(open(sys.argv[1]))
places = [(panel["gridPos"]["x"] + x, panel["gridPos"]["y"] + y) for panel in board["panels"] for x in range(panel["gridPos"]["w"])
          for y in range(panel["gridPos"]["h"])]
if len(set(places)) != len(places) or max(x for x, _ in places) > 23 or len({panel["id"] for panel in board["panels"]}) != len(board["panels"]):
    sys.exit("two panels of one place or number, or one beyond the edge")
names = {"$" + one["name"] for one in board["templating"]["list"]}
print("groups: [{name: board, rules: [")
for number, target in enumerate(target for panel in board["panels"] for target in panel["targets"]):
    if target["datasource"]["uid"] != "${source}" or "$source" not in names or "$cell" not in names:
        sys.exit("a question to nobody")
    print(" " + json.dumps({"record": f"board:{number}", "expr": target["expr"].replace("$cell", ".+")}) + ",")
print("]}]")
BOARD
}
questions "$3" >"$work/board.yml"
promtool check rules "$work/board.yml"
sed 's/\[1h\]/[1x]/' "$work/board.yml" >"$work/broken.yml"
! promtool check rules "$work/broken.yml" >/dev/null 2>&1 || { echo "promtool takes a board's question without an end"; exit 1; }

# The shipped settings, with this test's files for a factory's own.
touch "$work/biteline-fleet.token" "$work/biteline-cells.token"
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout "$work/key.pem" -out "$work/biteline-ca.pem" -days 2 -subj /CN=ca 2>/dev/null
sed "s|/etc/prometheus|$work|; s|/usr/share/biteline/prometheus/rules.yml|$(realpath "$1")|" "$4" >"$work/prometheus.yml"
promtool check config "$work/prometheus.yml"
sed 's/credentials_file/credential_file/' "$work/prometheus.yml" >"$work/broken.yml"
! promtool check config "$work/broken.yml" >/dev/null 2>&1 || { echo "promtool takes a word that is none"; exit 1; }
