// SPDX-License-Identifier: MIT
#pragma once
/// \file Where on a line a person should look: its weak stretches, with place, length and likely error.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::results {

/// Which side of the shoe is the inner one, as its outline tells: the toe bends inwards.
enum class InnerSide { Unknown, Left, Right };

/// A run of points that are flagged, less sure than 0.5, or whose U95 is above 1 mm.
struct WeakStretch {
  double from_mm{0};  ///< along the line, from its first row
  double length_mm{0};
  double least_confidence{1};
  double u95_mm{0};  ///< the largest; out of the confidence where the line has none
  bool u95_is_guessed{false};
  double bridged_share{0};  ///< of its points: no crease was seen there
  Vec3 begin_base{Vec3::Zero()}, middle_base{Vec3::Zero()}, end_base{Vec3::Zero()};
  std::string place{};  ///< "toe", "heel", "left side, middle", with "(inner)" or "(outer)" where it is known
};

/// In the order of the line; runs less than 3 mm apart are one.  `T_base_shoe`: x heel to toe, y left.
[[nodiscard]] std::vector<WeakStretch> weak_stretches(const cloud::ClosedLine& line, const SE3& T_base_shoe);

/// The inner side, from the middle of the line's two sides at heel, ball and toe; Unknown below 2 mm of bend.
[[nodiscard]] InnerSide inner_side(const cloud::ClosedLine& line, const SE3& T_base_shoe);

/// U95 of a point of this confidence, when nothing else is known: confidence is the probability of less than
/// 0.3 mm, and the error in the plane across the line is taken as Rayleigh's.  mm, at most 10.
[[nodiscard]] double u95_of_confidence_mm(double confidence);

/// For report.json; `line_length_mm`: of the whole line, > 0.
[[nodiscard]] nlohmann::ordered_json as_json(const std::vector<WeakStretch>& stretches,
                                             double line_length_mm);

/// "2 weak stretches, 14.2 mm in all, the likely error up to 1.3 mm"; empty when there is none.
[[nodiscard]] std::string warning(const std::vector<WeakStretch>& stretches);

}  // namespace biteline::results
