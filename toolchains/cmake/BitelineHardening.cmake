# SPDX-License-Identifier: MIT
# What makes a fault in a finished program hard to use.  Off where a sanitizer brings its own checks (presets asan, tsan, fuzz).
# tests/hardening looks at the finished programs.
option(BITELINE_HARDENING "Checked library calls, marked jump targets, read-only relocations" ON)
if(BITELINE_HARDENING)
  # Level 3 counts the size of allocated buffers, too; it needs optimised code.
  add_compile_options($<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE> $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=3>)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    add_compile_options(-fcf-protection=full)
  elseif(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
    add_compile_options(-mbranch-protection=standard)
  endif()
  # Position independent: as the compiler does by default on Debian.
  add_link_options(-Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)
endif()
