# SPDX-License-Identifier: MIT
# cmake --preset release -C boards/sim/board.cmake: this machine.
set(BITELINE_BUILD_CELL ON CACHE BOOL "")
