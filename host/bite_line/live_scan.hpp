// SPDX-License-Identifier: MIT
#pragma once
/// \file The bite line of a scan that is still running.

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "host/bite_line/find_bite_line.hpp"
#include "host/cloud/uncertainty/arm_sway.hpp"

namespace biteline::bite_line {

/// Profiles are reduced as they come, so that only the closing steps remain when the last one is in: axes,
/// height field and path from the reduced points, the line's place from the raw ones.  find_bite_line() takes
/// an organised cloud the same way, so the line is that of the finished cloud, whatever the order in which
/// profiles came. Thread: one at a time.  Memory: 22 bytes per point, 25 with its stripe.
class LiveScan {
 public:
  /// Points of one profile in base, in the order of the stripe.  One that is here already, by its sequence
  /// number, is left out: after a broken connection profiles may come twice.
  /// `pose`: where the arm was, for the line's uncertainty.  `stripe`: at these points, for the materials.
  void add_profile(std::uint64_t sequence, std::span<const Eigen::Vector3f> points,
                   const std::optional<uncertainty::ProfilePose>& pose = {},
                   const cloud::StripeSpan& stripe = {});
  [[nodiscard]] std::size_t points() const { return raw_.size(); }
  [[nodiscard]] std::size_t profiles() const { return profiles_.size(); }
  /// May be called at any time, also more than once: the line as far as seen, or why there is none yet.
  [[nodiscard]] Extraction finish(const Config& config, std::optional<Workings>* workings = nullptr) const;

 private:
  struct Profile {
    std::uint64_t sequence{0};
    std::size_t first_raw{0};
    std::size_t points{0};
    std::size_t first_run{0};
    std::optional<uncertainty::ProfilePose> pose{};
  };
  [[nodiscard]] bool in_order() const;
  [[nodiscard]] LiveScan ordered() const;

  std::unordered_set<std::uint64_t> sequences_;
  std::vector<Profile> profiles_;
  std::vector<Eigen::Vector3f> raw_;
  std::vector<Eigen::Vector3f> means_;    ///< of runs of neighbours
  std::vector<std::uint32_t> first_raw_;  ///< of each run
  std::vector<RunLook> looks_;            ///< of each run; empty as long as no profile came with its stripe
  uncertainty::ArmSway arm_;
};

}  // namespace biteline::bite_line
