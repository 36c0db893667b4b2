// SPDX-License-Identifier: MIT
#pragma once
/// \file A program that runs to its end, and what it said.

#include <string>
#include <vector>

#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"

namespace biteline::test {

struct Said {
  int status{0};
  std::string out, last_error;
  int errors{0};  ///< lines of its stderr
};

inline Said said_by(const std::filesystem::path& program, std::vector<std::string> arguments,
                    std::chrono::seconds patience = std::chrono::seconds{60}) {
  auto child = intake::ChildProcess::start({.program = program, .arguments = std::move(arguments)});
  SUCCEEDS(child);
  Said said;
  while (const auto line = child->next_line(patience)) said.out += *line + "\n";
  const auto status = child->wait(patience);
  SUCCEEDS(status);
  said.status = *status;
  said.last_error = child->last_words();
  said.errors = child->stderr_lines();
  return said;
}

}  // namespace biteline::test
