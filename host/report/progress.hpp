// SPDX-License-Identifier: MIT
#pragma once
/// \file Progress of long work: one line on stderr, only on a terminal, never with --quiet.

#include <cstddef>
#include <string>

namespace biteline::report {

class Progress {
 public:
  /// `total` 0: unknown.
  Progress(std::string what, std::size_t total, bool quiet);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  ///< clears the line

  void set(std::size_t done);

 private:
  std::string what_;
  std::size_t total_;
  bool shown_;
  int last_percent_{-1};
};

}  // namespace biteline::report
