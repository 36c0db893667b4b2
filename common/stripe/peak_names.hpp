// SPDX-License-Identifier: MIT
#pragma once
/// \file What peak modes and choices are called on a command line.

#include <map>
#include <string>

#include "common/stripe/peak_extractor.hpp"
#include "common/stripe/peak_selector.hpp"

namespace biteline::stripe {

inline const std::map<std::string, PeakMode> k_peak_modes{{"matched", PeakMode::Matched},
                                                          {"maximum", PeakMode::Maximum},
                                                          {"threshold", PeakMode::Threshold},
                                                          {"centre-of-gravity", PeakMode::CentreOfGravity},
                                                          {"fir", PeakMode::FirZeroCrossing}};

inline const std::map<std::string, PeakChoice> k_peak_choices{{"continuity", PeakChoice::Continuity},
                                                              {"strongest", PeakChoice::Strongest},
                                                              {"first", PeakChoice::First},
                                                              {"last", PeakChoice::Last}};

/// Pre: `value` is in the table.
template <class T>
[[nodiscard]] const std::string& name_of(const std::map<std::string, T>& names, T value) {
  auto row = names.begin();
  while (row->second != value) ++row;
  return row->first;
}

}  // namespace biteline::stripe
