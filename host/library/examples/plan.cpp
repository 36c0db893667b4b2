// SPDX-License-Identifier: MIT
// plan LINE PROCESS.yaml OUT.csv: a checked path of a UR10e that stands some 600 mm beside the line.
#include <biteline/biteline.hpp>
#include <cmath>
#include <cstdio>

namespace bl = biteline::sdk;

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  try {
    bl::PlanRequest request{.line = bl::read_line(argv[1]), .process_file = argv[2], .robot = "UR10e"};
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const bl::LinePoint& point : request.line.points)
      centre += point.position_mm / static_cast<double>(request.line.points.size());
    request.T_line_base.translation() =
        Eigen::Vector3d{std::round(centre.x()), std::round(centre.y()) - 600, 0};
    const bl::Path path = bl::plan(request);
    path.write_csv(argv[3]);
    std::printf("%zu waypoints, %.1f s\n", path.waypoints().size(), path.duration_s());
    return 0;
  } catch (const bl::Error& error) {
    std::fprintf(stderr, "%s; %s\n", error.what(), error.next_step().c_str());
    return 2;
  }
}
