# SPDX-License-Identifier: MIT
# What a cell's PC gets: biteline-host (service, tool, processes, documents), biteline-web (page and API), where other
# software is to see the sensor biteline-gige, and in a factory biteline-uplink.  The factory's centre gets biteline-fleet.
# Included by BitelinePackage.cmake.

# biteline_daemon_package(COMPONENT WHAT [OVERRIDES]): the unit, its settings, its user, its papers, and the scripts of
# biteline-COMPONENT.
function(biteline_daemon_package component what)
  set(program biteline-${component})
  install(FILES host/apps/${program}/systemd/${program}.service DESTINATION lib/systemd/system COMPONENT ${component})
  install(FILES ${parts}/${component}.env DESTINATION /etc/biteline COMPONENT ${component})
  install(FILES ${parts}/biteline.sysusers DESTINATION lib/sysusers.d RENAME ${program}.conf COMPONENT ${component})
  if(TARGET ${program})
    biteline_man_page(${component} ${program} $<TARGET_FILE:${program}> ${what})
  endif()
  biteline_package_papers(${component} ${program} ${ARGN})
  set(scripts)
  foreach(script postinst prerm conffiles)
    configure_file(${parts}/scripts/every/${script}.in ${CMAKE_BINARY_DIR}/package/${component}/${script} @ONLY)
    list(APPEND scripts ${CMAKE_BINARY_DIR}/package/${component}/${script})
  endforeach()
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${program} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION science PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA ${scripts} PARENT_SCOPE)
endfunction()
biteline_daemon_package(host "service of a cell" biteline-host)
biteline_daemon_package(web "page and API of a cell")
biteline_man_page(host biteline $<TARGET_FILE:biteline> "tool: recordings, lines, models, calibration")
list(APPEND CPACK_COMPONENTS_ALL host web)
biteline_package_sbom(host PROGRAMS biteline biteline-host PAGES viewer)
biteline_package_sbom(web PROGRAMS biteline-web PAGES app)

install(TARGETS biteline biteline-host RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT host)
install(DIRECTORY host/robot/path/processes DESTINATION ${CMAKE_INSTALL_DATADIR}/biteline COMPONENT host FILES_MATCHING PATTERN *.yaml)
install(DIRECTORY host/records/reader DESTINATION ${CMAKE_INSTALL_DATADIR}/biteline COMPONENT host FILES_MATCHING PATTERN *.py PATTERN *.hpp PATTERN *.cpp)
install(FILES ${parts}/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME biteline COMPONENT host)
install(FILES README.md LICENSE CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/biteline COMPONENT host)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/biteline COMPONENT host
  FILES_MATCHING PATTERN *.md PATTERN *.png PATTERN *.svg PATTERN site EXCLUDE)
list(APPEND CPACK_DEBIAN_HOST_PACKAGE_CONTROL_EXTRA ${parts}/scripts/host/postrm)
set(CPACK_COMPONENT_HOST_DESCRIPTION "Service and tool that find and follow a shoe's bite line")
set(CPACK_COMPONENT_WEB_DESCRIPTION "Page and API of a Biteline cell")
# `biteline replay` runs the sensor's program.
set(CPACK_DEBIAN_HOST_PACKAGE_RECOMMENDS biteline-firmware)
set(CPACK_DEBIAN_WEB_PACKAGE_SUGGESTS biteline-host)

if(NOT BITELINE_BUILD_FACTORY)
  return()
endif()
biteline_daemon_package(gige "a sensor as a GigE Vision device")
biteline_daemon_package(uplink "a cell's line to the factory's centre")
biteline_daemon_package(fleet "centre of a factory's cells")
foreach(component gige uplink fleet)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  biteline_package_sbom(${component} PROGRAMS biteline-${component})
endforeach()
install(TARGETS biteline-gige RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT gige)
# The centre has none of the cell's documents but its own.
install(FILES docs/fleet.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/biteline-fleet/docs COMPONENT fleet)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/biteline-fleet COMPONENT fleet)
list(APPEND CPACK_DEBIAN_FLEET_PACKAGE_CONTROL_EXTRA ${parts}/scripts/fleet/postrm)
set(CPACK_COMPONENT_GIGE_DESCRIPTION "A Biteline sensor as a GigE Vision device, for software that speaks GenICam")
set(CPACK_COMPONENT_UPLINK_DESCRIPTION "Tells a factory's centre of every shoe of a Biteline cell")
set(CPACK_COMPONENT_FLEET_DESCRIPTION "Centre of a factory's Biteline cells: shoes into PostgreSQL, odd cells, alarms")
# Broker and database may stand on other machines.
set(CPACK_DEBIAN_FLEET_PACKAGE_SUGGESTS "mosquitto, postgresql, prometheus")
