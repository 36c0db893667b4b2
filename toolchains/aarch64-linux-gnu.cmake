# SPDX-License-Identifier: MIT
# 64-bit Arm, Debian's cross compiler, against the sysroot that BITELINE_ARM64_SYSROOT names (toolchains/arm64_sysroot.sh).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)

set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES BITELINE_ARM64_SYSROOT)
# Kept, so that a build that configures itself again needs no environment; an empty one is not.
if(NOT BITELINE_ARM64_SYSROOT)
  set(BITELINE_ARM64_SYSROOT "$ENV{BITELINE_ARM64_SYSROOT}" CACHE PATH "Where toolchains/arm64_sysroot.sh put the sysroot" FORCE)
endif()
if(NOT BITELINE_ARM64_SYSROOT OR NOT EXISTS "${BITELINE_ARM64_SYSROOT}/usr/include")
  message(FATAL_ERROR "BITELINE_ARM64_SYSROOT names no sysroot: "
                      "export BITELINE_ARM64_SYSROOT=$(toolchains/arm64_sysroot.sh)")
endif()
set(CMAKE_SYSROOT ${BITELINE_ARM64_SYSROOT})

set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)

# Programs of this machine, everything else of the other.
set(CMAKE_FIND_ROOT_PATH ${CMAKE_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR}
    ${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)

# User emulation, so that ctest runs what was built here.
find_program(BITELINE_QEMU_AARCH64 qemu-aarch64-static)
if(BITELINE_QEMU_AARCH64)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${BITELINE_QEMU_AARCH64} -L ${CMAKE_SYSROOT})
endif()
