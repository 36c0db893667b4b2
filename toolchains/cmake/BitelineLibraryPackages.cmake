# SPDX-License-Identifier: MIT
# What a developer of other programs gets: libbiteline0 (the library), libbiteline-dev (headers, examples), python3-biteline.
# Included by BitelinePackage.cmake.
set(library_version ${PROJECT_VERSION_MAJOR})
set(package_library libbiteline${library_version})
set(package_dev libbiteline-dev)
set(package_python python3-biteline)
set(components library dev)
if(TARGET biteline_python)
  list(APPEND components python)
endif()

foreach(component IN LISTS components)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package_${component}})
  list(APPEND CPACK_COMPONENTS_ALL ${component})
endforeach()
biteline_package_papers(library ${package_library} libbiteline)
biteline_package_papers(dev ${package_dev})
biteline_package_papers(python ${package_python})
biteline_package_sbom(library PACKAGE ${package_library} FILES lib/libbiteline.so.${PROJECT_VERSION})

# A program that is linked against this library depends on this version: before 1.0 each may break the one before.
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/host/library/package/triggers)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${package_library} (= ${PROJECT_VERSION}), libeigen3-dev (>= 3.4)")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "${package_library} (= ${PROJECT_VERSION}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy, libc6 (>= 2.36), libstdc++6 (>= 12), libgcc-s1")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "Shoe bite lines: finding, transfer, robot paths (library)
 Finds the line where a shoe's upper meets its sole in a point cloud,
 carries it over to the next upper, and plans a checked robot path.")
set(CPACK_COMPONENT_DEV_DESCRIPTION "Shoe bite lines: finding, transfer, robot paths (headers)
 Headers, CMake and pkg-config files, and examples for libbiteline.")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Shoe bite lines: finding, transfer, robot paths (Python)
 The Python module biteline: libbiteline with numpy arrays, with types.")
