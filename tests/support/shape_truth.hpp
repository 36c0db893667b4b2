// SPDX-License-Identifier: MIT
#pragma once
/// \file The shared data's shapes of public origin as clouds, with the whole line where it is known.

#include <optional>

#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::test {

struct Shape {
  const char* name;  ///< folder in shoes/
  bool mesh;         ///< only a mesh is there: it is sampled
  enum class Truth {
    Line,     ///< shoes/truth/NAME_line.csv, good to about 0.5 mm, 1 mm where the edge is round
    Unknown,  ///< a line, plain to the eye, without truth
    NoLine,   ///< no shoe, or none with a line
  } truth;
};

inline constexpr Shape k_shapes[] = {
    {"s31_leather_hightop", false, Shape::Truth::Line},
    {"s32_ledge_midsole", false, Shape::Truth::Line},
    {"s33_canvas_hightop", false, Shape::Truth::Line},
    {"s34_trail_scan", false, Shape::Truth::Unknown},
    {"n01_slide_sandal", false, Shape::Truth::NoLine},
    {"n02_box_on_base", false, Shape::Truth::NoLine},
    {"s01_airjordan1_scan", true, Shape::Truth::Unknown},
    {"s06_nike_pegasus36", true, Shape::Truth::Unknown},
    {"s15_mit_sneaker", true, Shape::Truth::Unknown},
    {"s24_khronos_shoe_with_part_labels", true, Shape::Truth::Unknown},
    {"s21_smooth_fillet_hightop", true, Shape::Truth::NoLine},
};

struct ShapeTruth {
  cloud::ClosedLine line;  ///< empty: not known
  bool has_none{false};
};

/// Nothing where the data are absent.
[[nodiscard]] std::optional<cloud::PointCloud> cloud_of(const Shape& shape);
[[nodiscard]] std::optional<ShapeTruth> truth_of(const Shape& shape);

struct LineOnShape {
  double mean_mm{0};
  double max_mm{0};
  double mean_unflagged_mm{0};
  double wrong_mm{0};  ///< length off by more than 1 mm and the truth's own, outside flagged points
  double beyond_2mm_unflagged{0};  ///< share of all points
  double flagged{0};               ///< share of all points: confidence below 0.5, or U95 above 1 mm
  double within_u95{0};            ///< share of the judged points: inside U95 and the truth's own error
};

/// Confidence below 0.5, or U95 above 1 mm.
[[nodiscard]] bool is_flagged(const cloud::LinePoint& p);

/// From the line's points to the truth's polyline.  Steps of more than 3 mm in the truth are chords where it
/// is not known: what lies beside one is left out.  `truth_mm`: the truth's own error.
[[nodiscard]] LineOnShape line_on_shape(const cloud::ClosedLine& line, const cloud::ClosedLine& truth,
                                        double truth_mm = 1.0);

}  // namespace biteline::test
