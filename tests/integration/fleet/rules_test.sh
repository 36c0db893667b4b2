#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# rules_test.sh RULES: the shipped alarms as Prometheus itself reads them; a spoiled one must be found.
set -euo pipefail
command -v promtool >/dev/null || { echo "skipped: no promtool (Debian's prometheus)"; exit 77; }
promtool check rules "$1"
spoiled=$(mktemp)
trap 'rm -f "$spoiled"' EXIT
sed 's/expr: biteline_fleet_database_up == 0/expr: biteline_fleet_database_up ==/' "$1" >"$spoiled"
! promtool check rules "$spoiled" >/dev/null 2>&1 || { echo "promtool takes a rule without a right side"; exit 1; }
