#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# build.sh ESBUILD FOLDER: the page's files into FOLDER.  The same sources give the same bytes.
set -euo pipefail
esbuild=$1 folder=$2
cd "$(dirname "${BASH_SOURCE[0]}")"
# What went into each bundle, for the package's bill of materials; beside the page, not in it.
made=$folder.made
mkdir -p "$folder" "$made"
options=(--bundle --minify --legal-comments=eof --target=es2021 --charset=utf8 --log-level=warning
  --jsx=automatic --jsx-import-source=preact --format=iife)
# A result folder's viewer is one file: its style is a text in it.
"$esbuild" src/viewer/main.tsx "${options[@]}" --loader:.css=text --metafile="$made/viewer.json" --outfile="$folder/viewer.js"
"$esbuild" src/app/main.tsx "${options[@]}" --metafile="$made/app.json" --outfile="$folder/app.js"
cp public/* "$folder/"
# English is a part of the page; the others come when they are asked for.
mkdir -p "$folder/words"
for words in words/*.json; do
  [[ "$words" == */en.json ]] || cp "$words" "$folder/words/"
done
# The same page for the factory's centre: its index.html says so.
mkdir -p "$folder/centre"
cp -r "$folder/app.js" "$folder/app.css" "$folder/words" public/* "$folder/centre/"
sed -i 's|<title>|<meta name="biteline-centre" content="all cells">\n    <title>|' "$folder/centre/index.html"
# Beside each file of some size the same, packed: what a browser is sent over a slow line.
find "$folder" -name '*.gz' -delete
find "$folder" -type f -size +2k ! -name viewer.js -exec gzip --best --no-name --keep {} +
