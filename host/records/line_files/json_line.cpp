// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "host/cloud/source_word.hpp"
#include "host/records/line_files/writers.hpp"

namespace biteline::line_files {
namespace {

nlohmann::ordered_json array(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

std::string json_text(const cloud::ClosedLine& line) {
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const cloud::LinePoint& p : line.points) {
    nlohmann::ordered_json point{{"position_mm", array(p.position)},
                                 {"normal", array(p.normal)},
                                 {"tangent", array(p.tangent)},
                                 {"confidence", p.confidence}};
    point["u95_mm"] = p.u95_mm ? nlohmann::ordered_json(*p.u95_mm) : nlohmann::ordered_json(nullptr);
    point["flags"] = p.flags;
    point["source"] = cloud::source_word(p.source);
    points.push_back(std::move(point));
  }
  const nlohmann::ordered_json whole{{"schema_version", 1},
                                     {"unit", "mm"},
                                     {"frame", "base"},
                                     {"closed", true},
                                     {"length_mm", cloud::length_mm(line)},
                                     {"points", std::move(points)}};
  return whole.dump(1) + "\n";
}

}  // namespace biteline::line_files
