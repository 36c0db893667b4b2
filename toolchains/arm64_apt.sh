# SPDX-License-Identifier: MIT
# Sourced: Debian's arm64 packages fetched beside this system and not into it, so that no amd64 twin is ever removed and no
# right is needed.  An apt of its own folder, for an empty arm64 system, resolves what belongs together.
#
# BITELINE_ARM64_CACHE  where everything is kept (default ~/.cache/biteline/arm64)

arm64_cache=${BITELINE_ARM64_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/biteline/arm64}

# arm64_tool TOOL ARGUMENT...: apt-get or apt-cache of that folder.
arm64_tool() {
  local tool=$1
  shift
  mkdir -p "$arm64_cache"/apt/lists/partial "$arm64_cache"/apt/archives/partial
  touch "$arm64_cache/apt/status"
  "$tool" -q -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Install-Recommends=false \
    -o Dir::State="$arm64_cache/apt" -o Dir::State::lists="$arm64_cache/apt/lists" \
    -o Dir::State::status="$arm64_cache/apt/status" -o Dir::Cache="$arm64_cache/apt" \
    -o APT::Sandbox::User="$(id -un)" -o Debug::NoLocking=true "$@"
}
arm64_apt() { arm64_tool apt-get "$@"; }
arm64_apt_cache() { arm64_tool apt-cache "$@"; }

# What cannot be fetched ends the caller with 77: a machine without network skips these tests.
cannot_fetch() {
  echo "skipped: cannot fetch $* (no network?)" >&2
  exit 77
}

# arm64_update: once a day is enough.  apt-get update tells a failed download by warnings only, so the index is looked for.
arm64_update() {
  [ -z "$(find "$arm64_cache/apt/updated" -mtime -1 2>/dev/null)" ] || return 0
  arm64_apt update
  [ -n "$(find "$arm64_cache/apt/lists" -name '*arm64_Packages*' -print -quit)" ] || cannot_fetch "Debian's arm64 index"
  touch "$arm64_cache/apt/updated"
}

# unpack_deb FILE FOLDER: files only, no scripts; the folder's lib, bin and sbin are links into usr.
unpack_deb() {
  mkdir -p "$2/usr/lib" "$2/usr/bin" "$2/usr/sbin"
  for name in lib bin sbin; do ln -sfn "usr/$name" "$2/$name"; done
  dpkg-deb --fsys-tarfile "$1" | tar -x --keep-directory-symlink -C "$2"
}
