# SPDX-License-Identifier: MIT
# What a unit gets: `cpack -G DEB` in a build folder makes biteline-firmware_<version>_<architecture>.deb.
# `./run package` makes and checks every package.
include(GNUInstallDirs)
set(parts ${CMAKE_SOURCE_DIR}/toolchains/package)
set(man ${CMAKE_BINARY_DIR}/man)
file(MAKE_DIRECTORY ${man})

# Debian's changelog has a date: the release's, or that of the last word in ours.
if(DEFINED ENV{SOURCE_DATE_EPOCH})
  string(TIMESTAMP stamp "%a, %d %b %Y %H:%M:%S +0000" UTC)
else()
  file(TIMESTAMP ${CMAKE_SOURCE_DIR}/CHANGELOG.md stamp "%a, %d %b %Y %H:%M:%S +0000" UTC)
endif()
configure_file(${parts}/changelog.in ${CMAKE_BINARY_DIR}/package/changelog @ONLY)
execute_process(COMMAND gzip -9nkf ${CMAKE_BINARY_DIR}/package/changelog COMMAND_ERROR_IS_FATAL ANY)

# biteline_package_papers(COMPONENT PACKAGE [OVERRIDES]): licence and changelog, and what lintian is to pass over, each with its reason.
function(biteline_package_papers component package)
  install(FILES ${parts}/copyright ${CMAKE_BINARY_DIR}/package/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
  if(ARGC GREATER 2)
    install(FILES ${parts}/overrides/${ARGV2} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME ${package} COMPONENT ${component})
  endif()
endfunction()

# biteline_man_page(COMPONENT NAME PROGRAM WHAT): the manual page NAME of PROGRAM's own words; made where the program can run.
function(biteline_man_page component name program what)
  if(CMAKE_CROSSCOMPILING)
    return()
  endif()
  set(page ${man}/${name}.1.gz)
  add_custom_command(OUTPUT ${page} COMMAND ${parts}/man_page.sh ${program} ${PROJECT_VERSION} ${what} ${page}
    DEPENDS ${program} ${parts}/man_page.sh VERBATIM)
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component} OPTIONAL)
  set_property(GLOBAL APPEND PROPERTY biteline_pages ${page})
endfunction()

# biteline_package_sbom(COMPONENT [PACKAGE name] PROGRAMS ... [PAGES ...] | FILES ...): what is in the package, by default
# biteline-COMPONENT, as CycloneDX, and the notices of what is in its files, made when it is packed.
# FILES: by their path in the build folder.
# A cross build has none: ldd asks this machine's loader.
function(biteline_package_sbom component)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "PACKAGE" "PROGRAMS;PAGES;FILES")
  if(NOT arg_PACKAGE)
    set(arg_PACKAGE biteline-${component})
  endif()
  if(CMAKE_CROSSCOMPILING OR NOT CMAKE_GENERATOR STREQUAL Ninja)
    return()
  endif()
  set(file ${CMAKE_BINARY_DIR}/sbom/${component}.cdx.json)
  set(notices ${CMAKE_BINARY_DIR}/sbom/${component}.notices.gz)
  set(command ${CMAKE_SOURCE_DIR}/toolchains/package/sbom.py --name ${arg_PACKAGE} --version ${PROJECT_VERSION}
      --build ${CMAKE_BINARY_DIR} --lock ${CMAKE_SOURCE_DIR}/host/web/package-lock.json --out ${file} --notices ${notices})
  foreach(program IN LISTS arg_PROGRAMS)
    list(APPEND command --program ${CMAKE_BINARY_DIR}/bin/${program})
  endforeach()
  foreach(path IN LISTS arg_FILES)
    list(APPEND command --program ${CMAKE_BINARY_DIR}/${path})
  endforeach()
  # As host/web decides whether the page is built.
  if(BITELINE_ESBUILD AND EXISTS ${CMAKE_SOURCE_DIR}/host/web/node_modules/preact)
    foreach(page IN LISTS arg_PAGES)
      list(APPEND command --page ${CMAKE_BINARY_DIR}/share/biteline/web.made/${page}.json)
    endforeach()
  endif()
  string(JOIN "\" \"" words ${command})
  install(CODE "execute_process(COMMAND \"${words}\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
  install(FILES ${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${arg_PACKAGE} RENAME sbom.cdx.json COMPONENT ${component})
  install(FILES ${notices} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${arg_PACKAGE} RENAME notices.gz COMPONENT ${component})
endfunction()
biteline_package_papers(firmware biteline-firmware)
biteline_package_sbom(firmware PROGRAMS biteline-sensor)

install(TARGETS biteline-sensor RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT firmware)
install(FILES boards/common/systemd/biteline-sensor.service DESTINATION lib/systemd/system COMPONENT firmware)
install(FILES boards/common/udev/90-biteline.rules DESTINATION lib/udev/rules.d COMPONENT firmware)
install(FILES boards/common/sysusers/biteline.conf DESTINATION lib/sysusers.d COMPONENT firmware)
install(FILES boards/common/sysctl/90-biteline.conf DESTINATION lib/sysctl.d COMPONENT firmware)
biteline_man_page(firmware biteline-sensor $<TARGET_FILE:biteline-sensor> "camera frames in, 3-D profiles out")
foreach(tool "update;another version of a unit's program" "bundle;what somebody who helps must know of a unit" "backup;all that makes a unit this unit")
  list(GET tool 0 name)
  list(GET tool 1 what)
  set(script ${CMAKE_SOURCE_DIR}/firmware/update/biteline_${name}.sh)
  install(PROGRAMS ${script} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT firmware RENAME biteline-${name})
  biteline_man_page(firmware biteline-${name} ${script} ${what})
endforeach()
install(FILES boards/common/avahi/biteline-sensor.service DESTINATION ${CMAKE_INSTALL_DATADIR}/biteline/avahi COMPONENT firmware)
install(FILES firmware/update/systemd/biteline-update.conf DESTINATION ${CMAKE_INSTALL_DATADIR}/biteline/update COMPONENT firmware)
# Every board's data; the unit's own goes to /etc/biteline by hand, and boards/<board>/board.cmake names it.
install(DIRECTORY boards/ DESTINATION ${CMAKE_INSTALL_DATADIR}/biteline/boards COMPONENT firmware PATTERN common EXCLUDE)
set(BITELINE_BOARD "" CACHE STRING "Board whose systemd drop-in the package installs")
if(BITELINE_BOARD AND EXISTS ${CMAKE_SOURCE_DIR}/boards/${BITELINE_BOARD}/systemd)
  install(DIRECTORY boards/${BITELINE_BOARD}/systemd/ DESTINATION lib/systemd/system COMPONENT firmware)
endif()

# Packages are made of what was built; they build nothing.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL firmware)
set(CPACK_PACKAGE_NAME biteline)
set(CPACK_PACKAGE_VENDOR biteline)
set(CPACK_PACKAGE_CONTACT "Biteline maintainers <maintainers@biteline.invalid>")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_FIRMWARE_PACKAGE_NAME biteline-firmware)
set(CPACK_DEBIAN_FIRMWARE_PACKAGE_SECTION science)
set(CPACK_COMPONENT_FIRMWARE_DESCRIPTION "Program of a Biteline sensor
 Takes the camera's frames, finds the laser's stripe in each and sends
 profiles of the shoe to the host; it switches the laser.")
# biteline-update checks signatures by it.
set(CPACK_DEBIAN_FIRMWARE_PACKAGE_RECOMMENDS openssl)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  # dpkg-shlibdeps would ask this machine's packages, which are of the other architecture.
  set(CPACK_DEBIAN_FIRMWARE_PACKAGE_DEPENDS
      "libc6 (>= 2.36), libgcc-s1, libstdc++6 (>= 12), libaravis-0.8-0, libglib2.0-0, libgpiod2, libhwy1, libspng0, libssl3, libturbojpeg0, libyaml-cpp0.7, libzmq5, libzstd1, zlib1g")
else()
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
endif()
if(BITELINE_BUILD_HOST)
  include(BitelineHostPackages)
  include(BitelineLibraryPackages)
endif()
include(CPack)

get_property(pages GLOBAL PROPERTY biteline_pages)
add_custom_target(biteline_man ALL DEPENDS ${pages})
# All that the packages are made of.
add_custom_target(biteline_packages DEPENDS biteline_man biteline-sensor)
foreach(target biteline biteline-host biteline-web biteline-gige biteline-uplink biteline-fleet biteline_library biteline_python)
  if(TARGET ${target})
    add_dependencies(biteline_packages ${target})
  endif()
endforeach()
if(TARGET biteline_web_page AND BITELINE_ESBUILD AND EXISTS ${CMAKE_SOURCE_DIR}/host/web/node_modules/preact)
  add_dependencies(biteline_packages biteline_web_page)
endif()
