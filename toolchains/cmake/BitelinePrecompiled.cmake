# SPDX-License-Identifier: MIT
# The library headers that most units read, parsed once for all of them.
# Every unit still includes what it uses: presets dev, arm64 and fuzz build without this and would not compile.
option(BITELINE_PRECOMPILE "Parse Eigen and the most used standard headers once" OFF)

# Half of all sources are tests.  Their own code waits for programs and calls libraries, which are optimised as ever: little
# optimisation and no notes for a debugger spare a third of its compilation.  Benchmarks measure, so they are compiled as products.
option(BITELINE_QUICK_TESTS "Compile the tests' own sources quickly (-O1 -g0)" OFF)

# By itself the compiler tidies its memory every few dozen megabytes: a twentieth of its time.
option(BITELINE_ROOMY_COMPILER "GCC may fill 1 GB before it tidies up (1.7 GB for each of its processes at most)" OFF)
if(BITELINE_ROOMY_COMPILER AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options(--param=ggc-min-heapsize=1048576)
endif()

# precompiled(<name> HEADERS...): target <name>, whose parsed headers other targets may start from.
function(precompiled name)
  file(WRITE ${CMAKE_BINARY_DIR}/generated/${name}.cpp "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/generated/${name}.cpp)
  target_link_libraries(${name} PRIVATE Eigen3::Eigen tl::expected)
  target_precompile_headers(${name} PRIVATE
    <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional>
    <map> <memory> <mutex> <numbers> <optional> <random> <span> <sstream> <string> <string_view> <thread> <tl/expected.hpp>
    <utility> <vector> ${ARGN})
endfunction()

if(BITELINE_PRECOMPILE)
  # GLib's packages ask for it; a compiler takes parsed headers only under the macros they were parsed with.
  add_compile_options(-pthread)
  precompiled(biteline_precompiled)
  precompiled(biteline_precompiled_no_exceptions)
  target_compile_options(biteline_precompiled_no_exceptions PRIVATE -fno-exceptions)
  if(BITELINE_QUICK_TESTS)
    precompiled(biteline_precompiled_tests)
    target_compile_options(biteline_precompiled_tests PRIVATE -O1 -g0)
  endif()
endif()

# biteline_precompile(<target> [NO_EXCEPTIONS|TESTS]): the target's units start from the headers above.  TESTS: only tests use it.
function(biteline_precompile target)
  cmake_parse_arguments(ARG "NO_EXCEPTIONS;TESTS" "" "" ${ARGN})
  set(kind "")
  if(ARG_TESTS AND BITELINE_QUICK_TESTS)
    target_compile_options(${target} PRIVATE -O1 -g0)
    set(kind _tests)
  elseif(ARG_NO_EXCEPTIONS)
    set(kind _no_exceptions)
  endif()
  if(BITELINE_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM biteline_precompiled${kind})
  endif()
endfunction()
