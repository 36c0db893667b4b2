// SPDX-License-Identifier: MIT
#include "host/transfer/identify.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/core/fixed_text.hpp"
#include "host/bite_line/side/seam.hpp"
#include "host/transfer/align/rough_fit.hpp"
#include "host/transfer/shape_store.hpp"

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

// So many are compared in any case: a search that has missed the right place costs nobody his model.
constexpr std::size_t k_nearest_compared = 3;

/// The rough fit; nothing of the alignment yet.
Result<Match> rough_match(const ShapeStore& shapes, const std::string& name, const RoughTarget& target,
                          const AlignOptions& options) {
  BITELINE_ASSIGN(const RoughShape shape, shapes.shape_of(name));
  Match match{.name = name, .compared = false};
  if (!options.grade) match.rough_fit_mm = rough_fit_mm(options.mirror ? mirrored(shape) : shape, target);
  match.alignment.verdict = Verdict::OtherModel;
  match.alignment.reason =
      std::isfinite(match.rough_fit_mm)
          ? FixedText<120>::format("set aside: half of its places lie %.1f mm off (at most %.1f mm)",
                                   match.rough_fit_mm, k_most_rough_mm)
                .c_str()
          : "set aside: less than half of it lies on the upper";
  return match;
}

Result<void> compare(const Library& library, const Upper& upper, const AlignOptions& options, Match& match) {
  BITELINE_ASSIGN(const SampleFiles files, library.load(match.name));
  BITELINE_ASSIGN(const Sample sample, prepare_sample(files.cloud, files.line));
  match.alignment = align(sample, upper, options);
  match.compared = true;
  return {};
}

/// Calls `work` for 0 to count - 1 at the same time; puts what failed into `damaged`.
template <class Work>
void for_each_model(const std::vector<std::string>& names, std::vector<ModelInfo>& damaged, Work work) {
  std::vector<Result<void>> done(names.size());
  tbb::parallel_for(std::size_t{0}, names.size(), [&](std::size_t i) { done[i] = work(i); });
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (done[i]) continue;
    ModelInfo model{.name = names[i]};
    model.damage = done[i].error();
    damaged.push_back(std::move(model));
  }
}

/// Every sound model, nearest first, the near ones aligned.
std::vector<Match> matches_of(const Library& library, const std::vector<std::string>& names,
                              const Upper& upper, const AlignOptions& options,
                              std::vector<ModelInfo>& damaged) {
  const ShapeStore shapes{library};
  const RoughTarget target{upper};
  std::vector<std::optional<Match>> rough(names.size());
  for_each_model(names, damaged, [&](std::size_t i) -> Result<void> {
    BITELINE_ASSIGN(Match match, rough_match(shapes, names[i], target, options));
    rough[i] = std::move(match);
    return {};
  });
  std::vector<Match> matches;
  for (std::optional<Match>& match : rough) {
    if (match) matches.push_back(*std::move(match));
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const Match& a, const Match& b) { return a.rough_fit_mm < b.rough_fit_mm; });
  std::vector<std::string> near;
  for (const Match& match : matches) {
    // The nearest in any case: where one model's search missed, a wrong one must not stand alone.
    if (match.rough_fit_mm <= k_most_rough_mm || near.size() < k_nearest_compared) near.push_back(match.name);
  }
  // A file may be damaged unseen until it is read: then the model is none.
  const std::size_t before = damaged.size();
  for_each_model(near, damaged, [&](std::size_t i) { return compare(library, upper, options, matches[i]); });
  matches.erase(std::remove_if(matches.begin(), matches.end(),
                               [&](const Match& match) {
                                 return std::any_of(
                                     damaged.begin() + static_cast<std::ptrdiff_t>(before), damaged.end(),
                                     [&](const ModelInfo& model) { return model.name == match.name; });
                               }),
                matches.end());
  return matches;
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
  BITELINE_ASSIGN(const std::vector<std::string> names, library.names());
  Identification found;
  const Result<transfer::Upper> upper = transfer::prepare_upper(upper_cloud);
  if (!upper) {
    found.refusal =
        Refusal{.code = Refused::UpperWithoutShoe, .reason = std::string{upper.error().where.view()}};
    return found;
  }
  found.matches = matches_of(library, names, *upper, options, found.damaged);

  double total = 1;  // none of them
  for (Match& match : found.matches) {
    match.probability = odds(match.alignment, found.matches.size());
    total += match.probability;
  }
  for (Match& match : found.matches) match.probability /= total;
  // Those set aside stay behind, the nearest first.
  std::stable_sort(found.matches.begin(), found.matches.end(), [](const Match& a, const Match& b) {
    if (a.probability != b.probability) return a.probability > b.probability;
    if (a.compared != b.compared) return a.compared;
    return a.compared && a.alignment.shape_rms_mm < b.alignment.shape_rms_mm;
  });

  const bool any = !found.matches.empty() && found.matches.front().alignment.accepted();
  if (any && found.matches.front().probability >= k_sure_probability) {
    found.name = found.matches.front().name;
    return found;
  }
  // A shoe that moved looks like no model, and that is not why.
  found.refusal = why_moved(bite_line::seam_step(upper_cloud));
  if (!found.refusal) found.refusal = why_none(found, any);
  return found;
}

}  // namespace biteline::transfer
