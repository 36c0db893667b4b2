// SPDX-License-Identifier: MIT
#pragma once
/// \file How a factory grades, as two samples of one model in two sizes show it.

#include <array>

#include "common/core/result.hpp"
#include "host/transfer/align/alignment.hpp"
#include "host/transfer/transfer.hpp"

namespace biteline::transfer {

struct TaughtGrading {
  GradingLaw law{};        ///< for the first sample; see law_from()
  Grade between{};         ///< of the first sample to the second one
  double shape_rms_mm{0};  ///< of the surfaces that are left over
};

/// `sample` and `other` are of one model and foot, or with `mirror` of both feet.  Their lines tell heights
/// that their walls hardly do.  Fails (Refused) where they are no sizes of one model, or of nearly one size.
[[nodiscard]] Result<TaughtGrading> teach_grading(const Sample& sample, const Sample& other,
                                                  bool mirror = false);

/// The same law told from a shoe that `between` leads to: what takes a share of the length from the one takes
/// another one from the other.
[[nodiscard]] GradingLaw law_from(const GradingLaw& law, const Grade& between);

/// The line on an upper of any size, by the sample that is nearer in size; `samples` are of one model and
/// foot in two sizes.  Fails as teach_grading().
[[nodiscard]] Result<Transfer> transfer_by_two(const std::array<const ReadySample*, 2>& samples,
                                               const cloud::PointCloud& upper, TransferOptions options);

}  // namespace biteline::transfer
