# SPDX-License-Identifier: MIT
# What a unit gets: `cpack -G DEB` in a build folder makes biteline-firmware_<version>_<architecture>.deb.
include(GNUInstallDirs)

# biteline_package_sbom(COMPONENT PROGRAMS ... [PAGES ...]): what is in biteline-COMPONENT as CycloneDX, made when it is packed.
# A cross build has none: ldd asks this machine's loader.
function(biteline_package_sbom component)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "PROGRAMS;PAGES")
  if(CMAKE_CROSSCOMPILING OR NOT CMAKE_GENERATOR STREQUAL Ninja)
    return()
  endif()
  set(file ${CMAKE_BINARY_DIR}/sbom/${component}.cdx.json)
  set(command ${CMAKE_SOURCE_DIR}/toolchains/package/sbom.py --name biteline-${component} --version ${PROJECT_VERSION}
      --build ${CMAKE_BINARY_DIR} --lock ${CMAKE_SOURCE_DIR}/host/web/package-lock.json --out ${file})
  foreach(program IN LISTS arg_PROGRAMS)
    list(APPEND command --program ${CMAKE_BINARY_DIR}/bin/${program})
  endforeach()
  # As host/web decides whether the page is built.
  if(BITELINE_ESBUILD AND EXISTS ${CMAKE_SOURCE_DIR}/host/web/node_modules/preact)
    foreach(page IN LISTS arg_PAGES)
      list(APPEND command --page ${CMAKE_BINARY_DIR}/share/biteline/web.made/${page}.json)
    endforeach()
  endif()
  string(JOIN "\" \"" words ${command})
  install(CODE "execute_process(COMMAND \"${words}\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
  install(FILES ${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/biteline-${component} RENAME sbom.cdx.json COMPONENT ${component})
endfunction()
biteline_package_sbom(firmware PROGRAMS biteline-sensor)

install(TARGETS biteline-sensor RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT firmware)
install(FILES boards/common/systemd/biteline-sensor.service DESTINATION lib/systemd/system COMPONENT firmware)
install(FILES boards/common/udev/90-biteline.rules DESTINATION lib/udev/rules.d COMPONENT firmware)
install(FILES boards/common/sysusers/biteline.conf DESTINATION lib/sysusers.d COMPONENT firmware)
install(FILES boards/common/sysctl/90-biteline.conf DESTINATION lib/sysctl.d COMPONENT firmware)
install(PROGRAMS firmware/update/biteline_update.sh DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT firmware RENAME biteline-update)
install(PROGRAMS firmware/update/biteline_bundle.sh DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT firmware RENAME biteline-bundle)
install(PROGRAMS firmware/update/biteline_backup.sh DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT firmware RENAME biteline-backup)
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
endif()
include(CPack)
