# SPDX-License-Identifier: MIT
# The library headers that most units read, parsed once for all of them.
# Every unit still includes what it uses: presets dev, arm64 and fuzz build without this and would not compile.
option(BITELINE_PRECOMPILE "Parse Eigen and the most used standard headers once" OFF)

# Half of all sources are tests, a fifth are what programs do beside the method: command lines, pages, messages, tables.  They wait
# for people, files and networks, and call libraries, which are optimised as ever: little optimisation and no notes for a debugger
# spare a third of their compilation.  Benchmarks measure, so they are compiled as the libraries are.
option(BITELINE_QUICK "Compile quickly (-O1 -g0) what only waits: tests, and what is declared QUICK" OFF)

# By itself the compiler tidies its memory every few dozen megabytes: a twentieth of its time.
option(BITELINE_ROOMY_COMPILER "GCC may fill 1 GB before it tidies up (2.2 GB for each of its processes at most)" OFF)
if(BITELINE_ROOMY_COMPILER AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options(--param=ggc-min-heapsize=1048576)
endif()

# Some 170 programs are linked.
option(BITELINE_QUICK_LINKER "Link by mold where it is installed: a quarter of the usual linker's processor time" OFF)
if(BITELINE_QUICK_LINKER)
  find_program(BITELINE_MOLD mold)
  if(BITELINE_MOLD)
    # In one process: a build is done when its last linker is.
    add_link_options(-fuse-ld=mold -Wl,--no-fork)
  endif()
endif()

# The compiler's vector instructions, which TBB and Highway bring along: half a second in each unit.
set(intrinsics "")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(intrinsics <immintrin.h>)
endif()

# precompiled(<name> HEADERS...): target <name>, whose parsed headers other targets may start from.
function(precompiled name)
  if(NOT EXISTS ${CMAKE_BINARY_DIR}/generated/${name}.cpp)
    file(WRITE ${CMAKE_BINARY_DIR}/generated/${name}.cpp "")
  endif()
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/generated/${name}.cpp)
  target_link_libraries(${name} PRIVATE Eigen3::Eigen tl::expected)
  target_precompile_headers(${name} PRIVATE
    ${intrinsics} <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional>
    <map> <memory> <mutex> <numbers> <optional> <random> <span> <sstream> <string> <string_view> <thread> <tl/expected.hpp>
    <utility> <vector> ${ARGN})
endfunction()

if(BITELINE_PRECOMPILE)
  # GLib's packages ask for it; a compiler takes parsed headers only under the macros they were parsed with.
  add_compile_options(-pthread)
  precompiled(biteline_precompiled)
  precompiled(biteline_precompiled_no_exceptions)
  target_compile_options(biteline_precompiled_no_exceptions PRIVATE -fno-exceptions)
  # A compiler takes parsed headers only where they are meant for the same kind of library.
  precompiled(biteline_precompiled_core)
  target_compile_options(biteline_precompiled_core PRIVATE ${BITELINE_CORE_OPTIONS})
  precompiled(biteline_precompiled_no_exceptions_core)
  target_compile_options(biteline_precompiled_no_exceptions_core PRIVATE ${BITELINE_CORE_OPTIONS} -fno-exceptions)
  if(BITELINE_QUICK)
    precompiled(biteline_precompiled_quick)
    target_compile_options(biteline_precompiled_quick PRIVATE -O1 -g0)
  endif()
endif()

# biteline_precompile(<target> [NO_EXCEPTIONS] [CORE] | QUICK): the target's units start from the headers above.  CORE: of
# BITELINE_CORE_ROOMS.  QUICK: see BITELINE_QUICK.
function(biteline_precompile target)
  cmake_parse_arguments(ARG "NO_EXCEPTIONS;CORE;QUICK" "" "" ${ARGN})
  set(kind "")
  if(ARG_QUICK AND BITELINE_QUICK)
    target_compile_options(${target} PRIVATE -O1 -g0)
    set(kind _quick)
  elseif(ARG_NO_EXCEPTIONS)
    set(kind _no_exceptions)
  endif()
  if(ARG_CORE)
    string(APPEND kind _core)
  endif()
  if(BITELINE_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM biteline_precompiled${kind})
  endif()
endfunction()
