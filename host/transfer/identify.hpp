// SPDX-License-Identifier: MIT
#pragma once
/// \file Which of the saved models an upper is, of which foot and size, and how sure that is.

#include <optional>
#include <string>
#include <vector>

#include "host/cloud/closed_line.hpp"
#include "host/transfer/align/alignment.hpp"
#include "host/transfer/library.hpp"
#include "host/transfer/models.hpp"
#include "host/transfer/refused.hpp"

namespace biteline::transfer {

/// One sample, taken in one way.
struct Match {
  std::string name;        ///< the sample's, in the library
  std::string model;       ///< that it is of
  std::string foot, size;  ///< of the upper, if this is right; empty: the sample does not tell
  AlignOptions align{};    ///< mirrored, graded and by which law
  double probability{0};   ///< among all that were compared and none of them
  bool compared{true};     ///< else set aside by its rough fit, with an alignment that is not accepted
  double rough_fit_mm{0};  ///< see rough_fit.hpp
  Alignment alignment{};
  cloud::ClosedLine line{};  ///< the sample's, where the alignment has put it; empty where none is accepted
};

struct Identification {
  std::string name;                ///< of the sample to take; empty when refused
  std::optional<Refusal> refusal;  ///< why none is named
  std::vector<Match> matches;      ///< of sound samples: most probable first, then the nearest
  std::vector<ModelInfo> damaged;  ///< left out
};

/// Looks for the upper in three rounds, each only where the one before has found nothing: every sample as it
/// was taught; samples whose foot is told, mirrored; samples whose size is told, graded by their model's law,
/// and mirrored where their foot is told.  A shoe like the sample itself is known better than any other.
///
/// In each round every sample is aligned that its rough fit does not rule out, in the last one the nearest
/// three at least.  A model is named when it alone fits.  Two that both fit are told and not chosen from, and
/// so is an upper that is not what was ordered.
/// Fails (FileNotFound) where no such model is saved as was ordered.
[[nodiscard]] Result<Identification> identify(const Library& library, const cloud::PointCloud& upper,
                                              const ModelOrder& order = {});

}  // namespace biteline::transfer
