#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# build.sh ESBUILD FOLDER: the page's files into FOLDER.  The same sources give the same bytes.
set -euo pipefail
esbuild=$1 folder=$2
cd "$(dirname "${BASH_SOURCE[0]}")"
mkdir -p "$folder"
options=(--bundle --minify --legal-comments=eof --target=es2021 --charset=utf8 --log-level=warning
  --jsx=automatic --jsx-import-source=preact --format=iife)
# A result folder's viewer is one file: its style is a text in it.
"$esbuild" src/viewer/main.tsx "${options[@]}" --loader:.css=text --outfile="$folder/viewer.js"
"$esbuild" src/app/main.tsx "${options[@]}" --outfile="$folder/app.js"
cp public/* "$folder/"
# The same page for the factory's centre: its index.html says so.
mkdir -p "$folder/centre"
cp "$folder/app.js" "$folder/app.css" public/* "$folder/centre/"
sed -i 's|<title>|<meta name="biteline-centre" content="all cells">\n    <title>|' "$folder/centre/index.html"
