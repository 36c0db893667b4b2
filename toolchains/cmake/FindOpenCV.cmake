# SPDX-License-Identifier: MIT
# OpenCV by its component packages (libopencv-imgproc-dev, ...).  Debian ships OpenCVConfig.cmake only with libopencv-dev,
# which brings VTK and a gigabyte along for viz, which nothing here uses.
# Targets opencv_<component>, as OpenCV's own configuration names them.
include(FindPackageHandleStandardArgs)

find_path(OpenCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
set(OpenCV_required OpenCV_INCLUDE_DIR)
foreach(component IN LISTS OpenCV_FIND_COMPONENTS)
  find_library(OpenCV_${component}_LIBRARY opencv_${component})
  mark_as_advanced(OpenCV_${component}_LIBRARY)
  list(APPEND OpenCV_required OpenCV_${component}_LIBRARY)
  if(OpenCV_INCLUDE_DIR AND OpenCV_${component}_LIBRARY)
    set(OpenCV_${component}_FOUND TRUE)
    if(NOT TARGET opencv_${component})
      add_library(opencv_${component} UNKNOWN IMPORTED GLOBAL)
      set_target_properties(opencv_${component} PROPERTIES
        IMPORTED_LOCATION ${OpenCV_${component}_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${OpenCV_INCLUDE_DIR}
        INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${OpenCV_INCLUDE_DIR})
    endif()
  endif()
endforeach()
mark_as_advanced(OpenCV_INCLUDE_DIR)
find_package_handle_standard_args(OpenCV REQUIRED_VARS ${OpenCV_required} HANDLE_COMPONENTS)
