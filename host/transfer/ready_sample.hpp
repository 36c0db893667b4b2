// SPDX-License-Identifier: MIT
#pragma once
/// \file What is made of a sample before any upper comes: once, for all uppers of its model.

#include <memory>
#include <optional>
#include <vector>

#include "common/core/result.hpp"
#include "host/transfer/align/prepared.hpp"
#include "host/transfer/sample_folder.hpp"

namespace biteline::transfer {

/// Each part is made when it is first asked for.  A service asks before the first scan (make_all()).
/// Thread: any; who asks for a part that another thread makes waits for it.
class ReadySample {
 public:
  explicit ReadySample(std::shared_ptr<const SampleFiles> files);
  explicit ReadySample(SampleFiles files);
  ReadySample(ReadySample&&) noexcept;
  ReadySample& operator=(ReadySample&&) noexcept;
  ~ReadySample();

  [[nodiscard]] const SampleFiles& files() const { return *files_; }
  /// Fails (Refused) where the cloud shows next to nothing above the line.
  [[nodiscard]] const Result<Sample>& prepared() const;
  /// From each point of the line along its level normal to the sample's own wall above: the mean over some
  /// heights above its groove and over a few mm along the line, so that stitches do not count.  Empty where
  /// none is seen anywhere.  Pre: prepared() has a value.
  [[nodiscard]] const std::vector<std::optional<double>>& walls_mm() const;

  void make_all() const;

 private:
  struct Made;

  std::shared_ptr<const SampleFiles> files_;
  std::unique_ptr<Made> made_;
};

}  // namespace biteline::transfer
