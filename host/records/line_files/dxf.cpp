// SPDX-License-Identifier: MIT
// DXF of release 12 (AC1009): pairs of a group code and a value, a row each.
#include "common/core/fixed_text.hpp"
#include "host/records/line_files/writers.hpp"

namespace biteline::line_files {
namespace {

constexpr const char* k_layer = "BITE_LINE";

std::string pair(int code, std::string_view value) {
  return std::to_string(code) + "\n" + std::string(value) + "\n";
}

std::string number(int code, double value) {
  return pair(code, FixedText<32>::format("%.6f", value).view());
}

}  // namespace

std::string dxf_text(const cloud::ClosedLine& line) {
  constexpr int k_closed = 1, k_polyline_3d = 8, k_vertex_3d = 32, k_unit_mm = 4;
  std::string text = pair(0, "SECTION") + pair(2, "HEADER") + pair(9, "$ACADVER") + pair(1, "AC1009") +
                     pair(9, "$INSUNITS") + pair(70, std::to_string(k_unit_mm)) + pair(0, "ENDSEC") +
                     pair(0, "SECTION") + pair(2, "ENTITIES") + pair(0, "POLYLINE") + pair(8, k_layer) +
                     pair(66, "1") + number(10, 0) + number(20, 0) + number(30, 0) +
                     pair(70, std::to_string(k_closed | k_polyline_3d));
  for (const cloud::LinePoint& p : line.points) {
    text += pair(0, "VERTEX") + pair(8, k_layer) + number(10, p.position.x()) + number(20, p.position.y()) +
            number(30, p.position.z()) + pair(70, std::to_string(k_vertex_3d));
  }
  return text + pair(0, "SEQEND") + pair(8, k_layer) + pair(0, "ENDSEC") + pair(0, "EOF");
}

}  // namespace biteline::line_files
