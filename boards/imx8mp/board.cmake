# SPDX-License-Identifier: MIT
# cmake --preset arm64 -C boards/imx8mp/board.cmake: no camera behind V4L2 on this board.
set(BITELINE_WITH_V4L2 OFF CACHE BOOL "")
set(BITELINE_BOARD imx8mp CACHE STRING "Whose files the package installs as its own")
