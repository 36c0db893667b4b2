// SPDX-License-Identifier: MIT
#pragma once
/// \file The shared data's meshes of real and drawn shoes, and what is known of their lines.

#include <optional>
#include <string>

#include "host/bite_line/find_bite_line.hpp"

namespace biteline::test {

struct KnownShoe {
  const char* name;  ///< folder in shoes/
  enum class Truth {
    Boundary,  ///< heights of the sole's edge on both sides, in shoes/truth, from 10 to 90 % of the length
    Course,    ///< a parallel groove 8 to 12 mm below the line, which runs between 22 and 38 mm
    NoLine,    ///< a smooth fillet
  } truth;
};

inline constexpr KnownShoe k_known_shoes[] = {
    {"s15_mit_sneaker", KnownShoe::Truth::Boundary},
    {"s24_khronos_shoe_with_part_labels", KnownShoe::Truth::Boundary},
    {"s06_nike_pegasus36", KnownShoe::Truth::Course},
    {"s21_smooth_fillet_hightop", KnownShoe::Truth::NoLine},
};

/// The shoe's mesh as a scanner would see it; nothing where the data are absent.
[[nodiscard]] std::optional<cloud::PointCloud> scan_of(const KnownShoe& shoe);

struct ShoeVerdict {
  bool right;
  double off_mm;    ///< mean height error of the worse side, or the farthest that the line leaves its course;
                    ///< 0: not measured
  std::string why;  ///< when it is not right
};
/// Pre: scan_of() the shoe had a value.
[[nodiscard]] ShoeVerdict judge(const KnownShoe& shoe, const bite_line::Extraction& extraction);

}  // namespace biteline::test
