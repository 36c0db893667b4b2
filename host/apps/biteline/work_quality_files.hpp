// SPDX-License-Identifier: MIT
#pragma once
/// \file What `biteline work-quality` reads of second looks, and the pages of studies.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/study/gage_study.hpp"
#include "host/study/performance.hpp"
#include "host/study/wear.hpp"

namespace biteline::app {

/// One shoe's work, by its second look.
struct ShoeWork {
  std::string name;                               ///< of the look's folder
  double planned_width_mm{0}, tolerance_mm{0};    ///< of an edge, as the look was judged
  std::optional<double> width_mm{}, off_mm{};     ///< means over the line: width; middle above its plan
  double least_width_mm{0}, largest_width_mm{0};  ///< along the line
  int places{0};                                  ///< that were worked and have both edges
};

/// Of a folder that `biteline inspect` wrote.  One that tells no band (refused, nothing worked) has no width.
[[nodiscard]] Result<ShoeWork> read_shoe_work(const std::filesystem::path& folder);

/// One quantity over the shoes, in their order.
struct QualityStudy {
  std::string title;
  study::Limits limits{};
  std::vector<study::TrendPoint> points;  ///< x: number of the shoe, from 1
  study::Performance performance{};
  std::optional<study::Trend> trend{};  ///< from 3 shoes on
  std::optional<study::Crossing> crossing{};
};
/// Of the wear, as a sentence.
[[nodiscard]] std::string trend_words(const QualityStudy& of);
/// Points, limits and trend, as SVG.
[[nodiscard]] std::string trend_picture(const QualityStudy& of);

[[nodiscard]] Result<void> write_quality_page(const std::vector<QualityStudy>& studies, int left_out,
                                              const std::filesystem::path& folder);
/// With the readings' file by name.
[[nodiscard]] Result<void> write_gage_page(const study::GageStudy& study, const std::string& input,
                                           const std::filesystem::path& folder);

}  // namespace biteline::app
