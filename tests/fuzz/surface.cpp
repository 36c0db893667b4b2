// SPDX-License-Identifier: MIT
// Any profiles: the surface of a scan gives each point out once, in bounded time, and tables over points stay
// bounded.
#include "common/core/numbers.hpp"
#include "host/cloud/curvature/scan_surface.hpp"
#include "host/transfer/align/nearest_table.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case bytes{data, size};
  curvature::ScanSurface surface;
  transfer::Surfels surfels{.pitch_mm = 2};
  std::size_t given = 0;
  while (!bytes.empty()) {
    std::vector<Eigen::Vector3f> points;
    std::vector<std::uint16_t> columns;
    const int count = bytes.take<std::uint8_t>() % 48;
    // Small steps as on a surface, now and then any bits at all.
    Eigen::Vector3f place{0, 0, 0.2F * static_cast<float>(given)};
    for (int i = 0; i < count; ++i) {
      const auto step = bytes.take<std::int8_t>();
      place.x() += 0.1F;
      place.y() += 0.01F * static_cast<float>(step);
      points.push_back(step == -128
                           ? Eigen::Vector3f{bytes.take<float>(), bytes.take<float>(), bytes.take<float>()}
                           : place);
      columns.push_back(static_cast<std::uint16_t>(i));
      if (is_plausible_place(points.back())) {
        surfels.positions.push_back(points.back());
        surfels.normals.emplace_back(Eigen::Vector3f::UnitZ());
      }
    }
    surface.add_profile(points, columns, {0, 0, 300});
    given += points.size();
  }
  surface.finish();
  fuzz::demand(surface.normals().size() == given, "each point has its normal");
  const transfer::NearestTable table{surfels, 4};
  for (const Eigen::Vector3f& place : surfels.positions)
    fuzz::demand(table.near(place) < surfels.size() || surfels.size() == 0, "a point is near itself");
  return 0;
}
