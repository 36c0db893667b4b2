// SPDX-License-Identifier: MIT
#include "host/bite_line/path/decide.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "common/core/contracts.hpp"
#include "common/core/fixed_text.hpp"
#include "host/geometry/logistic.hpp"

namespace biteline::bite_line {

namespace {

constexpr double k_deg = std::numbers::pi / 180.0;

using Sentence = FixedText<240>;

/// A gate: passed for sure well above the limit, 0.5 at it, 0.88 two softnesses above.
struct Gate {
  Refused code;
  double value;
  double limit;
  double softness;
  Sentence reason;
  bool soft{false};  ///< a no asks for a person

  [[nodiscard]] double sure() const { return geometry::logistic((value - limit) / softness); }
};

double sure(double value, double limit, double softness) {
  return Gate{.code = Refused::NoCrease, .value = value, .limit = limit, .softness = softness, .reason = {}}
      .sure();
}

// A missing sector of 40 mm may be bridged (it reads 27 to 39 mm over the seeds of bench_line_class); where
// 60 mm of a heel are gone, what is put in their place is off by up to 9 mm.
constexpr double k_longest_unseen_mm = 45.0;
// A missing sector and a filled stretch as long again may be bridged, not much more.
constexpr double k_longest_gap_mm = 100.0;
constexpr double k_least_visible_share = 0.70;
constexpr double k_least_seen_share = 0.75;
constexpr double k_least_turn_deg = 5.0;
constexpr double k_least_evidence = 0.1;  // of a bare upper: below 0.01
// A strap or a tongue is no upper; a missing sector of 40 mm in a child's shoe leaves nine tenths.
constexpr double k_least_upper_share = 0.8;
// Made shoes and shapes of public origin read 0.97 and more, the edge of a fixture's plate below 0.21.
constexpr double k_least_sole_share = 0.5;
// A lid overhangs what is below it, by a millimetre and more.
constexpr double k_least_step_mm = -0.6;
// A line with more than a tenth of its length on a layer that may be another's is a person's to look at.
constexpr double k_most_rivalled_share = 0.1;
// A crease that shows over most of the way round is a line whose gaps a person settles.
constexpr double k_most_of_it = 0.5;

/// The crease lies between two surfaces, sole and upper, and is not sewn or cut into one.  One wall is
/// convex: its flanks turn by -5 to -9 degrees against each other and meet within 0.1 mm.  A flush sole's
/// (0.1 to 0.4 mm) turn by +5 degrees and more (seeds of bench_line_class); a millimetre that the sole stands
/// out says as much as 20 degrees.
double between_two_deg(const Crease& crease) {
  constexpr double k_deg_per_mm = 20.0;
  if (!crease.flanks_seen) return 90.0;
  return crease.flank_turn_rad / k_deg + k_deg_per_mm * std::max(crease.flank_step_mm, 0.0);
}

/// That the crease is cut into the sole: the bite line is the highest crease between two surfaces, and
/// another one that is plain to see goes round above, however strong a ledge below may be.  A sole goes on
/// above a ledge by some 20 mm at most; a collar lies higher.
double cut_into_sole(const Layers& layers) {
  constexpr double k_thickest_mm = 30.0;
  double most = 0;
  for (const Rival& rival : layers.rivals) {
    const Crease& above = rival.crease;
    if (!rival.above || !rival.all_round) continue;
    if (above.mean_height_mm > layers.line.mean_height_mm + k_thickest_mm) continue;
    const double plain = std::max(sure(above.visible_share, 0.5, 0.03),
                                  sure(above.median_turn_rad / k_deg, k_least_turn_deg, 0.8));
    most = std::max(most, plain * sure(between_two_deg(above), 0.0, 0.8));
  }
  return most;
}

double share_below_half(const std::vector<float>& hold) {
  if (hold.empty()) return 1;
  return static_cast<double>(std::count_if(hold.begin(), hold.end(), [](float h) { return !(h >= 0.5F); })) /
         static_cast<double>(hold.size());
}

/// What takes most of the line's length, for the sentence.
Sentence rivalled_text(const Layers& layers, double share) {
  const Rival* longest = nullptr;
  for (const Rival& rival : layers.rivals) {
    if (longest == nullptr || rival.cols > longest->cols) longest = &rival;
  }
  if (longest == nullptr)
    return Sentence::format("the line keeps no layer on %.0f %% of its length", 100 * share);
  return Sentence::format(
      "the line may be another crease on %.0f %% of its length: one at a mean height of %.1f mm "
      "is about as good as that at %.1f mm",
      100 * share, longest->crease.mean_height_mm, layers.line.mean_height_mm);
}

JudgedPath judged(const Crease& crease, bool passes, double confidence) {
  return {.passes = passes,
          .confidence = confidence,
          .row = crease.row,
          .mean_height_mm = crease.mean_height_mm,
          .turn_rad = crease.median_turn_rad,
          .seen_share = crease.seen_share,
          .lacks = {}};
}

/// Per column; `hold` as in Layers, empty where it is another path than the best.
std::vector<std::uint8_t> lacks_of(const Crease& crease, const std::vector<float>& hold) {
  // A crease that nobody described column by column.
  if (crease.turn_rad.size() != crease.row.size() || crease.upper.size() != crease.row.size()) return {};
  std::vector<std::uint8_t> lacks(crease.row.size(), 0);
  const auto mark = [&](std::size_t c, bool is_there, Lack lack) {
    if (!is_there) lacks[c] |= static_cast<std::uint8_t>(lack);
  };
  for (std::size_t c = 0; c < lacks.size(); ++c) {
    const bool seen = !std::isnan(crease.turn_rad[c]);
    mark(c, seen, Lack::Surface);
    mark(c, crease.visible[c] != 0, Lack::Crease);
    // What was not seen is not said to have none.
    mark(c, !seen || crease.upper[c] != 0, Lack::Upper);
    mark(c, !seen || crease.sole[c] != 0, Lack::Sole);
    mark(c, c >= hold.size() || hold[c] >= 0.5F, Lack::Layer);
  }
  return lacks;
}

double percent(double share) {
  return 100.0 * share;
}

/// The gates that look at one crease alone.
auto own_gates(const Crease& line, const PlanShape& plan) {
  constexpr ShoeOutlines shoes{};
  const Sentence all_round = Sentence::format(
      "no crease all the way round: the best path shows one on %.0f %% of its length, its longest gap is "
      "%.0f mm, "
      "and the surface turns by %.1f degrees across it",
      percent(line.visible_share), line.longest_gap_mm, line.median_turn_rad / k_deg);
  // Where hardly a crease is there at all, the path may lie wherever nothing was seen.
  const bool worth_seeing = line.visible_share > 0.7 * line.seen_share && line.visible_share > 0.3;
  const bool mostly = line.visible_share > k_most_of_it;
  return std::array{
      Gate{Refused::NotAShoe, -distance_to_shoes(plan, shoes), -shoes.limit, shoes.softness,
           Sentence::format(
               "not a shoe: its outline is broadest at %.2f of its length (shoes: about %.2f), and over that "
               "%.2f broad at an end (%.2f) and %.2f at the heel (%.2f)",
               plan.broadest_at, shoes.mean[0], plan.end_breadth, shoes.mean[1], plan.heel_breadth,
               shoes.mean[2])},
      Gate{Refused::NoCrease, line.evidence, k_least_evidence, 0.02,
           Sentence::copy("no crease: nothing concave runs round the side")},
      Gate{Refused::TooMuchMissing, worth_seeing ? -line.longest_unseen_mm : 0.0, -k_longest_unseen_mm, 1.5,
           Sentence::format(
               "too much is missing: no surface was seen over %.0f mm of the best path round the shoe",
               line.longest_unseen_mm)},
      Gate{Refused::TooMuchMissing, worth_seeing ? line.seen_share : 1.0, k_least_seen_share, 0.02,
           Sentence::format(
               "too much is missing: the surface was seen on %.0f %% of the best path round the shoe",
               percent(line.seen_share))},
      Gate{Refused::NoCreaseAllRound, line.visible_share, k_least_visible_share, 0.035, all_round, mostly},
      Gate{Refused::NoCreaseAllRound, -line.longest_gap_mm, -k_longest_gap_mm, 8.0, all_round, mostly},
      Gate{Refused::NoCreaseAllRound, line.median_turn_rad / k_deg, k_least_turn_deg, 0.8, all_round},
      Gate{Refused::NoUpper, line.upper_share, k_least_upper_share, 0.03,
           Sentence::format(
               "no upper: above the crease a wall goes on over %.0f %% of its length only, as on an open "
               "sandal or a rim",
               percent(line.upper_share))},
      Gate{Refused::NoSole, line.sole_share, k_least_sole_share, 0.05,
           Sentence::format("no sole: over %.0f %% of the crease's length nothing shows below it, as where "
                            "something stands on a table or a plate",
                            percent(1 - line.sole_share))},
      // A second ledge close below bends the lower flank; what stands out behind that, too, is a lid.
      Gate{Refused::Overhang, line.flanks_seen ? std::max(line.flank_step_mm, line.median_step_mm) : 0.0,
           k_least_step_mm, 0.1,
           Sentence::format(
               "no bite line: what lies above the crease stands out by %.1f mm beyond what lies below it, "
               "as a lid does",
               -line.flank_step_mm)},
      Gate{Refused::WithinOneSurface, between_two_deg(line), 0.0, 0.8,
           Sentence::format(
               "no bite line: the crease at a mean height of %.1f mm lies within one surface, which goes "
               "on below it as above, and not between a sole and an upper",
               line.mean_height_mm)},
  };
}

/// Of a crease that shows over most of its length.
bool is_gap(const Gate& gate) {
  return gate.code == Refused::NoCreaseAllRound && gate.soft;
}

/// Every gate says yes, and all of them together hardly.
Refusal not_sure(double confidence, double least, const Gate& worst) {
  return {.code = Refused::NotSure,
          .reason = FixedText<240>::format(
                        "no gate says no, and together they leave a confidence of %.2f (at least %.2f); the "
                        "least sure of them is %s, with %.2f",
                        confidence, least, report::refusal_row(worst.code).name, worst.sure())
                        .c_str()};
}

/// What each gate of decide()'s table measures, in the table's order.  A limit from above is kept below zero
/// there.
struct Measure {
  const char* name;
  bool at_most{false};
};
constexpr std::array k_measures{
    Measure{"off_shoes", true},
    Measure{"evidence"},
    Measure{"longest_unseen_mm", true},
    Measure{"seen_share"},
    Measure{"visible_share"},
    Measure{"longest_gap_mm", true},
    Measure{"turn_deg"},
    Measure{"upper_share"},
    Measure{"sole_share"},
    Measure{"step_out_mm"},
    Measure{"between_two_deg"},
    Measure{"moved_mm", true},
    Measure{"cut_into_sole", true},
    Measure{"rivalled_share", true},
};

std::vector<SeenGate> told(std::span<const Gate> gates) {
  BITELINE_EXPECTS(gates.size() == k_measures.size());
  std::vector<SeenGate> seen;
  for (std::size_t i = 0; i < gates.size(); ++i) {
    const Gate& gate = gates[i];
    const bool at_most = k_measures[i].at_most;
    seen.push_back({.code = gate.code,
                    .measure = k_measures[i].name,
                    .value = at_most ? std::abs(gate.value) : gate.value,
                    .limit = at_most ? std::abs(gate.limit) : gate.limit,
                    .at_most = at_most,
                    .sure = gate.sure(),
                    .soft = gate.soft});
  }
  return seen;
}

bool all_pass(std::span<const Gate> gates) {
  return std::ranges::all_of(gates, [](const Gate& gate) { return gate.sure() >= 0.5; });
}

}  // namespace

double sure_alone(const Crease& line) {
  double product = 1;
  for (const Gate& gate : own_gates(line, {}))
    if (gate.code != Refused::NotAShoe) product *= gate.sure();
  return product;
}

Decision decide(const Layers& layers, const PlanShape& plan, const std::optional<SeamStep>& seam,
                double min_confidence) {
  const Crease& line = layers.line;
  const double rivalled = share_below_half(layers.hold);
  const auto own = own_gates(line, plan);
  const std::array beside_others{
      Gate{Refused::DoesNotClose, -seam.value_or(SeamStep{}).moved_mm, -k_most_moved_mm, 0.03,
           does_not_close(seam.value_or(SeamStep{}))},
      Gate{Refused::CutIntoSole, -cut_into_sole(layers), -0.5, 0.12,
           Sentence::format(
               "no bite line: the crease at a mean height of %.1f mm belongs to the sole, whose edge "
               "shows above it but less plainly",
               line.mean_height_mm),
           true},
      Gate{Refused::Rivalled, -rivalled, -k_most_rivalled_share, 0.01, rivalled_text(layers, rivalled), true},
  };
  std::vector<Gate> gates{own.begin(), own.end()};
  gates.insert(gates.end(), beside_others.begin(), beside_others.end());

  Decision decision;
  decision.of_line = 1;
  const Gate* worst = &gates.front();
  const Gate* no = nullptr;
  for (const Gate& gate : gates) {
    const double sure = gate.sure();
    const bool says_no = !(sure >= 0.5);
    // How much is rivalled is counted column by column below, and a gap of a crease that shows elsewhere
    // where it is bridged.
    const bool counted_elsewhere = &gate == &gates.back() || (says_no && is_gap(gate));
    if (!counted_elsewhere) decision.of_line *= sure;
    if (sure < worst->sure()) worst = &gate;
    if (says_no && (no == nullptr || (no->soft && !gate.soft))) no = &gate;
  }
  double held = 0;
  for (const float hold : layers.hold)
    held += static_cast<double>(hold) / static_cast<double>(layers.hold.size());
  decision.confidence = decision.of_line * held;
  const double most = 0.99 * min_confidence;
  if (no != nullptr) {
    decision.refusal = Refusal{.code = no->code, .reason = no->reason.c_str()};
    decision.for_review = no->soft;
    decision.confidence = std::min({decision.confidence, no->soft ? 1.0 : no->sure(), most});
  } else if (!(decision.confidence >= min_confidence)) {
    decision.refusal = not_sure(decision.confidence, min_confidence, *worst);
    decision.for_review = true;
    decision.confidence = std::min(decision.confidence, most);
  }
  decision.gates = told(gates);
  decision.paths.push_back(judged(line, all_pass(own), decision.confidence));
  decision.paths.back().lacks = lacks_of(line, layers.hold);
  for (const Rival& rival : layers.rivals)
    decision.paths.push_back(judged(rival.crease, all_pass(own_gates(rival.crease, plan)),
                                    std::min(1 - decision.of_line, 0.99 * min_confidence)));
  return decision;
}

}  // namespace biteline::bite_line
