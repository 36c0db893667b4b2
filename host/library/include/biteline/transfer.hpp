// SPDX-License-Identifier: MIT
#pragma once
/// \file A sample's line on the next upper of its model, whose bite line cannot be seen.

#include <filesystem>
#include <memory>

#include "biteline/cloud.hpp"
#include "biteline/export.hpp"
#include "biteline/line.hpp"

namespace biteline::sdk {

/// A scanned shoe with its line.  What is worked out of it is kept: use one for all uppers of its model.
class BITELINE_API Sample {
 public:
  struct State;  ///< of the library

  Sample(const Cloud& cloud, const Line& line);
  [[nodiscard]] const State& state() const { return *state_; }

 private:
  std::shared_ptr<const State> state_;
};

/// A result folder: cloud.ply and line.csv.  Throws Error.
[[nodiscard]] BITELINE_API Sample read_sample(const std::filesystem::path& folder);

struct TransferOptions {
  bool mirror{false};  ///< the sample is of the other foot
  bool grade{false};   ///< the sample is of another size
};

struct CarriedLine {
  Line line;
  double confidence{0};  ///< mean over the points
  double bound_mm{0};    ///< 19 of 20 points lie nearer than this to the bite line, as far as the scans tell
  double shape_rms_mm{0};  ///< between the two surfaces where they lie on each other
  double bridged_mm{0};    ///< length over gaps of the upper's scan
};

/// Puts the sample on the upper and carries its line over.  Throws Refused where the two do not fit.
[[nodiscard]] BITELINE_API CarriedLine transfer_line(const Sample& sample, const Cloud& upper,
                                                     const TransferOptions& options = {});

}  // namespace biteline::sdk
