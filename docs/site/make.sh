#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# make.sh OUT: the documents' site in OUT, and the pages of the public headers in OUT/headers.  A warning is an error.
set -euo pipefail
out=$(realpath -m "${1:?usage: make.sh OUT}")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
for program in mkdocs doxygen; do
  command -v "$program" >/dev/null || { echo "docs: no $program: install the packages under [docs] of toolchains/debian-12.packages"; exit 77; }
done
if [ -e "$out" ] && [ ! -e "$out/.biteline-docs" ]; then
  echo "docs: $out is there and is no site of before: name another folder"
  exit 2
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 "$here/stage.py" "$root" "$work/pages"
python3 "$here/api_page.py" "$root/host/web/openapi.yaml" "$work/pages/docs/api.md"
version=$(sed -n 's/^project(biteline VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")
sed "s|^site_name:.*|site_name: Biteline $version|" "$here/mkdocs.yml" >"$work/mkdocs.yml"
printf 'docs_dir: %s\nsite_dir: %s\n' "$work/pages" "$work/site" >>"$work/mkdocs.yml"
mkdocs build --quiet --strict --config-file "$work/mkdocs.yml"
# Files have no server that shows it.
rm "$work/site/404.html"

headers=$root/host/library/include
[ -d "$headers" ] || headers=$root/host/records/reader
{
  cat "$here/Doxyfile"
  printf 'PROJECT_NUMBER = %s\nINPUT = %s\nSTRIP_FROM_PATH = %s\nOUTPUT_DIRECTORY = %s\n' "$version" "$headers" "$headers" "$work/doxygen"
} >"$work/Doxyfile"
mkdir "$work/doxygen"
doxygen "$work/Doxyfile"
mv "$work/doxygen/html" "$work/site/headers"

python3 "$here/check_site.py" "$work/site"
touch "$work/site/.biteline-docs"
rm -rf "$out"
mkdir -p "$(dirname "$out")"
mv "$work/site" "$out"
