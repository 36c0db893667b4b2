# SPDX-License-Identifier: MIT
# What a cell's PC gets: biteline-host (service, tool, processes, documents), biteline-web (page and API), and where
# other software is to see the sensor, biteline-gige.
# Included by BitelinePackage.cmake.
set(parts ${CMAKE_SOURCE_DIR}/toolchains/package)
set(man ${CMAKE_BINARY_DIR}/man)
file(MAKE_DIRECTORY ${man})

# The manual pages are the programs' own words: made where the programs can run.
set(pages)
foreach(program "biteline;tool: recordings, lines, models, calibration" "biteline-host;service of a cell"
    "biteline-web;page and API of a cell" "biteline-gige;a sensor as a GigE Vision device")
  list(GET program 0 name)
  list(GET program 1 what)
  if(TARGET ${name} AND NOT CMAKE_CROSSCOMPILING)
    add_custom_command(OUTPUT ${man}/${name}.1
      COMMAND ${parts}/man_page.sh $<TARGET_FILE:${name}> ${PROJECT_VERSION} ${what} ${man}/${name}.1
      DEPENDS ${name} ${parts}/man_page.sh
      VERBATIM)
    list(APPEND pages ${man}/${name}.1)
  endif()
endforeach()
add_custom_target(biteline_man ALL DEPENDS ${pages})

install(TARGETS biteline biteline-host RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT host)
install(FILES host/apps/biteline-host/systemd/biteline-host.service DESTINATION lib/systemd/system COMPONENT host)
install(DIRECTORY host/robot/path/processes DESTINATION ${CMAKE_INSTALL_DATADIR}/biteline COMPONENT host FILES_MATCHING PATTERN *.yaml)
install(DIRECTORY host/records/reader DESTINATION ${CMAKE_INSTALL_DATADIR}/biteline COMPONENT host FILES_MATCHING PATTERN *.py PATTERN *.hpp PATTERN *.cpp)
install(FILES ${parts}/host.sysusers DESTINATION lib/sysusers.d RENAME biteline-host.conf COMPONENT host)
install(FILES ${parts}/host.env DESTINATION /etc/biteline COMPONENT host)
install(FILES ${parts}/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME biteline COMPONENT host)
install(FILES README.md LICENSE CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/biteline COMPONENT host)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/biteline COMPONENT host
  FILES_MATCHING PATTERN *.md PATTERN *.png PATTERN *.svg)
install(FILES ${man}/biteline.1 ${man}/biteline-host.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT host OPTIONAL)

install(FILES host/apps/biteline-web/systemd/biteline-web.service DESTINATION lib/systemd/system COMPONENT web)
install(FILES ${parts}/web.sysusers DESTINATION lib/sysusers.d RENAME biteline-web.conf COMPONENT web)
install(FILES ${parts}/web.env DESTINATION /etc/biteline COMPONENT web)
install(FILES ${man}/biteline-web.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT web OPTIONAL)

install(TARGETS biteline-gige RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT gige)
install(FILES host/apps/biteline-gige/systemd/biteline-gige.service DESTINATION lib/systemd/system COMPONENT gige)
install(FILES ${parts}/gige.sysusers DESTINATION lib/sysusers.d RENAME biteline-gige.conf COMPONENT gige)
install(FILES ${parts}/gige.env DESTINATION /etc/biteline COMPONENT gige)
install(FILES ${man}/biteline-gige.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT gige OPTIONAL)

list(APPEND CPACK_COMPONENTS_ALL host web gige)
foreach(component host web gige)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME biteline-${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA
    "${parts}/scripts/${component}/postinst;${parts}/scripts/${component}/prerm;${parts}/scripts/${component}/conffiles")
endforeach()
list(APPEND CPACK_DEBIAN_HOST_PACKAGE_CONTROL_EXTRA ${parts}/scripts/host/postrm)
set(CPACK_COMPONENT_HOST_DESCRIPTION "Service and tool that find and follow a shoe's bite line")
set(CPACK_COMPONENT_WEB_DESCRIPTION "Page and API of a Biteline cell")
set(CPACK_COMPONENT_GIGE_DESCRIPTION "A Biteline sensor as a GigE Vision device, for software that speaks GenICam")
# `biteline replay` runs the sensor's program.
set(CPACK_DEBIAN_HOST_PACKAGE_RECOMMENDS biteline-firmware)
set(CPACK_DEBIAN_WEB_PACKAGE_SUGGESTS biteline-host)
