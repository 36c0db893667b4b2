// SPDX-License-Identifier: MIT
#pragma once
/// \file The samples that an upper may be of, compared with it round by round.

#include <optional>
#include <vector>

#include "host/transfer/identify.hpp"
#include "host/transfer/shape_store.hpp"
#include "host/transfer/sizes.hpp"

namespace biteline::transfer {

/// See identify().
enum class Round { AsTaught, OtherFoot, OtherSize };

/// Keeps references to all that it is made of.
class Candidates {
 public:
  /// `damaged` gets the samples that cannot be read.
  Candidates(const Library& library, const std::vector<SavedModel>& models, const Upper& upper,
             std::vector<ModelInfo>& damaged);

  [[nodiscard]] std::size_t samples() const;
  /// Nearest first.
  [[nodiscard]] std::vector<Match> compare(Round round);

 private:
  /// A sample taken in one way, and where sizes are told, what its model's others say of them.
  struct Candidate {
    Match match;
    double length{1};  ///< of the upper to the sample's, by the rough fit
    double length_mm{0};
    std::optional<SizeScale> scale{};
    std::optional<Error> damage{};
  };

  [[nodiscard]] std::vector<Candidate> of(Round round) const;
  [[nodiscard]] Result<void> take_rough_fit(Candidate& candidate) const;
  /// By its model's own law where two of its samples teach one.
  [[nodiscard]] Result<void> grade_by_model(Candidate& candidate) const;
  [[nodiscard]] Result<void> align(Candidate& candidate) const;
  /// Of each model and foot the sample that needs the least grading.
  [[nodiscard]] static std::vector<Candidate> nearest_in_size(std::vector<Candidate> candidates);
  [[nodiscard]] bool is_last(Round round) const;
  /// Calls `work` for each at the same time; what fails goes, with its sample, to the damaged.
  template <class Work>
  void for_each(std::vector<Candidate>& candidates, Work work);

  const Library& library_;
  const std::vector<SavedModel>& models_;
  const Upper& upper_;
  std::vector<ModelInfo>& damaged_;
  ShapeStore shapes_;
  RoughTarget target_;
};

}  // namespace biteline::transfer
