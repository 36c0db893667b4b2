// SPDX-License-Identifier: MIT
#pragma once
/// \file Reading that nobody waits for.

namespace biteline::fleet {

/// While it lives, what this thread reads waits for whoever else needs the disk.  Where the kernel refuses
/// that, it reads as ever.
class IdleDisk {
 public:
  IdleDisk();
  ~IdleDisk();
  IdleDisk(const IdleDisk&) = delete;
  IdleDisk& operator=(const IdleDisk&) = delete;

 private:
  int before_;  ///< the thread's own priority; -1: it stands as it was
};

}  // namespace biteline::fleet
