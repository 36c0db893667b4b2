#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# man_page.sh PROGRAM VERSION "WHAT IT IS" NAME.1.gz: the manual page NAME of the program's own help.
set -euo pipefail
program=$1 version=$2 what=$3 file=$4
name=$(basename "$file" .1.gz)
# escape: as roff takes words literally.
escape() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"; }
{
  printf '.TH %s 1 "" "biteline %s" "Biteline"\n' "${name^^}" "$version"
  printf '.SH NAME\n%s \\- %s\n.SH SYNOPSIS\n.B %s\n[options]\n' "${name//-/\\-}" "$what" "${name//-/\\-}"
  printf '.SH DESCRIPTION\n.nf\n'
  "$program" --help | escape
  printf '.fi\n'
  # Subcommands, where there are any, each with its own help.
  for command in $("$program" --help | sed -n '/^Subcommands:/,$p' | sed -n 's/^  \([a-z][a-z-]*\) .*/\1/p'); do
    [ "$command" != demo ] || continue  # another program's
    printf '.SH %s\n.nf\n' "${command^^}"
    "$program" "$command" --help | escape
    printf '.fi\n'
  done
  printf '.SH SEE ALSO\nThe documents in /usr/share/doc/biteline.\n'
} | gzip -9n >"$file.part"
mv "$file.part" "$file"
