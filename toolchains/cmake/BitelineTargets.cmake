# SPDX-License-Identifier: MIT
# One way to declare a module, a program and a test.

# Presets without this still prove that each source stands alone.
option(BITELINE_UNITY "Compile the sources of a target some at a time as one unit" OFF)

# biteline_unite(<target> [SOURCE...]): headers and templates of several sources are worked through once.  These sources stay
# alone: they have private names that others of the target have, too, or are compiled once for each set of instructions.
function(biteline_unite target)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  if(BITELINE_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
  endif()
endfunction()

# biteline_add_library(<module> SOURCES ... HEADERS ... [DEPENDS ...] [PRIVATE_DEPENDS ...] [ALONE ...] [NO_EXCEPTIONS] [EACH_ALONE])
# makes target biteline_<module> with alias biteline::<module>; headers are included by their path from the root.
# A module without SOURCES is an interface library.  ALONE: see biteline_unite; EACH_ALONE: all of them, as real-time code is.
function(biteline_add_library module)
  cmake_parse_arguments(ARG "NO_EXCEPTIONS;EACH_ALONE" "" "SOURCES;HEADERS;DEPENDS;PRIVATE_DEPENDS;ALONE" ${ARGN})
  set(target biteline_${module})
  if(ARG_SOURCES)
    add_library(${target} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(biteline::${module} ALIAS ${target})
  target_include_directories(${target} ${scope} ${CMAKE_SOURCE_DIR})
  target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS ${CMAKE_SOURCE_DIR} FILES ${ARG_HEADERS})
  target_link_libraries(${target} ${scope} ${ARG_DEPENDS})
  if(ARG_PRIVATE_DEPENDS)
    target_link_libraries(${target} PRIVATE ${ARG_PRIVATE_DEPENDS})
  endif()
  if(ARG_SOURCES AND NOT ARG_EACH_ALONE)
    biteline_unite(${target} ${ARG_ALONE})
  endif()
  if(ARG_NO_EXCEPTIONS AND ARG_SOURCES)
    target_compile_options(${target} PRIVATE -fno-exceptions)
    biteline_precompile(${target} NO_EXCEPTIONS)
  elseif(ARG_SOURCES)
    biteline_precompile(${target})
  endif()
endfunction()

# biteline_add_program(<name> SOURCES ... DEPENDS ... [ALONE ...])
function(biteline_add_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;ALONE" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS})
  biteline_precompile(${name})
  biteline_unite(${name} ${ARG_ALONE})
endfunction()

# biteline_add_test(<name> LABEL <unit|integration|replay|rt|kernel-sim|bench> SOURCES ... DEPENDS ... [ALONE ...] [TIMEOUT s])
# TIMEOUT guards against hangs alone: no busy machine may meet it.
# One executable, one ctest entry.  Exit 77 means skipped: the environment lacks what the test needs.
function(biteline_add_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;DEPENDS;ALONE" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE biteline_test_main ${ARG_DEPENDS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  biteline_precompile(${name})
  biteline_unite(${name} ${ARG_ALONE})
  add_test(NAME ${name} COMMAND ${name})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 1800)
  endif()
  set_tests_properties(${name} PROPERTIES LABELS ${ARG_LABEL} SKIP_RETURN_CODE 77 TIMEOUT ${ARG_TIMEOUT})
endfunction()
