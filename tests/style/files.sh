# SPDX-License-Identifier: MIT
# Sourced by the checks: where the C++ of the tree is.

# sources ROOT PATTERN...: the tree's own files of these names, sorted, relative to ROOT.
sources() {
  local root=$1 folders=() folder
  shift
  for folder in common hal firmware host tests; do [ -d "$root/$folder" ] && folders+=("$folder"); done
  local names=() pattern
  for pattern in "$@"; do names+=(-o -name "$pattern"); done
  (cd "$root" && find "${folders[@]}" -name node_modules -prune -o -type f \( "${names[@]:1}" \) -print | sort)
}
