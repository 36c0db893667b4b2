// SPDX-License-Identifier: MIT
#pragma once
/// \file A full disk without a disk: a limit on the size of this program's files.

#include <sys/resource.h>

#include <csignal>

namespace biteline::test {

/// While it lives no file of this program grows beyond `most_bytes`; what is longer stays as it is.
class FullDisk {
 public:
  explicit FullDisk(rlim_t most_bytes = 0) : signal_{std::signal(SIGXFSZ, SIG_IGN)} {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{.rlim_cur = most_bytes, .rlim_max = before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_);
  }

 private:
  rlimit before_{};
  void (*signal_)(int);
};

}  // namespace biteline::test
