// SPDX-License-Identifier: MIT
#include "host/transfer/identify.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/core/fixed_text.hpp"
#include "host/bite_line/side/seam.hpp"
#include "host/transfer/candidates.hpp"
#include "host/transfer/sizes.hpp"

namespace biteline::transfer {
namespace {

// One last differs from the next by about this much, RMS: the spread of the residual of the right model.
constexpr double k_last_difference_mm = 0.1;
// Density of a wrong model's residual where it is accepted at all, below 0.2 mm.  `bench_identify 60` takes
// none of 3540 wrong pairs of made shoes, so with 95 % fewer than three in that number are.
constexpr double k_wrong_per_mm = 3.0 / 3540 / 0.2;
// Graded, strangers come nearer: of 553 pairs of `bench_stream` 4 are below 0.2 mm, 23 below 0.25 and 81
// below 0.3, which is e times as many each 33 um.
constexpr double k_wrong_share = 4.0 / 553, k_wrong_share_at_mm = 0.2, k_wrong_fold_mm = 0.033;
// What tells them is the collar's edge.  Where both scans show it, that of the right model lies on the
// sample's to a twentieth of a millimetre, unless it was cut otherwise.
constexpr double k_edge_of_right = 0.7, k_edge_of_wrong = 0.02;
// One shoe in so many is of no model in the library; each is as likely as the next.
constexpr double k_new_shoe = 0.1;
constexpr double k_sure_probability = 0.6;

double wrong_graded_per_mm(double rms_mm) {
  return k_wrong_share / k_wrong_fold_mm * std::exp((rms_mm - k_wrong_share_at_mm) / k_wrong_fold_mm);
}

/// How much more likely than "none of them" this match is, by Bayes: all others' residuals say the same of
/// both.
double odds(const Match& match, std::size_t matches) {
  if (!match.alignment.accepted()) return 0;
  const double ratio = match.alignment.shape_rms_mm / k_last_difference_mm;
  // Half of a normal distribution.
  const double right_per_mm =
      std::sqrt(2 / std::numbers::pi) / k_last_difference_mm * std::exp(-0.5 * ratio * ratio);
  const double prior = (1 - k_new_shoe) / static_cast<double>(matches) / k_new_shoe;
  if (!match.align.grade) return prior * right_per_mm / k_wrong_per_mm;
  return prior * right_per_mm / wrong_graded_per_mm(match.alignment.shape_rms_mm) *
         (match.alignment.rim_used ? k_edge_of_right / k_edge_of_wrong
                                   : (1 - k_edge_of_right) / (1 - k_edge_of_wrong));
}

bool same_shoe(const Match& a, const Match& b) {
  return a.model == b.model && a.foot == b.foot && a.size == b.size;
}

/// Most probable first; two samples that say the same of the upper count once.
void weigh(std::vector<Match>& matches) {
  double total = 1;  // none of them
  for (std::size_t i = 0; i < matches.size(); ++i) {
    Match& match = matches[i];
    match.probability = odds(match, matches.size());
    const auto said =
        std::find_if(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(i),
                     [&](const Match& other) { return other.probability > 0 && same_shoe(match, other); });
    if (said != matches.begin() + static_cast<std::ptrdiff_t>(i)) {
      Match& less = said->probability < match.probability ? *said : match;
      total -= &less == &match ? 0 : less.probability;
      less.probability = 0;
    }
    total += match.probability;
  }
  for (Match& match : matches) match.probability /= total;
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
    if (a.probability != b.probability) return a.probability > b.probability;
    if (a.compared != b.compared) return a.compared;
    return a.compared && a.alignment.shape_rms_mm < b.alignment.shape_rms_mm;
  });
}

bool fits(const std::vector<Match>& matches) {
  return std::ranges::any_of(matches, [](const Match& match) { return match.alignment.accepted(); });
}

/// "runner (left, EU 42)".
std::string words_of(const Match& match) {
  std::string more = match.foot;
  if (!match.size.empty()) more += (more.empty() ? "" : ", ") + match.size;
  return more.empty() ? match.model : match.model + " (" + more + ")";
}

/// Pre: no match is sure.
Refusal why_none(const Identification& found, std::size_t samples) {
  using Text = FixedText<400>;
  const std::vector<Match>& matches = found.matches;
  const bool any = fits(matches);
  if (any && matches.size() > 1 && matches[1].probability > 0) {
    return {.code = Refused::SeveralModelsFit,
            .reason = Text::format("the upper may be %s (%.2f) or %s (%.2f): name one with --sample",
                                   words_of(matches[0]).c_str(), matches[0].probability,
                                   words_of(matches[1]).c_str(), matches[1].probability)
                          .c_str()};
  }
  if (any) {
    return {.code = Refused::ModelNotSure,
            .reason = Text::format(
                          "the upper looks like %s, but not surely (%.2f): name it with --sample to take it",
                          words_of(matches[0]).c_str(), matches[0].probability)
                          .c_str()};
  }
  Refusal none{.code = Refused::NoModelFits,
               .reason = Text::format("the upper is none of the %zu models in the library", samples).c_str()};
  if (!found.damaged.empty()) {
    none.reason += Text::format("; %zu more are damaged, %s first", found.damaged.size(),
                                found.damaged.front().name.c_str())
                       .c_str();
  }
  return none;
}

/// What was ordered and the shape is not; empty where they agree as far as both speak.
std::string against_order(const Match& match, const ModelOrder& order) {
  if (!order.foot.empty() && !match.foot.empty() && order.foot != match.foot)
    return "a " + order.foot + " shoe was ordered, and this is " + words_of(match);
  const std::optional<SizeLabel> ordered = size_label(order.size), seen = size_label(match.size);
  // A size that is no label is compared as it is written.
  const bool alike = ordered && seen ? ordered->system == seen->system && ordered->number == seen->number
                                     : order.size == match.size;
  const bool other = !order.size.empty() && !match.size.empty() && !alike;
  const bool unseen = !order.size.empty() && match.align.grade && match.size.empty();
  if (other || unseen) {
    return order.size + " was ordered, and this is " +
           (unseen ? words_of(match) + " between two sizes" : words_of(match));
  }
  return {};
}

/// The match that is taken, or why none is.
void decide(const ModelOrder& order, std::size_t samples, Identification& found) {
  const std::vector<Match>& matches = found.matches;
  if (!fits(matches) || matches.front().probability < k_sure_probability) {
    found.refusal = why_none(found, samples);
    return;
  }
  if (std::string words = against_order(matches.front(), order); !words.empty()) {
    found.refusal = Refusal{.code = Refused::OrderDisagrees, .reason = std::move(words)};
    return;
  }
  found.name = matches.front().name;
}

/// What the upper is instead of what was ordered.
Result<Identification> not_as_ordered(const Library& library, const cloud::PointCloud& upper,
                                      const std::string& model) {
  BITELINE_ASSIGN(Identification found, identify(library, upper));
  std::string reason = model + " was ordered, and the upper is none";
  if (!found.name.empty()) reason += "; it looks like " + words_of(found.matches.front());
  found.refusal = Refusal{.code = Refused::OrderDisagrees, .reason = std::move(reason)};
  found.name.clear();
  return found;
}

}  // namespace

Result<Identification> identify(const Library& library, const cloud::PointCloud& upper_cloud,
                                const ModelOrder& order) {
  Identification found;
  std::vector<SavedModel> models;
  if (order.model.empty()) {
    BITELINE_ASSIGN(models, saved_models(library, found.damaged));
  } else {
    BITELINE_ASSIGN(SavedModel model, saved_model(library, order.model));
    models.push_back(std::move(model));
  }
  const Result<Upper> upper = prepare_upper(upper_cloud);
  if (!upper) {
    found.refusal =
        Refusal{.code = Refused::UpperWithoutShoe, .reason = std::string{upper.error().where.view()}};
    return found;
  }
  Candidates candidates{library, models, *upper, found.damaged};
  for (const Round round : {Round::AsTaught, Round::OtherFoot, Round::OtherSize}) {
    std::vector<Match> matches = candidates.compare(round);
    const bool fit = fits(matches);
    if (fit) found.matches.clear();
    std::ranges::move(matches, std::back_inserter(found.matches));
    if (fit) break;
  }
  weigh(found.matches);
  decide(order, candidates.samples(), found);
  if (!found.refusal || found.refusal->code == Refused::OrderDisagrees) return found;
  // A shoe that moved looks like no model, and that is not why.
  if (std::optional<Refusal> moved = why_moved(bite_line::seam_step(upper_cloud)))
    found.refusal = std::move(moved);
  else if (!order.model.empty() && !fits(found.matches))
    return not_as_ordered(library, upper_cloud, order.model);
  return found;
}

}  // namespace biteline::transfer
