#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# check_docs.sh ROOT: links in documents lead somewhere, sources cite only documents that are here, sentences are short,
# and none leans on the one before it.
set -u
root=$1
cd "$root" || exit 1
bad=0

complain() {
  echo "$1"
  sed 's/^/  /' <<<"$2"
  bad=1
}

documents() {
  find . -name '*.md' -not -path './build*' -not -path './.git/*' -not -path '*/node_modules/*' | sed 's|^\./||' | sort
}

# [text](target): a path relative to the document, without its #heading.
found=$(documents | while read -r file; do
  grep -oE '\]\([^)]+\)' "$file" | sed -E 's/^\]\(//; s/\)$//; s/#.*//; s/ .*//' | grep -vE '^$|^[a-z]+:' | while read -r target; do
    [ -e "$(dirname "$file")/$target" ] || echo "$file: $target"
  done
done)
[ -n "$found" ] && complain 'docs: these links lead nowhere' "$found"

found=$(grep -rnoE --include='*.cpp' --include='*.hpp' --include='*.sh' --include='CMakeLists.txt' '[A-Za-z0-9_./-]+\.md\b' \
  common hal firmware host tests toolchains boards 2>/dev/null | grep -v '^tests/style/' | while IFS=: read -r file line name; do
  [ -e "$name" ] || [ -e "$(dirname "$file")/$name" ] || [ -e "docs/$name" ] ||
    [ -n "$(documents | grep -E "(^|/)$name\$")" ] || echo "$file:$line: $name"
done)
[ -n "$found" ] && complain 'docs: sources cite documents that are not in the tree' "$found"

# A reader who learned English late must follow, and look up one sentence alone: at most 30 words, and none that begins with
# So, Nor, There, Then and refers back ("There is" does not).  Code, pictures and addresses are no words.
# tests/style/leaning_documents.txt names the documents that were written before this rule; whoever mends one drops its row.
most_words=30
leaning=$root/tests/style/leaning_documents.txt
judged=$(documents | grep -E '^(README\.md|docs/|[a-z]+/README\.md)' | grep -v '^boards/' | xargs -r awk -v most="$most_words" '
  function judge(text, where,    n, i, words, count) {
    gsub(/`[^`]*`/, "x", text); gsub(/!?\[[^]]*\]\([^)]*\)/, "x", text)
    n = split(text, sentences, /[.!?]( |$)|: *$|; /)
    for (i = 1; i <= n; ++i) {
      count = split(sentences[i], words, /[ \t]+/)
      if (words[1] == "") --count
      if (count > most) print "long " where ": " count " words: " substr(sentences[i], 1, 70)
      if (sentences[i] ~ /^[ \t]*(So|Nor|Then|There)[ ,]/ && sentences[i] !~ /^[ \t]*There (is|are|was|were) /)
        print "lean " where ": " substr(sentences[i], 1, 70)
    }
  }
  function finish() { if (paragraph != "") judge(paragraph, started); paragraph = "" }
  FNR == 1 { finish(); fenced = 0 }
  /^```/ { finish(); fenced = !fenced; next }
  fenced { next }
  /^    / && paragraph == "" { next }
  /^[ \t]*$/ || /^#/ { finish(); next }
  /^\|/ { finish(); m = split($0, cells, /\|/); for (c = 1; c <= m; ++c) judge(cells[c], FILENAME ":" FNR); next }
  /^[ \t]*([-*]|[0-9]+\.) / { finish(); sub(/^[ \t]*([-*]|[0-9]+\.) /, "") }
  { if (paragraph == "") started = FILENAME ":" FNR; paragraph = paragraph " " $0 }
  END { finish() }')
found=$(sed -n 's/^long //p' <<<"$judged")
[ -n "$found" ] && complain "docs: sentences of more than $most_words words" "$found"
leans=$(sed -n 's/^lean //p' <<<"$judged")
found=$(grep -vFf <(sed 's/$/:/' "$leaning" 2>/dev/null) <<<"$leans" | grep .)
[ -n "$found" ] && complain 'docs: sentences that lean on the one before: name what they refer to' "$found"
found=$(while read -r name; do grep -q "^$name:" <<<"$leans" || echo "$name"; done < <(cat "$leaning" 2>/dev/null))
[ -n "$found" ] && complain 'docs: these lean no more: take them off tests/style/leaning_documents.txt' "$found"
exit $bad
