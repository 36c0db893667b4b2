#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# check_page.sh types|lint|words|same_bytes FOLDER: one check of the page's sources in FOLDER.
set -euo pipefail
check=$1
cd "$2"

skip() {
  echo "skipped: $1"
  exit 77
}
command -v node >/dev/null || skip 'no node; ./run test installs it'
[ -d node_modules/preact ] && [ -d node_modules/openapi-typescript ] || skip 'no packages; run npm ci in host/web'

case "$check" in
  # First the types of openapi.yaml: the page has none of its own for what the API says.
  types) npm run -s types ;;
  lint)
    # Biome's program for one machine, without its chooser: a registry that lacks the others' programs makes a lock file
    # that newer npm take for incomplete.
    biome=node_modules/@biomejs/cli-linux-x64/biome
    "$biome" --version >/dev/null 2>&1 || skip 'the linter does not run on this machine'
    "$biome" lint --error-on-warnings src
    "$biome" format src || {
      echo "'npm run format' in host/web mends the layout"
      exit 1
    }
    ;;
  words)
    # Each language has the keys of English and no others, and the same {places}.  help_*: English is the service's own.
    node -e '
      const fs = require("fs");
      const read = (f) => JSON.parse(fs.readFileSync("words/" + f, "utf8"));
      const en = read("en.json"), places = (s) => (s.match(/\{\w+\}/g) || []).sort().join();
      let bad = 0;
      const say = (text) => { console.log(text); bad = 1; };
      for (const file of fs.readdirSync("words")) {
        const words = read(file);
        for (const key of Object.keys(en)) {
          if (!words[key]) say(`${file}: ${key} is missing`);
          else if (places(words[key]) !== places(en[key])) say(`${file}: ${key} has other {places} than en.json`);
        }
        for (const key of Object.keys(words)) if (!(key in en) && !key.startsWith("help_")) say(`${file}: ${key} is not in en.json`);
      }
      // Each code that a row of the history can have has words: docs/formats.md lists them.
      const text = fs.readFileSync("../../docs/formats.md", "utf8").split("## Refusals")[1].split("## Exit status")[0];
      const of_a_row = /^\| (a scan|the service|a transfer|a plan|the gate|following|a line|a second look)\b/;
      let codes = 0;
      for (const line of text.split("\n").filter((one) => of_a_row.test(one))) {
        const told = line.split("|")[2].replace(/\([^)]*\)/g, "");
        for (const [, code] of told.matchAll(/`([a-z_]+)`/g)) {
          ++codes;
          if (!en[`reason_${code}`]) say(`en.json: reason_${code} is missing`);
        }
      }
      if (codes < 90) say(`only ${codes} codes in docs/formats.md`);
      // What the sources ask for by name is there; TypeScript checks the rest.
      process.exit(bad);'
    ;;
  same_bytes)
    command -v esbuild >/dev/null || skip 'no esbuild; ./run test installs it'
    folder=$(mktemp -d)
    trap 'rm -rf "$folder"' EXIT
    ./build.sh esbuild "$folder/one"
    ./build.sh esbuild "$folder/two"
    diff -r "$folder/one" "$folder/two"
    if grep -rlE "$PWD|/home/|https?://(registry|telemetry)" "$folder/one"; then
      echo 'the page names this machine or a service'
      exit 1
    fi
    ;;
  *)
    echo "check_page.sh: types, lint, words or same_bytes expected, found '$check'" >&2
    exit 2
    ;;
esac
