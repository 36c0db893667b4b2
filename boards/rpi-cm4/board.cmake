# SPDX-License-Identifier: MIT
# cmake --preset arm64 -C boards/rpi-cm4/board.cmake: no GigE Vision camera on this board.
set(BITELINE_WITH_ARAVIS OFF CACHE BOOL "")
set(BITELINE_BOARD rpi-cm4 CACHE STRING "Whose files the package installs as its own")
