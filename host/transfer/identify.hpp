// SPDX-License-Identifier: MIT
#pragma once
/// \file Which of the saved models an upper is, and how sure that is.

#include <optional>
#include <string>
#include <vector>

#include "host/transfer/align/alignment.hpp"
#include "host/transfer/library.hpp"
#include "host/transfer/refused.hpp"

namespace biteline::transfer {

struct Match {
  std::string name;
  double probability{0};   ///< among all models and none of them
  bool compared{true};     ///< else set aside by its rough fit, with an alignment that is not accepted
  double rough_fit_mm{0};  ///< see rough_fit.hpp; 0: not asked for
  transfer::Alignment alignment{};
};

struct Identification {
  std::string name;                ///< empty when refused
  std::optional<Refusal> refusal;  ///< why no model is named
  std::vector<Match> matches;      ///< every sound model: most probable first, then the nearest
  std::vector<ModelInfo> damaged;  ///< left out
};

/// Aligns every model with the upper that its rough fit does not rule out, the nearest three where it rules
/// out all; a cloud without a shoe is refused.  A model is named when it alone fits; two that both fit are
/// told and not chosen from.  Of other sizes (AlignOptions::grade) all models are aligned.
[[nodiscard]] Result<Identification> identify(const Library& library, const cloud::PointCloud& upper,
                                              const transfer::AlignOptions& options);

}  // namespace biteline::transfer
