// SPDX-License-Identifier: MIT
#include "host/transfer/identify.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/core/fixed_text.hpp"

namespace biteline::transfer {
namespace {

// One last differs from the next by about this much, RMS: the spread of the residual of the right model.
constexpr double k_last_sigma_mm = 0.1;
// Density of a wrong model's residual where it is accepted at all, below 0.2 mm.  `bench_identify 60` takes
// none of 3540 wrong pairs of made shoes, so with 95 % fewer than three in that number are.
constexpr double k_wrong_per_mm = 3.0 / 3540 / 0.2;
// One shoe in so many is of no model in the library; each model is as likely as the next.
constexpr double k_new_shoe = 0.1;
constexpr double k_sure_probability = 0.6;

/// Density of the residual of the right model, 1/mm: half of a normal distribution.
double right_per_mm(double rms_mm) {
  const double ratio = rms_mm / k_last_sigma_mm;
  return std::sqrt(2 / std::numbers::pi) / k_last_sigma_mm * std::exp(-0.5 * ratio * ratio);
}

/// How much more likely than "none of them" this model is, by Bayes: all others' residuals say the same of
/// both.
double odds(const transfer::Alignment& alignment, std::size_t models) {
  if (!alignment.accepted()) return 0;
  const double prior = (1 - k_new_shoe) / static_cast<double>(models) / k_new_shoe;
  return prior * right_per_mm(alignment.shape_rms_mm) / k_wrong_per_mm;
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

  double total = 1;  // none of them
  for (std::optional<Match>& match : matches) {
    if (!match) continue;
    match->probability = odds(match->alignment, matches.size());
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
