// SPDX-License-Identifier: MIT
#pragma once
/// \file Values that stand for "nothing measured here": 0 0 0, -9999, the largest float.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace biteline::cloud {

struct NothingValue {
  std::string value;  ///< "0 0 0", "z -9999"
  std::size_t points{0};
};

/// Clears `keep` of the points that stand for nothing, and tells by which value.
///
/// A surface that was measured has no place many times.  One and the same place at a thousandth of the points
/// or more, and three times as often as any other one, is none; the one copy that may be a true point stays
/// where its neighbours are as near as elsewhere.  One and the same z is none where all other heights are
/// farther from it than they are from each other: a table's z goes over into the shoe's.  Points that are not
/// kept already are passed over.
[[nodiscard]] std::vector<NothingValue> leave_out_nothing(std::span<const Eigen::Vector3d> places,
                                                          std::vector<std::uint8_t>& keep);

/// Up to `most` numbers below `count`, spread without a period that a regular grid could have, rising.
[[nodiscard]] std::vector<std::size_t> spread_numbers(std::size_t count, std::size_t most);

}  // namespace biteline::cloud
