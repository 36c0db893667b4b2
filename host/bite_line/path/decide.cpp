// SPDX-License-Identifier: MIT
#include "host/bite_line/path/decide.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/core/fixed_text.hpp"

namespace biteline::bite_line {

namespace {

// A missing sector of 40 mm may be bridged (it reads 27 to 39 mm over the seeds of bench_line_class); where
// 60 mm of a heel are gone, what is put in their place is off by up to 9 mm.
constexpr double k_longest_unseen_mm = 45.0;
constexpr double k_deg = 3.14159265358979 / 180.0;

/// Smooth yes or no: 0.5 at `middle`, 0.88 two `width`s above it.
double sure(double value, double middle, double width) {
  return 1.0 / (1.0 + std::exp(-(value - middle) / width));
}

/// That the crease lies between two surfaces, sole and upper, and is not sewn or cut into one.  One wall is
/// convex: its flanks turn by -5 to -9 degrees against each other and meet within 0.1 mm.  A flush sole's
/// (0.1 to 0.4 mm) turn by +5 degrees and more (seeds of bench_line_class); a millimetre that the sole stands
/// out says as much as 20 degrees.
double two_surfaces(const Crease& crease) {
  constexpr double k_per_step = 20.0 * k_deg;
  if (!crease.flanks_seen) return 1.0;
  return sure(crease.flank_turn_rad + k_per_step * std::max(crease.flank_step_mm, 0.0), 0.0, 0.8 * k_deg);
}

/// That this crease, looked at alone, goes all the way round, between two surfaces.
double alone(const Crease& crease) {
  const double seen = sure(-crease.longest_unseen_mm, -k_longest_unseen_mm, 1.5);
  // Gaps: a missing sector of 40 mm and a filled stretch as long again may be bridged, not much more.
  return seen * sure(crease.visible_share, 0.70, 0.035) * two_surfaces(crease) *
         sure(crease.median_turn_rad, 5.0 * k_deg, 0.8 * k_deg) * sure(-crease.longest_gap_mm, -100.0, 8.0);
}

/// That what lies below the crease stands out beyond what lies above it, as a sole's edge does.
double stands_out(const Crease& crease) {
  return sure(crease.median_step_mm, 0.3, 0.05) * sure(crease.step_share, 0.7, 0.05);
}

/// That the crease is cut into the sole: the sole's edge, seen on more than half of the way round, lies
/// above.
double below_the_soles_edge(const Crease& crease, const std::vector<Crease>& all) {
  double most = 0;
  for (const Crease& other : all) {
    if (other.mean_height_mm <= crease.mean_height_mm) continue;
    most = std::max(most, sure(other.visible_share, 0.5, 0.03) * two_surfaces(other) * stands_out(other));
  }
  return most * (1 - stands_out(crease));
}

/// For comparing rivals.
double score(const Crease& crease, bool topmost) {
  const double step = 0.4 * std::tanh(crease.median_step_mm / 1.5) +
                      (crease.median_step_mm > 0.15 ? 0.15 * crease.step_share : 0.0);
  return crease.evidence + step + (topmost ? 0.35 : 0.0);
}

/// Why `best` is not the bite line; `second` (optional) is the next best.
std::optional<Refusal> refusal_of(const Crease& best, const Crease* second, bool sure_enough) {
  const auto refusal = [](Refused code, const FixedText<200>& text) {
    return Refusal{.code = code, .reason = text.c_str()};
  };
  using Text = FixedText<200>;
  const auto percent = [](double share) { return 100.0 * share; };
  if (best.longest_unseen_mm > k_longest_unseen_mm && best.evidence > 0.1) {
    return refusal(Refused::TooMuchMissing,
                   Text::format("too much is missing: no surface was seen over %.0f mm of the best path "
                                "round the shoe",
                                best.longest_unseen_mm));
  }
  if (best.seen_share < 0.75 && best.visible_share > 0.7 * best.seen_share && best.evidence > 0.1) {
    return refusal(Refused::TooMuchMissing,
                   Text::format("too much is missing: the surface was seen on %.0f %% of the best path "
                                "round the shoe",
                                percent(best.seen_share)));
  }
  if (best.median_turn_rad < 5.0 * k_deg || best.visible_share < 0.70 || best.longest_gap_mm > 100.0) {
    return refusal(
        Refused::NoCreaseAllRound,
        Text::format("no crease all the way round: the best path shows one on %.0f %% of its "
                     "length, its longest gap is %.0f mm, and the surface turns by %.1f degrees "
                     "across it",
                     percent(best.visible_share), best.longest_gap_mm, best.median_turn_rad / k_deg));
  }
  if (two_surfaces(best) < 0.5) {
    return refusal(Refused::WithinOneSurface,
                   Text::format("no bite line: the crease at a mean height of %.1f mm lies within one "
                                "surface, which goes on below it as above, and not between a sole and an "
                                "upper",
                                best.mean_height_mm));
  }
  if (best.closure_mm > 6.0) {
    return refusal(
        Refused::DoesNotClose,
        Text::format("the crease does not close: its ends lie %.1f mm apart in height", best.closure_mm));
  }
  if (!sure_enough && second != nullptr) {
    return refusal(Refused::TwoCandidates,
                   Text::format("two candidates are about equally good, at mean heights of %.1f and %.1f mm",
                                best.mean_height_mm, second->mean_height_mm));
  }
  if (!sure_enough) return refusal(Refused::NotSureEnough, Text::copy("no crease that is sure enough"));
  return std::nullopt;
}

}  // namespace

Decision decide(const std::vector<Crease>& creases, double min_confidence) {
  Decision decision;
  if (creases.empty()) {
    decision.refusal = Refusal{Refused::NoCrease, "no crease: nothing concave runs round the side"};
    return decision;
  }
  // Topmost among those that go all the way round and are not far weaker than the strongest.
  double strongest = 0;
  for (const Crease& crease : creases)
    strongest = std::max(strongest, alone(crease) > 0.5 ? crease.evidence : 0.0);
  std::size_t topmost = creases.size();
  for (std::size_t i = 0; i < creases.size(); ++i) {
    if (alone(creases[i]) < 0.5 || creases[i].evidence < 0.5 * strongest) continue;
    if (topmost == creases.size() || creases[i].mean_height_mm > creases[topmost].mean_height_mm) topmost = i;
  }
  std::vector<double> alone_of(creases.size()), scores(creases.size());
  for (std::size_t i = 0; i < creases.size(); ++i) {
    alone_of[i] = alone(creases[i]) * (1 - below_the_soles_edge(creases[i], creases));
    scores[i] = score(creases[i], i == topmost) * alone_of[i];
  }
  std::vector<std::size_t> order(creases.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return scores[a] != scores[b] ? scores[a] > scores[b] : creases[a].evidence > creases[b].evidence;
  });
  for (const std::size_t i : order) {
    double rival = -1;
    for (std::size_t j = 0; j < creases.size(); ++j) {
      if (j != i) rival = std::max(rival, scores[j]);
    }
    decision.paths.push_back({.confidence = alone_of[i] * sure(scores[i] - rival, 0.06, 0.03),
                              .row = creases[i].row,
                              .mean_height_mm = creases[i].mean_height_mm,
                              .closure_mm = creases[i].closure_mm,
                              .turn_rad = creases[i].median_turn_rad,
                              .seen_share = creases[i].seen_share});
  }
  decision.confidence = decision.paths.front().confidence;
  decision.refusal = refusal_of(creases[order.front()], order.size() > 1 ? &creases[order[1]] : nullptr,
                                decision.confidence >= min_confidence);
  if (decision.refusal) decision.confidence = std::min(decision.confidence, 0.49);
  return decision;
}

}  // namespace biteline::bite_line
