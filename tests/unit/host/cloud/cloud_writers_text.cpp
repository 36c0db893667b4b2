// SPDX-License-Identifier: MIT
// Texts: tables, lists, columns.
#include <cmath>

#include "tests/unit/host/cloud/cloud_author.hpp"

namespace biteline::cloud::writers {

void cloud_compare(Author& by) {
  by.out.ending = by.maybe() ? ".asc" : ".txt";
  by.out.counted = by.maybe();
  const int further = by.between(0, 3);
  const char* const between = by.one_of(std::array{" ", ";", ",", "\t"});
  std::string text;
  if (by.maybe()) {
    text = std::string{"//X"} + between + "Y" + between + "Z";
    for (int k = 0; k < further; ++k) text += between + ("Scalar_field_" + std::to_string(k));
    text += "\n";
  }
  if (by.out.counted) text += std::to_string(by.points.size()) + "\n";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place& p = by.points[i];
    text += fixed(p.x(), 8) + between + fixed(p.y(), 8) + between + (by.hole[i] ? "nan" : fixed(p.z(), 8));
    for (int k = 0; k < further; ++k) text += between + fixed(0.5 * k, 6);
    text += "\n";
  }
  by.out.bytes = text;
  by.expect();
}

void excel(Author& by) {
  by.out.ending = ".csv";
  const bool comma = by.maybe();
  const char separator = comma ? (by.maybe() ? ';' : '\t') : (by.maybe() ? ',' : ';');
  const char decimal = comma ? ',' : '.';
  const bool quoted = by.maybe();
  const auto cell = [&](double value) {
    const std::string text = fixed(value, 3, decimal);
    return quoted ? '"' + text + '"' : text;
  };
  std::string text;
  if (by.maybe()) text += std::string{"sep="} + separator + "\n";
  if (by.maybe()) text += std::string{"Messung"} + separator + separator + separator + "\n";
  text += std::string{"Nr"} + separator + "X [mm]" + separator + "Y [mm]" + separator + "Z [mm]\n";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    text += std::to_string(i + 1) + separator + cell(by.points[i].x()) + separator + cell(by.points[i].y()) +
            separator + (by.hole[i] ? "" : cell(by.points[i].z())) + "\n";
  }
  if (by.maybe()) text.pop_back();
  text = with_line_ends(text, "\r\n");
  const int encoding = by.between(0, 3);
  by.out.bytes = encoding == 0 ? "\xEF\xBB\xBF" + text : encoding == 1 ? in_utf16(text, false) : text;
  by.expect();
}

void pandas(Author& by) {
  by.out.ending = ".csv";
  const bool index = by.maybe(), names = by.maybe(), pixels = names && by.maybe();
  std::string text = index ? "," : "";
  if (pixels) text += "x_index,y_index,";
  text += names ? "x,y,z,intensity\n" : "0,1,2,3\n";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place& p = by.points[i];
    if (index) text += std::to_string(i) + ",";
    if (pixels) text += std::to_string(i % 7) + "," + std::to_string(i / 7) + ",";
    text += fixed(p.x(), 3) + "," + fixed(p.y(), 3) + "," + (by.hole[i] ? "" : fixed(p.z(), 3)) + "," +
            (i % 3 == 0 ? "" : "31.5") + "\n";
  }
  by.out.bytes = text;
  by.expect();
}

void paraview(Author& by) {
  by.out.ending = ".csv";
  const bool normals_first = by.maybe();
  const std::string normals = R"("Normals:0","Normals:1","Normals:2")",
                    places = R"("Points:0","Points:1","Points:2")";
  std::string text =
      (normals_first ? normals + "," + places : places + "," + normals) + ",\"Points_Magnitude\"\n";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place& p = by.points[i];
    const std::string place = scientific(p.x(), 'e') + "," + scientific(p.y(), 'e') + "," +
                              (by.hole[i] ? "nan" : scientific(p.z(), 'e'));
    text +=
        (normals_first ? "0.1,0.2,0.97," + place : place + ",0.1,0.2,0.97") + "," + fixed(p.norm(), 4) + "\n";
  }
  by.out.bytes = text;
  by.expect();
}

void matlab(Author& by) {
  by.out.ending = by.maybe() ? ".txt" : ".xyz";
  std::string text;
  if (by.maybe()) text = "% x y z\n";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place& p = by.points[i];
    for (int k = 0; k < 3; ++k) text += "   " + (by.hole[i] && k == 2 ? "NaN" : scientific(p[k], 'e'));
    text += "\n";
  }
  by.out.bytes = with_line_ends(text, by.one_of(std::array{"\n", "\r\n", "\r"}));
  by.expect();
}

void fortran(Author& by) {
  by.out.ending = ".txt";
  std::string text = by.maybe() ? " ! made by a solver\n" : "";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place& p = by.points[i];
    text += "  " + scientific(p.x(), 'D', true) + "  " + scientific(p.y(), 'D', true) + "  " +
            (by.hole[i] ? "****************" : scientific(p.z(), 'D', true)) + "\n";
  }
  by.out.bytes = text;
  by.expect();
}

void old_windows(Author& by) {
  by.out.ending = ".xyz";
  const bool comma = by.maybe();
  const char decimal = comma ? ',' : '.';
  const char* const between =
      comma ? by.one_of(std::array{"\t", " ", ";"}) : by.one_of(std::array{"\t", " ", ";", ", "});
  std::string text;
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place& p = by.points[i];
    const std::string nothing =
        std::string{by.maybe() ? "1" : "-1"} + decimal + (by.maybe() ? "#QNAN" : "#IND00");
    text += fixed(p.x(), 5, decimal) + between + fixed(p.y(), 5, decimal) + between +
            (by.hole[i] ? nothing : "+" + fixed(p.z(), 5, decimal)) + "\r\n";
  }
  by.out.bytes = text;
  by.expect();
}

void metrology(Author& by) {
  by.out.ending = ".txt";
  const bool micrometres = by.maybe();
  std::string text = "Inspection Report 12\nPart: shoe 7, left\n\n";
  text += micrometres ? "Name;X[um];Y[um];Z[um];Dev\n"
                      : "Name;X-Koordinate (mm);Y-Koordinate (mm);Z-Koordinate (mm);Dev\n";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place p = by.points[i] * (micrometres ? 1000 : 1);
    text += "P" + std::to_string(i + 1) + ";" + fixed(p.x(), 3, ',') + ";" + fixed(p.y(), 3, ',') + ";" +
            (by.hole[i] ? "---" : fixed(p.z(), 3, ',')) + ";" + fixed(0.01, 3, ',') + "\n";
  }
  by.out.bytes = text;
  by.expect();
}

void mixed_units(Author& by) {
  by.out.ending = ".csv";
  std::string text = "region,x (mm),y (mm),z (um),time\n";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place& p = by.points[i];
    text += "0," + fixed(p.x(), 4) + "," + fixed(p.y(), 4) + "," +
            (by.hole[i] ? "n/a" : fixed(1000 * p.z(), 1)) + ",2026-11-27 10:00:00\n";
  }
  by.out.bytes = text;
  by.expect();
}

void pts(Author& by) {
  by.out.ending = ".pts";
  by.out.counted = true;
  std::fill(by.hole.begin(), by.hole.end(), false);
  const std::size_t half = by.maybe() ? by.points.size() / 2 : by.points.size();
  std::string text = std::to_string(half) + "\n";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    if (i == half) text += std::to_string(by.points.size() - half) + "\n";
    const Place& p = by.points[i];
    text += fixed(p.x(), 6) + " " + fixed(p.y(), 6) + " " + fixed(p.z(), 6) + " -" + std::to_string(i) +
            " 12 13 14\n";
  }
  by.out.bytes = text;
  by.expect();
}

void r_table(Author& by) {
  by.out.ending = ".txt";
  std::string text = "\"x\" \"y\" \"z\"\n";
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place& p = by.points[i];
    text += "\"" + std::to_string(i + 1) + "\" " + fixed(p.x(), 3) + " " + fixed(p.y(), 3) + " " +
            (by.hole[i] ? "NA" : fixed(p.z(), 3)) + "\n";
  }
  by.out.bytes = text;
  by.expect();
}

// ---- PLY, PCD ----

}  // namespace biteline::cloud::writers
