// SPDX-License-Identifier: MIT
#pragma once
/// \file Which model, foot and size a scan is of, and where that model's line lies on it.

#include <optional>
#include <string>

#include "host/records/memory/memory.hpp"
#include "host/transfer/identify.hpp"

namespace biteline::service {

/// A model is taken without a person at this probability or more, and with no second one above the other.
inline constexpr double k_sure_model = 0.95;
inline constexpr double k_most_second = 0.05;

/// A model's line where the scan has it.
struct OnScan {
  cloud::ClosedLine line{};
  double sigma_mm{0};  ///< how well it is placed, RMS
};

struct Recognised {
  std::string model;   ///< the most probable one; empty: none fits
  std::string sample;  ///< of that model: whose line and process it is
  std::string foot, size;
  double probability{0};
  double second{0};  ///< of the next one
  transfer::AlignOptions align{};
  std::optional<OnScan> on_scan{};  ///< none: it was taken by its name alone
  std::string words{};              ///< "looks like runner-42 (0.97)", or why none is named

  [[nodiscard]] bool sure() const {
    return !model.empty() && probability >= k_sure_model && second <= k_most_second;
  }
};

/// By the shape, and by the order as far as it goes; what disagrees is nothing sure.
[[nodiscard]] Result<Recognised> recognise(const transfer::Library& library, const cloud::PointCloud& scan,
                                           const transfer::ModelOrder& order);

/// As somebody has named it.  Of several samples the shape tells which one it is; where it fits none of them
/// the word stands all the same, and there is no `on_scan`.  A foot or a size that the shape is not makes it
/// unsure.
/// Fails (FileNotFound) where there is no such model.
[[nodiscard]] Result<Recognised> take_named(const transfer::Library& library, const cloud::PointCloud& scan,
                                            const transfer::ModelOrder& order);

/// Distance of the scan's line to the model's line on it, at even places of the model's line; outwards above
/// 0, mm.
[[nodiscard]] memory::Places places_of(const cloud::ClosedLine& line, const cloud::ClosedLine& model);

}  // namespace biteline::service
