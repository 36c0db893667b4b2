// SPDX-License-Identifier: MIT
#pragma once
/// \file Which scans keep their messages (scan.btln) beside the result.

#include <string>

#include "common/core/result.hpp"

namespace biteline::service {

/// Thread: one at a time.
class KeptRecordings {
 public:
  /// "all", "refused", "none", or a number N: each Nth scan.  Errc::InvalidArgument says what is expected.
  [[nodiscard]] static Result<KeptRecordings> parse(const std::string& words);

  /// A scan has ended; asked once for each.  `refused`: line or path was, or a person rejected it.
  [[nodiscard]] bool keeps(bool refused);

  /// What is kept is what was refused: no more of it than --keep-refused-gb.
  [[nodiscard]] bool is_bounded() const { return which_ == Which::Refused; }

 private:
  enum class Which { None, All, Refused, EachNth };
  Which which_{Which::None};
  unsigned each_{1};
  unsigned ended_{0};
};

}  // namespace biteline::service
