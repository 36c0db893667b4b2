#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# rules_test.sh RULES ALARMS: the shipped alarms as Prometheus itself reads them, and what they make of made days;
# spoiled ones must be found.
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
