// SPDX-License-Identifier: MIT
#include "host/records/results/coverage_result.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>

#include "common/core/fixed_text.hpp"
#include "host/records/results/pictures/shoe_view.hpp"
#include "host/robot/path/coverage.hpp"
#include "host/robot/path/zones.hpp"

namespace biteline::results {
namespace {

namespace fs = std::filesystem;
using path::CoveredSection;
using path::CoveredSurface;

cv::Vec3b colour_of(std::uint8_t times) {
  static const cv::Vec3b k_bare{200, 200, 200}, k_once{90, 170, 60}, k_again{40, 60, 210};
  if (times == 0) return k_bare;
  return times == 1 ? k_once : k_again;
}

/// x y z red green blue times, binary, little-endian.
Result<void> write_cloud(const fs::path& file, const std::vector<Eigen::Vector3f>& points,
                         const std::vector<std::uint8_t>& times) {
  static_assert(std::endian::native == std::endian::little);
  std::string text = FixedText<400>::format(
                         "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty float x\n"
                         "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
                         "property uchar blue\nproperty uchar times\nend_header\n",
                         points.size())
                         .c_str();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Vec3b colour = colour_of(times[i]);
    const std::array<std::uint8_t, 4> bytes{colour[2], colour[1], colour[0], times[i]};
    text.append(reinterpret_cast<const char*>(points[i].data()), 3 * sizeof(float));
    text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  return report::write_file_atomically(file, text);
}

/// x from heel to toe, as far as the line tells.
SE3 place_of(const cloud::ClosedLine& line) {
  std::vector<Vec3> places;
  for (const cloud::LinePoint& p : line.points) places.push_back(p.position);
  const Vec2 ahead = path::shoe_ends(places).heel_to_toe;
  return geometry::make_se3(
      Eigen::Quaterniond{Eigen::AngleAxisd{std::atan2(ahead.y(), ahead.x()), Vec3::UnitZ()}}, places.front());
}

Result<void> write_drawing(const fs::path& file, const path::PlanRequest& request,
                           const std::vector<std::uint8_t>& times) {
  cloud::PointCloud cloud;
  cloud.points = request.cloud;
  std::vector<cv::Vec3b> colours;
  std::ranges::transform(times, std::back_inserter(colours), colour_of);
  ShoeView view{cloud, place_of(request.line)};
  view.draw_cloud(colours);
  view.caption("what the tool covers: once (green), again (red)");
  return write_picture(file, view.picture());
}

}  // namespace

Result<void> write_coverage(const fs::path& folder, const path::PlanRequest& request,
                            const path::PlanOutcome& outcome, report::Report& report) {
  if (!outcome.path || request.cloud.empty() || !(path::covered_width_mm(request.process) > 0)) return {};
  const Eigen::Isometry3f T_base_line = request.T_line_base.inverse().cast<float>();
  std::vector<Eigen::Vector3f> points = request.cloud;
  for (Eigen::Vector3f& p : points) p = T_base_line * p;
  const CoveredSurface covered =
      path::covered_surface(outcome.path->path(), request.process.coverage, points);
  if (covered.sections.empty()) return {};
  std::vector<CoveredSection> sections = covered.sections;
  std::ranges::sort(sections, {}, &CoveredSection::width_mm);
  report.fields["coverage"] = {{"least_width_mm", sections.front().width_mm},
                               {"least_at_mm", sections.front().arc_mm},
                               {"median_width_mm", sections[sections.size() / 2].width_mm},
                               {"most_width_mm", sections.back().width_mm},
                               {"most_at_mm", sections.back().arc_mm}};
  BITELINE_TRY(write_cloud(folder / "coverage.ply", request.cloud, covered.times));
  return write_drawing(folder / "coverage.png", request, covered.times);
}

}  // namespace biteline::results
