// SPDX-License-Identifier: MIT
#pragma once
/// \file Parts that the pages of all results have: figures by names for people, the next step, weak
/// stretches.

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "host/records/results/view/weak_stretches.hpp"
#include "host/report/page.hpp"
#include "host/report/refusal.hpp"

namespace biteline::results {

/// Numbers and words of report.json under names for people, with units; a key without a name keeps its own.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> named_figures(
    const nlohmann::ordered_json& fields);

/// What the person does next, and nothing where there is nothing to do.
void add_next_step(report::Page& page, const report::ToldRefusal& refusal);

/// As report.json says it.
void add_refusal(nlohmann::ordered_json& fields, const report::ToldRefusal& refusal);

/// A table of them under one line that says how much; nothing when there is none.
void add_weak_stretches(report::Page& page, const std::vector<WeakStretch>& stretches);

}  // namespace biteline::results
