#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# programs.sh HARDENED PROGRAM...: each finished program has what a hardened build gives it.  One line for each thing that is
# missing.  HARDENED 0: the build is one with a sanitizer.
set -euo pipefail
[ "$1" = 1 ] || { echo "skipped: BITELINE_HARDENING is off"; exit 77; }
shift
command -v readelf >/dev/null && command -v objdump >/dev/null || { echo "skipped: no binutils"; exit 77; }
bad=0
for program in "$@"; do
  missing() { echo "$program: $1"; bad=1; }
  headers=$(readelf -lW "$program")
  dynamic=$(readelf -dW "$program")
  symbols=$(readelf --dyn-syms -W "$program")
  grep -q 'Elf file type is DYN' <<<"$headers" || missing "not position independent"
  grep -q 'GNU_RELRO' <<<"$headers" || missing "relocations stay writable (no RELRO)"
  grep -qE 'BIND_NOW|FLAGS_1.*NOW' <<<"$dynamic" || missing "relocated lazily (no BIND_NOW)"
  grep -qE 'GNU_STACK.* RW ' <<<"$headers" || missing "executable stack"
  grep -q '__stack_chk_fail' <<<"$symbols" || missing "no stack protector"
  grep -qE '(RPATH|RUNPATH)' <<<"$dynamic" && missing "carries a path for its libraries"
  grep -qE ' __[a-z]+_chk@' <<<"$symbols" || missing "no checked library call (_FORTIFY_SOURCE)"
  mark= disassembler=objdump
  case $(readelf -hW "$program" | sed -n 's/ *Machine: *//p') in
    *X86-64*) mark=endbr64 ;;
    AArch64)
      mark=paciasp
      # Another machine's objdump cannot read it.
      command -v aarch64-linux-gnu-objdump >/dev/null && disassembler=aarch64-linux-gnu-objdump
      ;;
  esac
  # A few come with the C library's own files; a program of ours has thousands.
  if [ -n "$mark" ]; then
    count=$("$disassembler" -d --no-show-raw-insn "$program" 2>/dev/null | grep -c "\b$mark\b" || true)
    [ "$count" -gt 500 ] || missing "jump targets are not marked ($mark: $count)"
  fi
done
[ $bad -eq 0 ] && echo "$# programs"
exit $bad
