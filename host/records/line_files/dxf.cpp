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

/// The layers that are used, and the line type that they have; some readers make none by themselves.
std::string tables() {
  const auto layer = [](const char* name, int colour) {
    return pair(0, "LAYER") + pair(2, name) + pair(70, "0") + pair(62, std::to_string(colour)) +
           pair(6, "CONTINUOUS");
  };
  constexpr int k_white = 7, k_red = 1, k_alignment = 65;
  return pair(0, "SECTION") + pair(2, "TABLES") + pair(0, "TABLE") + pair(2, "LTYPE") + pair(70, "1") +
         pair(0, "LTYPE") + pair(2, "CONTINUOUS") + pair(70, "0") + pair(3, "Solid line") +
         pair(72, std::to_string(k_alignment)) + pair(73, "0") + number(40, 0) + pair(0, "ENDTAB") +
         pair(0, "TABLE") + pair(2, "LAYER") + pair(70, "2") + layer("0", k_white) + layer(k_layer, k_red) +
         pair(0, "ENDTAB") + pair(0, "ENDSEC");
}

}  // namespace

std::string dxf_text(const cloud::ClosedLine& line) {
  constexpr int k_closed = 1, k_polyline_3d = 8, k_vertex_3d = 32, k_unit_mm = 4;
  std::string text = pair(0, "SECTION") + pair(2, "HEADER") + pair(9, "$ACADVER") + pair(1, "AC1009") +
                     pair(9, "$INSUNITS") + pair(70, std::to_string(k_unit_mm)) + pair(0, "ENDSEC") +
                     tables() + pair(0, "SECTION") + pair(2, "ENTITIES") + pair(0, "POLYLINE") +
                     pair(8, k_layer) + pair(66, "1") + number(10, 0) + number(20, 0) + number(30, 0) +
                     pair(70, std::to_string(k_closed | k_polyline_3d));
  for (const cloud::LinePoint& p : line.points) {
    text += pair(0, "VERTEX") + pair(8, k_layer) + number(10, p.position.x()) + number(20, p.position.y()) +
            number(30, p.position.z()) + pair(70, std::to_string(k_vertex_3d));
  }
  return text + pair(0, "SEQEND") + pair(8, k_layer) + pair(0, "ENDSEC") + pair(0, "EOF");
}

}  // namespace biteline::line_files
