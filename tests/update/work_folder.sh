# SPDX-License-Identifier: MIT
# work_folder NAME: a new folder, in memory where programs may run there: what is written is waited for at every step.
work_folder() {
  local place=${TMPDIR:-/tmp}
  if [ -w /dev/shm ] && ! findmnt -no OPTIONS /dev/shm | grep -q noexec; then place=/dev/shm; fi
  mktemp -d "$place/$1-XXXXXX"
}
