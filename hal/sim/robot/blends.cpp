// SPDX-License-Identifier: MIT
#include "hal/sim/robot/blends.hpp"

#include "common/core/fixed_text.hpp"

namespace biteline::sim {
namespace {

/// A move along which blends are made; nothing for everything else.
const MoveStep* straight_to_pose(const ScriptStep& step) {
  const auto* move = std::get_if<MoveStep>(&step);
  return move != nullptr && move->kind != MoveStep::Kind::Joint && move->T_base_tcp ? move : nullptr;
}

}  // namespace

std::vector<std::string> skip_overlapping_blends(Script& script) {
  // Goals are written to a ten-thousandth of a millimetre, radii to a hundredth.
  constexpr double k_rounding_mm = 0.01;
  std::vector<std::string> warnings;
  std::vector<ScriptStep> kept;
  std::optional<MoveStep> before;
  std::size_t number = 0;
  for (const ScriptStep& step : script.steps) {
    number += std::holds_alternative<MoveStep>(step) ? 1 : 0;
    const MoveStep* move = straight_to_pose(step);
    const bool switches =
        std::holds_alternative<DigitalOutStep>(step) || std::holds_alternative<TextStep>(step);
    if (move != nullptr && before) {
      const double apart_mm = (move->T_base_tcp->translation() - before->T_base_tcp->translation()).norm();
      if (before->blend_mm + move->blend_mm > apart_mm + k_rounding_mm) {
        warnings.emplace_back(
            FixedText<160>::format("Overlapping Blends in a move command: move %zu skipped, "
                                   "%.2f + %.2f mm round goals %.2f mm apart",
                                   number, before->blend_mm, move->blend_mm, apart_mm)
                .view());
        continue;
      }
    }
    if (move != nullptr) {
      before = *move;
    } else if (!switches) {
      before.reset();
    }
    kept.push_back(step);
  }
  script.steps = std::move(kept);
  return warnings;
}

}  // namespace biteline::sim
