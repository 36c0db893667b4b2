// SPDX-License-Identifier: MIT
#include "host/report/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace biteline::report {

Progress::Progress(std::string what, std::size_t total, bool quiet)
    : what_{std::move(what)}, total_{total}, shown_{!quiet && ::isatty(STDERR_FILENO) == 1} {}

Progress::~Progress() {
  if (shown_ && last_percent_ >= 0) std::fputs("\r\033[K", stderr);
}

void Progress::set(std::size_t done) {
  if (!shown_) return;
  const int percent = total_ > 0 ? static_cast<int>(100 * done / total_) : 0;
  if (total_ > 0 && percent == last_percent_) return;
  last_percent_ = percent;
  if (total_ > 0) {
    std::fprintf(stderr, "\r\033[K%s %d %% (%zu of %zu)", what_.c_str(), percent, done, total_);
  } else {
    std::fprintf(stderr, "\r\033[K%s %zu", what_.c_str(), done);
  }
  std::fflush(stderr);
}

}  // namespace biteline::report
