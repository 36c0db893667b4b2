// SPDX-License-Identifier: MIT
#include "common/core/fixed_text.hpp"
#include "host/records/line_files/writers.hpp"

namespace biteline::line_files {

std::string ply_text(const cloud::ClosedLine& line) {
  const std::size_t count = line.points.size();
  std::string text =
      "ply\nformat ascii 1.0\ncomment closed line, mm, robot base frame; u95 -1: unknown\n"
      "element vertex " +
      std::to_string(count) +
      "\nproperty double x\nproperty double y\nproperty double z\n"
      "property double nx\nproperty double ny\nproperty double nz\n"
      "property float confidence\nproperty float u95\n"
      "element edge " +
      std::to_string(count) + "\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  for (const cloud::LinePoint& p : line.points) {
    text += FixedText<200>::format("%.5f %.5f %.5f %.7f %.7f %.7f %.4f %.4f\n", p.position.x(),
                                   p.position.y(), p.position.z(), p.normal.x(), p.normal.y(), p.normal.z(),
                                   p.confidence, p.u95_mm.value_or(-1))
                .view();
  }
  for (std::size_t i = 0; i < count; ++i)
    text += std::to_string(i) + " " + std::to_string((i + 1) % count) + "\n";
  return text;
}

}  // namespace biteline::line_files
