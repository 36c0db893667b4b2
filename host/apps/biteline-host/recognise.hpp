// SPDX-License-Identifier: MIT
#pragma once
/// \file Which model of the library a scan is, and where that model's line lies on it.

#include <optional>
#include <string>

#include "host/records/memory/memory.hpp"
#include "host/transfer/identify.hpp"

namespace biteline::service {

/// A model is taken without a person at this probability or more, and with no second one above the other.
inline constexpr double k_sure_model = 0.95;
inline constexpr double k_most_second = 0.05;

struct Recognised {
  std::string name;  ///< of the most probable model; empty: none fits
  double probability{0};
  double second{0};  ///< of the next one
  std::optional<transfer::Alignment> alignment{};

  [[nodiscard]] bool sure() const {
    return !name.empty() && probability >= k_sure_model && second <= k_most_second;
  }
  /// "runner-42 (0.97)", or why none is named.
  std::string words;
};

[[nodiscard]] Result<Recognised> recognise(const transfer::Library& library, const cloud::PointCloud& scan);

/// Distance of the scan's line to the model's line where the alignment has put that, at even places of the
/// model's line; outwards above 0, mm.
[[nodiscard]] memory::Places places_of(const cloud::ClosedLine& line, const cloud::ClosedLine& model,
                                       const SE3& T_scan_model);

}  // namespace biteline::service
