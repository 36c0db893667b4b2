# SPDX-License-Identifier: MIT
# The library headers that most units read, parsed once for all of them.
# Every unit still includes what it uses: presets dev, arm64 and fuzz build without this and would not compile.
option(BITELINE_PRECOMPILE "Parse Eigen and the most used standard headers once" OFF)

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
endif()

# biteline_precompile(<target> [NO_EXCEPTIONS]): the target's units start from the headers above.
function(biteline_precompile target)
  cmake_parse_arguments(ARG "NO_EXCEPTIONS" "" "" ${ARGN})
  if(BITELINE_PRECOMPILE AND ARG_NO_EXCEPTIONS)
    target_precompile_headers(${target} REUSE_FROM biteline_precompiled_no_exceptions)
  elseif(BITELINE_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM biteline_precompiled)
  endif()
endfunction()
