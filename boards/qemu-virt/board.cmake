# SPDX-License-Identifier: MIT
# cmake --preset arm64 -C boards/qemu-virt/board.cmake
set(BITELINE_BOARD qemu-virt CACHE STRING "Whose files the package installs as its own")
