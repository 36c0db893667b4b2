#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the arm64 sysroot that the preset `arm64` builds against, and prints its folder.  Seconds when it is there already.
set -euo pipefail
. "$(dirname "$0")/arm64_apt.sh"

# What the firmware and its tests link; headers and libraries only.
packages="libc6-dev libstdc++-12-dev libaravis-dev libcpputest-dev libeigen3-dev libexpected-dev libfmt-dev
  libflatbuffers-dev libgpiod-dev libhwy-dev libspdlog-dev libspng-dev libssl-dev libsystemd-dev libturbojpeg0-dev libusb-1.0-0-dev libyaml-cpp-dev libzmq3-dev libzstd-dev cppzmq-dev libcli11-dev
  nlohmann-json3-dev busybox-static"

mkdir -p "$arm64_cache"
exec 9>"$arm64_cache/lock"
flock 9
sysroot=$arm64_cache/sysroot
wanted=$(echo $packages | md5sum | cut -d' ' -f1)
if [ "$(cat "$sysroot/.biteline" 2>/dev/null)" != "$wanted" ]; then
  {
    arm64_update
    rm -f "$arm64_cache"/apt/archives/*.deb
    arm64_apt install -y --download-only $packages || cannot_fetch $packages
    rm -rf "$sysroot"
    for package in "$arm64_cache"/apt/archives/*.deb; do
      case ${package##*/} in
        # Programs for the other architecture, which the build must never find.
        python3* | dpkg_* | icu-devtools* | tar_* | debconf* | flatbuffers-compiler* | pkg*) ;;
        *) unpack_deb "$package" "$sysroot" ;;
      esac
    done
    rm -f "$arm64_cache"/apt/archives/*.deb
    echo "$wanted" > "$sysroot/.biteline"
  } >&2
fi
echo "$sysroot"
