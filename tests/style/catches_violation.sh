#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# catches_violation.sh format|names|docs|site|tidy: each check must be green on a clean tree and red on every seeded violation.
set -u
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{common/core,host/cloud,host/robot/path}
cp "$root/.clang-format" "$root/.clang-tidy" "$tree"

clean() {
  cat >"$tree/host/cloud/good.hpp" <<'CODE'
#pragma once

namespace biteline::cloud {
struct Place {
  int at;
};
int twice(const Place& place);
}  // namespace biteline::cloud
CODE
  cat >"$tree/host/cloud/good.cpp" <<'CODE'
#include "host/cloud/good.hpp"

namespace biteline::cloud {
int twice(const Place& place) {
  return 2 * place.at;
}
}  // namespace biteline::cloud
CODE
}

check() {
  "$@" >"$tree/said" 2>&1
  local status=$?
  [ $status -eq 77 ] && { cat "$tree/said"; exit 77; }
  return $status
}

must_be_green() {
  check "$@" || { echo "red on a clean tree:"; cat "$tree/said"; exit 1; }
}

# must_be_red WHAT CHECK...
must_be_red() {
  local what=$1
  shift
  check "$@" && { echo "green although $what"; exit 1; }
  return 0
}

clean
case $1 in
  format)
    must_be_green "$here/check_format.sh" "$tree"
    echo 'int  x ;' >"$tree/host/cloud/bad.cpp"
    must_be_red 'a file is not laid out' "$here/check_format.sh" "$tree"
    ;;
  names)
    must_be_green "$here/check_names.sh" "$tree"
    for name in host/cloud/BadName.cpp host/robot/path/bad-name.hpp; do
      touch "$tree/$name"
      must_be_red "a file is called $name" "$here/check_names.sh" "$tree"
      rm "$tree/$name"
    done
    printf '#include "host/cloud/other.hpp"\n#include "host/cloud/good.hpp"\n#include <vector>\n' >"$tree/host/cloud/bad.cpp"
    must_be_red 'a <...> comes after a "..."' "$here/check_names.sh" "$tree"
    printf '#include "good.hpp"\n' >"$tree/host/cloud/bad.cpp"
    must_be_red 'an include is not named from the root' "$here/check_names.sh" "$tree"
    rm "$tree/host/cloud/bad.cpp"
    printf '#include <vector>\n\n#include "host/cloud/good.hpp"\n' >"$tree/host/cloud/good.cpp"
    must_be_red 'the own header does not come first' "$here/check_names.sh" "$tree"
    clean
    printf 'struct Place {\n};\n' >"$tree/host/robot/path/other.hpp"
    must_be_red 'two types of host are called Place' "$here/check_names.sh" "$tree"
    ;;
  docs)
    printf '# x\n\nSee [y](y.md#top). A short sentence.\n' >"$tree/README.md"
    echo '# y' >"$tree/y.md"
    echo '// See y.md.' >"$tree/host/cloud/cites.cpp"
    must_be_green "$here/check_docs.sh" "$tree"
    echo '// See z.md.' >"$tree/host/cloud/cites.cpp"
    must_be_red 'a source cites a document that is not there' "$here/check_docs.sh" "$tree"
    rm "$tree/host/cloud/cites.cpp"
    echo '[z](z.md)' >>"$tree/y.md"
    must_be_red 'a link leads nowhere' "$here/check_docs.sh" "$tree"
    echo '# y' >"$tree/y.md"
    printf 'one two three four five six seven eight nine ten %.0s' 1 2 3 4 >>"$tree/README.md"
    must_be_red 'a sentence has 40 words' "$here/check_docs.sh" "$tree"
    printf '# x\n\nA scan may end early. There is one reason. It is told.\n' >"$tree/README.md"
    must_be_green "$here/check_docs.sh" "$tree"
    echo 'So is another.' >>"$tree/README.md"
    must_be_red 'a sentence leans on the one before' "$here/check_docs.sh" "$tree"
    ;;
  site)
    site="$root/docs/site"
    page() { printf '<html><body><h1 id="top">x</h1>%s</body></html>' "$1" >"$tree/index.html"; }
    page '<a href="#top">x</a>'
    must_be_green "$site/check_site.py" "$tree"
    page '<a href="none.html">x</a>'
    must_be_red 'a link leads nowhere' "$site/check_site.py" "$tree"
    page '<a href="#none">x</a>'
    must_be_red 'a heading is not there' "$site/check_site.py" "$tree"
    page '<script src="https://example.invalid/x.js"></script>'
    must_be_red 'a page loads from elsewhere' "$site/check_site.py" "$tree"
    printf '# x\n\n[y](host)\n' >"$tree/README.md"
    must_be_red 'a link leads to a folder without README' "$site/stage.py" "$tree" "$tree/staged"
    rm "$tree/README.md"
    ;;
  tidy)
    command -v git >/dev/null || { echo "skipped: git is not installed"; exit 77; }
    mkdir "$tree/build"
    for file in good bad; do
      printf '%s{"directory": "%s", "command": "c++ -std=c++20 -I%s -c %s", "file": "%s"}\n' \
        "$([ $file = bad ] && echo ,)" "$tree" "$tree" "$tree/host/cloud/$file.cpp" "$tree/host/cloud/$file.cpp"
    done | sed '1s/^/[/; $s/$/]/' >"$tree/build/compile_commands.json"
    git() { command git -C "$tree" -c user.name=test -c user.email=test@biteline.invalid -c commit.gpgsign=false "$@" >/dev/null 2>&1; }
    git init
    git add host && git commit -m one --no-verify
    echo >>"$tree/host/cloud/good.cpp"
    git add host && git commit -m two --no-verify
    must_be_green env -u BITELINE_STYLE_BASE "$here/check_tidy.sh" "$tree" "$tree/build" --changed
    seed() {
      printf '%s\n' "$2" >"$tree/host/cloud/bad.cpp"
      git add host && git commit -m three --no-verify
      must_be_red "$1" env -u BITELINE_STYLE_BASE "$here/check_tidy.sh" "$tree" "$tree/build" --changed
      must_be_red "$1" "$here/check_tidy.sh" "$tree" "$tree/build" --all
    }
    seed 'a moved-from value is used' '#include <string>
#include <utility>
std::string f(std::string a) { std::string b = std::move(a); return a + b; }'
    seed 'a class is not CamelCase' 'class bad_name {};'
    # As CMake writes it: one unit of both sources.
    cp "$tree/build/compile_commands.json" "$tree/build/alone.json"
    mkdir "$tree/build/Unity"
    unit="$tree/build/Unity/unity_0_cxx.cxx"
    printf '#include "%s"\n' "$tree"/host/cloud/{good,bad}.cpp >"$unit"
    printf '[{"directory": "%s",\n"command": "c++ -std=c++20 -I%s -c %s",\n"file": "%s"}]\n' "$tree" "$tree" "$unit" "$unit" \
      >"$tree/build/compile_commands.json"
    seed 'a class of a unit is not CamelCase' 'class bad_name {};'
    cp "$tree/build/alone.json" "$tree/build/compile_commands.json"
    # A header that the compiler alone can read, as CMake makes it, too.
    touch "$tree/build/cmake_pch.hxx"
    echo compiled >"$tree/build/cmake_pch.hxx.gch"
    precompiled="-Winvalid-pch -include $tree/build/cmake_pch.hxx"
    sed -i "s|-std=c++20|& $precompiled|" "$tree/build/compile_commands.json"
    seed 'a class beside a precompiled header is not CamelCase' 'class bad_name {};'
    echo 'class GoodName {};' >"$tree/host/cloud/bad.cpp"
    must_be_green "$here/check_tidy.sh" "$tree" "$tree/build" --all
    cp "$tree/build/cmake_pch.hxx.gch" "$tree/build/other.hxx.gch"
    sed -i "s|cmake_pch.hxx|other.hxx|" "$tree/build/compile_commands.json"
    must_be_red 'clang cannot read a command' "$here/check_tidy.sh" "$tree" "$tree/build" --all
    ;;
  *) echo "usage: catches_violation.sh format|names|docs|site|tidy"; exit 2 ;;
esac
