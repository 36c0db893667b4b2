// SPDX-License-Identifier: MIT
#pragma once
/// \file What is thrown: a failure, or a refusal of readable input.

#include <stdexcept>
#include <string>

#include "biteline/export.hpp"

namespace biteline::sdk {

/// A failure that the world caused: a missing file, damaged contents, a sensor that is not there.
/// what() is one line: what, and where.
class BITELINE_API Error : public std::runtime_error {
 public:
  Error(const std::string& what, std::string next_step);
  ~Error() override;
  /// The one thing that a person can do; empty where there is none.
  [[nodiscard]] const std::string& next_step() const { return next_step_; }

 private:
  std::string next_step_;
};

/// Input that can be read, and gives no result that can be trusted.  what() is the reason, with its figures.
class BITELINE_API Refused : public Error {
 public:
  Refused(std::string reason_code, const std::string& reason, std::string next_step);
  ~Refused() override;
  /// A name that never changes once it was released, as "no_crease"; docs/formats.md lists all of them.
  [[nodiscard]] const std::string& reason_code() const { return reason_code_; }

 private:
  std::string reason_code_;
};

}  // namespace biteline::sdk
