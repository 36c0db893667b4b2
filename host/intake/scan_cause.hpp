// SPDX-License-Identifier: MIT
#pragma once
/// \file What of a scan itself keeps a shoe from being seen: poses, light, lost pictures.  Asked before
/// anybody says that there is no shoe.

#include <optional>
#include <utility>

#include "common/wire/messages.hpp"
#include "host/intake/cloud_builder.hpp"
#include "host/intake/refused.hpp"

namespace biteline::intake {

/// From this share on profiles that cannot be used, or that are lost, decide what is seen of a shoe.
inline constexpr double k_many_unusable_ratio = 0.1;
/// From this share on profiles without stripe do; the ends of a scan beside the shoe have none either.
inline constexpr double k_many_without_stripe_ratio = 0.5;

/// Why a scan in which no line was found shows too little to say anything of a shoe: poses, lost pictures,
/// the stripe.  Nothing: what was seen counts, and so does what was said of it.
/// `devices`: of a live scan.
[[nodiscard]] std::optional<Refusal> scan_cause(const IngestCounts& counts, const wire::Counters& sensor,
                                                const wire::Devices* devices = nullptr);

/// As the cause of no result, an Extraction's or a Transfer's.
template <class Found>
void tell_scan_cause(Found& found, report::ToldRefusal cause) {
  found.scan_cause = std::move(cause);
  if constexpr (requires { found.line; }) found.line = {};
}

/// Names that cause in what was found, an Extraction or a Transfer, where it was not found.  A line that a
/// person would have to settle is none then: a better scan shows more than a hand.
template <class Found>
void name_scan_cause(Found& found, const IngestCounts& counts, const wire::Counters& sensor,
                     const wire::Devices* devices = nullptr) {
  if (found.found) return;
  if (const std::optional<Refusal> cause = scan_cause(counts, sensor, devices))
    tell_scan_cause(found, report::told(*cause));
}

/// "12 of 815 profiles can be used: no pose (803)".
[[nodiscard]] std::string usable_words(const IngestCounts& counts, const wire::Counters& sensor);

}  // namespace biteline::intake
