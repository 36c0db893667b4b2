#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# boot.sh plain|rt BUILD COMMAND PROGRAM... [-- FILE...]: boots Debian's arm64 kernel with the test devices in QEMU, runs
# COMMAND in it, and leaves with its status.  PROGRAMs (of the arm64 build folder BUILD) and FILEs stand in /test.
# Exit 77 and the reason when this machine lacks a tool.  BITELINE_VM_SECONDS limits the run (420).
# BITELINE_VM_QEMU adds arguments for QEMU, e.g. a forwarded port; BITELINE_VM_MODULES adds modules of the kernel's.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
flavour=$1 build=$2 command=$3
shift 3

for tool in qemu-system-aarch64 dtc fdtoverlay cpio depmod modprobe aarch64-linux-gnu-objdump; do
  PATH=$PATH:/sbin:/usr/sbin command -v "$tool" >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
for name in "$@"; do
  [ "$name" != -- ] || break
  [ -e "$build/$name" ] || { echo "skipped: no $build/$name"; exit 77; }
done
PATH=$PATH:/sbin:/usr/sbin
sysroot=$("$root/toolchains/arm64_sysroot.sh")
kernel=$("$here/kernel.sh" "$flavour")
version=$(cat "$kernel/version")
work=$(mktemp -d "${TMPDIR:-/tmp}/biteline-vm-XXXXXX")
trap 'rm -rf "$work"' EXIT

# The root file system: busybox, modules in the order of loading, programs with the libraries they name.
fs=$work/fs
mkdir -p "$fs"/{bin,sbin,lib,proc,sys,dev,test,modules}
cp "$here/init" "$fs/init"
cp "$sysroot/bin/busybox" "$fs/bin/busybox"
for applet in sh mount umount mkdir cat echo uname insmod ip sync poweroff ls sleep dmesg ps kill mv grep; do
  ln -s busybox "$fs/bin/$applet"
done

vivid="n_devs=1 node_types=0x101 num_inputs=2 input_types=0x3 num_outputs=1 output_types=0x1 no_error_inj=0"
add_module() {
  modprobe -d "$kernel/modules" -S "$version" --show-depends "$1" | while read -r action path _; do
    [ "$action" = insmod ] || continue
    local file=${path##*/}
    if [ ! -e "$fs/modules/$file" ]; then
      cp "$path" "$fs/modules/$file"
      echo "/modules/$file $([ "$file" != vivid.ko ] || echo "$vivid")" >> "$fs/modules/list"
    fi
  done
}
ptp=biteline-ptp-mock
if [ ! -e "$kernel/modules/lib/modules/$version/extra/$ptp.ko" ]; then
  ptp=
  command="export BITELINE_WITHOUT_PTP=1; $command"
fi
for module in configfs virtio_pci virtio_mmio virtio_net vcan can-raw pwm-bcm2835 softdog vivid biteline-gpio-sim $ptp biteline-dma-heap \
  ${BITELINE_VM_MODULES:-}; do
  add_module "$module"
done

# library NAME: where it is; the sysroot first, then the cross compiler's own.
library() {
  local folder
  for folder in "$sysroot/usr/lib/aarch64-linux-gnu" "$sysroot/usr/lib" /usr/aarch64-linux-gnu/lib; do
    [ ! -e "$folder/$1" ] || { echo "$folder/$1"; return; }
  done
  echo "boot.sh: no $1 in the sysroot" >&2
  return 1
}

# add_libraries PROGRAM: what it needs, and what that needs.
add_libraries() {
  local name found
  for name in $(aarch64-linux-gnu-objdump -p "$1" | sed -n 's/^ *NEEDED *//p'); do
    [ ! -e "$fs/lib/$name" ] || continue
    found=$(library "$name")
    cp -L "$found" "$fs/lib/$name"
    add_libraries "$found"
  done
}
while [ $# -gt 0 ]; do
  if [ "$1" = -- ]; then
    shift
    cp -r "$@" "$fs/test/"
    break
  fi
  aarch64-linux-gnu-strip -o "$fs/test/${1##*/}" "$build/$1"
  add_libraries "$build/$1"
  shift
done
cp -L "$(library ld-linux-aarch64.so.1)" "$fs/lib/"
if [ -z "$ptp" ] && [ -e "$fs/test/board.yaml" ]; then sed -i '/^ptp:/d' "$fs/test/board.yaml"; fi
echo "$command" > "$fs/test/command"
chmod +x "$fs/init"
(cd "$fs" && find . | cpio --quiet -o -H newc | gzip -1) > "$work/initrd"

machine=(-machine virt -cpu cortex-a72 -smp 2 -m 256 -accel tcg)
qemu-system-aarch64 "${machine[@]}" -nodefaults -nographic -machine dumpdtb="$work/virt.dtb" 2>"$work/dtb.log" || { cat "$work/dtb.log" >&2; exit 1; }
dtc -q -@ -I dts -O dtb -o "$work/overlay.dtbo" "$root/boards/qemu-virt/dts/biteline-qemu-virt.dtso"
fdtoverlay -i "$work/virt.dtb" -o "$work/board.dtb" "$work/overlay.dtbo"

# QEMU leaves with 0 whatever happened inside: only the guest's own line counts.
timeout --foreground -k 5 "${BITELINE_VM_SECONDS:-420}" qemu-system-aarch64 "${machine[@]}" -nographic -no-reboot -nodefaults \
  -serial stdio -kernel "$kernel/vmlinuz" -initrd "$work/initrd" -dtb "$work/board.dtb" \
  -append "console=ttyAMA0 panic=-1 quiet" ${BITELINE_VM_QEMU:-} </dev/null | tee "$work/console"
status=$(tr -d '\r' < "$work/console" | sed -n 's/^BITELINE-VM status //p' | tail -1)
[ -n "$status" ] || { echo "boot.sh: the machine never told its status"; exit 1; }
exit "$status"
