// SPDX-License-Identifier: MIT
#include "host/transfer/identify.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/fixed_text.hpp"

namespace biteline::transfer {
namespace {

// One last differs from the next by about this much, RMS: the spread of the residual of the right model.
constexpr double k_last_sigma_mm = 0.1;
// "None of them" fits as well as the worst model that is still accepted.
constexpr double k_none_rms_mm = 0.2;
constexpr double k_sure_probability = 0.6;

double likelihood(double rms_mm) {
  return std::exp(-0.5 * rms_mm * rms_mm / (k_last_sigma_mm * k_last_sigma_mm));
}

std::optional<Match> match_of(const Library& library, const std::string& name, const transfer::Upper& upper,
                              const transfer::AlignOptions& options) {
  const Result<SampleFiles> files = library.load(name);
  if (!files) return std::nullopt;
  const Result<transfer::Sample> sample = transfer::prepare_sample(files->cloud, files->line);
  if (!sample) return std::nullopt;
  return Match{.name = name, .alignment = transfer::align(*sample, upper, options)};
}

/// Pre: no match is sure; `any`: the best one fits.
Refusal why_none(const Identification& found, bool any) {
  using Text = FixedText<300>;
  const std::vector<Match>& matches = found.matches;
  if (any && matches.size() > 1 && matches[1].alignment.accepted()) {
    return {.code = Refused::SeveralModelsFit,
            .reason = Text::format("the upper may be %s (%.2f) or %s (%.2f): name one with --sample",
                                   matches[0].name.c_str(), matches[0].probability, matches[1].name.c_str(),
                                   matches[1].probability)
                          .c_str()};
  }
  if (any) {
    return {.code = Refused::ModelNotSure,
            .reason = Text::format(
                          "the upper looks like %s, but not surely (%.2f): name it with --sample to take it",
                          matches[0].name.c_str(), matches[0].probability)
                          .c_str()};
  }
  Refusal none{
      .code = Refused::NoModelFits,
      .reason = Text::format("the upper is none of the %zu models in the library", matches.size()).c_str()};
  if (!found.damaged.empty()) {
    none.reason += Text::format("; %zu more are damaged, %s first", found.damaged.size(),
                                found.damaged.front().name.c_str())
                       .c_str();
  }
  return none;
}

}  // namespace

Result<Identification> identify(const Library& library, const cloud::PointCloud& upper_cloud,
                                const transfer::AlignOptions& options) {
  BITELINE_ASSIGN(const std::vector<ModelInfo> models, library.list());
  Identification found;
  const Result<transfer::Upper> upper = transfer::prepare_upper(upper_cloud);
  if (!upper) {
    found.refusal =
        Refusal{.code = Refused::UpperWithoutShoe, .reason = std::string{upper.error().where.view()}};
    return found;
  }
  std::vector<std::string> names;
  for (const ModelInfo& model : models) {
    if (model.damage) {
      found.damaged.push_back(model);
    } else {
      names.push_back(model.name);
    }
  }
  std::vector<std::optional<Match>> matches(names.size());
  tbb::parallel_for(std::size_t{0}, names.size(),
                    [&](std::size_t i) { matches[i] = match_of(library, names[i], *upper, options); });

  double total = likelihood(k_none_rms_mm);
  for (std::optional<Match>& match : matches) {
    if (!match) continue;
    match->probability = match->alignment.accepted() ? likelihood(match->alignment.shape_rms_mm) : 0;
    total += match->probability;
    found.matches.push_back(std::move(*match));
  }
  for (Match& match : found.matches) match.probability /= total;
  std::stable_sort(found.matches.begin(), found.matches.end(), [](const Match& a, const Match& b) {
    return a.probability != b.probability ? a.probability > b.probability
                                          : a.alignment.shape_rms_mm < b.alignment.shape_rms_mm;
  });

  const bool any = !found.matches.empty() && found.matches.front().alignment.accepted();
  if (any && found.matches.front().probability >= k_sure_probability) {
    found.name = found.matches.front().name;
  } else {
    found.refusal = why_none(found, any);
  }
  return found;
}

}  // namespace biteline::transfer
