#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# kernel.sh plain|rt: Debian's arm64 kernel with the test modules that Debian does not build, fetched and built once;
# prints its folder: vmlinuz, version, modules/ (a tree for modprobe -d).
# gpio-sim, irq_sim, the DMA heap and ptp_mock are the kernel's own sources, taken from Debian's packages and never kept here.
set -euo pipefail
. "$(dirname "$0")/../../toolchains/arm64_apt.sh"

flavour=${1:?plain or rt}
case $flavour in
  plain) metapackage=linux-image-arm64 common=common ;;
  rt) metapackage=linux-image-rt-arm64 common=common-rt ;;
  *) echo "kernel.sh: plain or rt expected" >&2; exit 2 ;;
esac
work=$arm64_cache/kernel
mkdir -p "$work/packages"
exec 9>"$work/lock"
flock 9

# fetch PACKAGE: the newest of our own index; what is there already is not fetched again.
fetch() {
  ls "$work"/packages/"$1"_*.deb >/dev/null 2>&1 || (cd "$work/packages" && arm64_apt download "$1" >&2) \
    || cannot_fetch "$1"
}

# kernel_source SERIES FILE...: those files of Debian's source of that series, into sources/SERIES.
kernel_source() {
  local series=$1 file missing=()
  shift
  for file in "$@"; do [ -s "$work/sources/$series/$file" ] || missing+=("linux-source-$series/$file"); done
  [ ${#missing[@]} -eq 0 ] && return
  fetch "linux-source-$series"
  mkdir -p "$work/sources/$series"
  # tar stops at the last file wanted and breaks the pipe, which is as it should be; what counts is checked below.
  dpkg-deb --fsys-tarfile "$work"/packages/linux-source-"$series"_*.deb 2>/dev/null \
    | tar -xO "./usr/src/linux-source-$series.tar.xz" 2>/dev/null \
    | tar -xJ --occurrence=1 --strip-components=1 -C "$work/sources/$series" "${missing[@]}" 2>/dev/null || true
  for file in "$@"; do [ -s "$work/sources/$series/$file" ] || { echo "kernel.sh: no $file in $series" >&2; exit 1; }; done
  rm -f "$work"/packages/linux-source-"$series"_*.deb
}

has_ptp_mock() { [ -s "$work/sources/6.12/drivers/ptp/ptp_mock.c" ]; }

# build_modules VERSION FOLDER: our wrappers round the kernel's own drivers.
build_modules() {
  local version=$1 folder=$2 headers="$work/headers-$1"
  rm -rf "$folder" "$headers"
  mkdir -p "$folder/linux" "$headers"
  fetch "linux-headers-$version"
  local common_package="linux-headers-${version%%-rt-arm64}"
  common_package="${common_package%-arm64}-$common"
  fetch "$common_package"
  ls "$work"/packages/linux-kbuild-6.1_*.deb >/dev/null 2>&1 || (cd "$work/packages" && apt-get -q download linux-kbuild-6.1 >&2) \
    || cannot_fetch linux-kbuild-6.1
  for package in "linux-headers-$version" "$common_package" linux-kbuild-6.1; do
    dpkg-deb -x "$work"/packages/"$package"_*.deb "$headers"
  done
  sed -i "s#include /usr/src#include $headers/usr/src#" "$headers/usr/src/linux-headers-$version/Makefile"

  cp "$work"/sources/6.1/drivers/gpio/gpio-sim.c "$work"/sources/6.1/drivers/gpio/gpiolib.h \
    "$work"/sources/6.1/kernel/irq/irq_sim.c "$work"/sources/6.1/drivers/dma-buf/dma-heap.c \
    "$work"/sources/6.1/drivers/dma-buf/heaps/system_heap.c "$folder/"
  if has_ptp_mock; then
    cp "$work"/sources/6.12/drivers/ptp/ptp_mock.c "$folder/"
    cp "$work"/sources/6.12/include/linux/ptp_mock.h "$folder/linux/"
  fi
  cp "$(dirname "$0")"/modules/* "$folder/"
  make -s -C "$headers/usr/src/linux-headers-$version" M="$folder" ARCH=arm64 CROSS_COMPILE=aarch64-linux-gnu- \
    CONFIG_DEBUG_INFO_BTF_MODULES= modules >"$folder.log" 2>&1 || { cat "$folder.log" >&2; exit 1; }
}

arm64_update >&2
image=$(arm64_apt_cache depends "$metapackage" | sed -n 's/^ *Depends: //p' | grep '^linux-image-' | head -1)
version=${image#linux-image-}
# Anew when what is built, or how, changed.
ready=$work/ready-$version-$(cat "$0" "$(dirname "$0")"/modules/* | md5sum | cut -c 1-8)
if [ ! -e "$ready/done" ]; then
  rm -rf "$ready" "$work/image"
  mkdir -p "$ready/modules"
  fetch "$image"
  dpkg-deb -x "$work"/packages/"$image"_*.deb "$work/image"
  kernel_source 6.1 drivers/gpio/gpio-sim.c drivers/gpio/gpiolib.h kernel/irq/irq_sim.c drivers/dma-buf/dma-heap.c \
    drivers/dma-buf/heaps/system_heap.c
  # Newer than Debian 12's first kernel: only where the archive of its security updates is among the sources.
  (kernel_source 6.12 drivers/ptp/ptp_mock.c include/linux/ptp_mock.h 2>/dev/null) || has_ptp_mock \
    || echo "kernel.sh: no linux-source-6.12: without the mock PTP clock" >&2
  build_modules "$version" "$work/build-$version"
  cp "$work/image/boot/vmlinuz-$version" "$ready/vmlinuz"
  mkdir -p "$ready/modules/lib"
  cp -r "$work/image/lib/modules" "$ready/modules/lib/"
  mkdir -p "$ready/modules/lib/modules/$version/extra"
  cp "$work/build-$version"/*.ko "$ready/modules/lib/modules/$version/extra/"
  depmod -b "$ready/modules" "$version"
  echo "$version" > "$ready/version"
  rm -rf "$work/image" "$work/build-$version" "$work/headers-$version" "$work"/packages/linux-image*.deb
  touch "$ready/done"
fi
echo "$ready"
