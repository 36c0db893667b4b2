# SPDX-License-Identifier: MIT
# One way to declare a module, a program and a test.

# Presets without this still prove that each source stands alone.
option(BITELINE_UNITY "Compile the sources of a target some at a time as one unit" OFF)

# biteline_unite(<target> [SOURCE...]): headers and templates of several sources are worked through once.  These sources stay
# alone: they have private names that others of the target have, too, or are compiled once for each set of instructions.
function(biteline_unite target)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  if(BITELINE_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 16)
  endif()
endfunction()

# The rooms that libbiteline is made of (host/library): compiled so that a shared library may hold them, their names for nobody outside.
# Everything else links the same archives: no room is compiled twice.
set(BITELINE_CORE_ROOMS
  core system geometry camera_state csv config image session rt_stripe stripe wire_messages wire
  ended_by report archive host_geometry cloud curvature uncertainty bite_line scan_cloud intake transfer calibration kinematics path)
set(BITELINE_CORE_OPTIONS -fPIC -fvisibility=hidden -fvisibility-inlines-hidden)

# biteline_add_library(<module> SOURCES ... HEADERS ... [DEPENDS ...] [PRIVATE_DEPENDS ...] [ALONE ...] [NO_EXCEPTIONS] [EACH_ALONE] [QUICK])
# makes target biteline_<module> with alias biteline::<module>; headers are included by their path from the root.
# A module without SOURCES is an interface library.  ALONE: see biteline_unite; EACH_ALONE: all of them, as real-time code is.
# QUICK: it waits for people, files and networks; see BITELINE_QUICK.
function(biteline_add_library module)
  cmake_parse_arguments(ARG "NO_EXCEPTIONS;EACH_ALONE;QUICK" "" "SOURCES;HEADERS;DEPENDS;PRIVATE_DEPENDS;ALONE" ${ARGN})
  set(target biteline_${module})
  set(core "")
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
  if(ARG_SOURCES AND module IN_LIST BITELINE_CORE_ROOMS)
    target_compile_options(${target} PRIVATE ${BITELINE_CORE_OPTIONS})
    set(core CORE)
  endif()
  if(ARG_NO_EXCEPTIONS AND ARG_SOURCES)
    target_compile_options(${target} PRIVATE -fno-exceptions)
    biteline_precompile(${target} NO_EXCEPTIONS ${core})
  elseif(ARG_SOURCES AND core)
    biteline_precompile(${target} CORE)
  elseif(ARG_SOURCES AND ARG_QUICK)
    biteline_precompile(${target} QUICK)
  elseif(ARG_SOURCES)
    biteline_precompile(${target})
  endif()
endfunction()

# biteline_add_program(<name> SOURCES ... DEPENDS ... [ALONE ...] [QUICK])
function(biteline_add_program name)
  cmake_parse_arguments(ARG "QUICK" "" "SOURCES;DEPENDS;ALONE" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS})
  if(ARG_QUICK)
    biteline_precompile(${name} QUICK)
  else()
    biteline_precompile(${name})
  endif()
  biteline_unite(${name} ${ARG_ALONE})
endfunction()

# biteline_add_test(<name> LABEL <unit|integration|timed|replay|rt|kernel-sim|bench> SOURCES ... DEPENDS ... [ALONE ...] [TIMEOUT s] [LONG] [APART <groups> <entry>])
# TIMEOUT guards against hangs alone: no busy machine may meet it.
# LONG: groups whose names end in Long are an entry of their own, <name>_long, for ./run test --all alone.
# APART: groups whose names hold that word are an entry of their own, beside which the others run.
# One executable, one ctest entry.  Exit 77 means skipped: the environment lacks what the test needs.
function(biteline_add_test name)
  cmake_parse_arguments(ARG "LONG" "LABEL;TIMEOUT" "SOURCES;DEPENDS;ALONE;APART" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE biteline_test_main ${ARG_DEPENDS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(ARG_LABEL MATCHES "^(bench|rt)$")
    biteline_precompile(${name})
  else()
    biteline_precompile(${name} QUICK)
  endif()
  biteline_unite(${name} ${ARG_ALONE})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 1800)
  endif()
  if(ARG_LONG)
    add_test(NAME ${name} COMMAND ${name} -xg Long)
    add_test(NAME ${name}_long COMMAND ${name} -g Long)
    set_tests_properties(${name}_long PROPERTIES LABELS long SKIP_RETURN_CODE 77 TIMEOUT ${ARG_TIMEOUT})
  elseif(ARG_APART)
    list(GET ARG_APART 0 groups)
    list(GET ARG_APART 1 entry)
    add_test(NAME ${name} COMMAND ${name} -xg ${groups})
    add_test(NAME ${entry} COMMAND ${name} -g ${groups})
    set_tests_properties(${entry} PROPERTIES LABELS ${ARG_LABEL} SKIP_RETURN_CODE 77 TIMEOUT ${ARG_TIMEOUT})
  else()
    add_test(NAME ${name} COMMAND ${name})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS ${ARG_LABEL} SKIP_RETURN_CODE 77 TIMEOUT ${ARG_TIMEOUT})
endfunction()

# biteline_alone(<test> ...): what must keep a time runs alone, its long part, too.
function(biteline_alone)
  foreach(name ${ARGN})
    set_tests_properties(${name} PROPERTIES RUN_SERIAL ON)
    if(TEST ${name}_long)
      set_tests_properties(${name}_long PROPERTIES RUN_SERIAL ON)
    endif()
  endforeach()
endfunction()

# biteline_computes(<test> ...): among tests that drive programs and mostly wait it has a core of its own: three of their places (./run).
function(biteline_computes)
  foreach(name ${ARGN})
    set_tests_properties(${name} PROPERTIES PROCESSORS 3)
    if(TEST ${name}_long)
      set_tests_properties(${name}_long PROPERTIES PROCESSORS 3)
    endif()
  endforeach()
endfunction()

# biteline_in_turn(<turn> <test> ...): what takes minutes and is no safety reaction.  There are four turns, 0 to 3, of some seven minutes
# each.  ./run test has one of them each day, ./run test --all has them all.
function(biteline_in_turn turn)
  foreach(name ${ARGN})
    set_property(TEST ${name} APPEND PROPERTY LABELS turn_${turn})
  endforeach()
endfunction()

# biteline_has_camera_port(<test> ...): the standard fixes the port: one simulated camera at a time.
function(biteline_has_camera_port)
  foreach(name ${ARGN})
    set_tests_properties(${name} PROPERTIES RESOURCE_LOCK gige_vision_port)
    if(TEST ${name}_long)
      set_tests_properties(${name}_long PROPERTIES RESOURCE_LOCK gige_vision_port)
    endif()
  endforeach()
endfunction()
