// SPDX-License-Identifier: MIT
#include "tests/unit/host/cloud/cloud_writers.hpp"

#include <liblzf/lzf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace biteline::cloud {
namespace {

using Place = Eigen::Vector3d;

/// Choices and numbers of one file.
class Author {
 public:
  Author(WrittenCloud& written, std::uint32_t seed) : out{written}, random_{seed} {
    const int count = between(40, 120);
    for (int i = 0; i < count; ++i) {
      // Thousandths, exact in each writer's digits; no sign of a grid.
      points.emplace_back(0.001 * between(-140'000, 140'000), 0.001 * between(-60'000, 60'000),
                          0.001 * between(1, 120'000));
      hole.push_back(with_holes_ && between(0, 9) == 0);
    }
    hole[0] = hole[1] = false;
  }
  int between(int low, int high) { return std::uniform_int_distribution<int>{low, high}(random_); }
  bool maybe() { return between(0, 1) == 1; }
  template <std::size_t N>
  const char* one_of(const std::array<const char*, N>& choices) {
    return choices.at(static_cast<std::size_t>(between(0, static_cast<int>(N) - 1)));
  }
  /// Points with numbers are to be read, the others to be counted.
  void expect() {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (hole[i]) {
        ++out.without_number;
      } else {
        out.points.push_back(points[i]);
      }
    }
  }

  /// A mesh over all points is made small: its surface is sampled.
  void shrink() {
    for (Place& point : points) point = (point * 50).array().round() / 1000;
  }

  WrittenCloud& out;
  std::vector<Place> points;
  std::vector<bool> hole;

 private:
  std::mt19937 random_;
  bool with_holes_ = maybe();
};

std::string fixed(double value, int decimals, char decimal = '.') {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  std::string written = text.data();
  std::ranges::replace(written, '.', decimal);
  return written;
}

std::string scientific(double value, char letter = 'E', bool plus = false) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), plus ? "%+.10E" : "%.10E", value);
  std::string written = text.data();
  std::ranges::replace(written, 'E', letter);
  return written;
}

std::string in_utf16(const std::string& text, bool big_endian) {
  std::string wide = big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) {
    if (big_endian) wide += '\0';
    wide += c;
    if (!big_endian) wide += '\0';
  }
  return wide;
}

std::string with_line_ends(const std::string& text, const char* end) {
  std::string other;
  for (const char c : text) {
    if (c == '\n')
      other += end;
    else
      other += c;
  }
  return other;
}

template <class T>
void put_raw(std::string& bytes, T value, bool big_endian = false) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof value);
  if (big_endian) std::ranges::reverse(raw);
  bytes.append(raw.data(), raw.size());
}

// ---- texts ----

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

void ply(Author& by) {
  by.out.ending = ".ply";
  by.out.counted = true;
  const int kind = by.between(0, 2);  // ascii, little, big
  const bool wide = by.maybe(), capital = by.maybe(), time = by.maybe(), list = by.maybe(),
             faces_first = by.maybe();
  by.out.mesh = by.maybe();
  if (by.out.mesh) {
    std::fill(by.hole.begin(), by.hole.end(), false);
    by.shrink();
  }
  // A mesh of a strip of triangles over all points.
  const std::size_t triangles = by.out.mesh ? by.points.size() - 2 : 0;
  const std::string type = wide ? "double" : "float32";
  std::string head = "ply\nformat " +
                     std::string{kind == 0   ? "ascii"
                                 : kind == 1 ? "binary_little_endian"
                                             : "binary_big_endian"} +
                     " 1.0\ncomment made, by hand\n";
  std::string vertices = "element vertex " + std::to_string(by.points.size()) + "\n";
  if (time) vertices += "property int64 time\n";
  for (const char* axis : {"x", "y", "z"})
    vertices +=
        "property " + type + " " + (capital ? std::string(1, static_cast<char>(axis[0] - 32)) : axis) + "\n";
  if (list) vertices += "property list uchar int tags\n";
  const std::string face =
      "element face " + std::to_string(triangles) + "\nproperty list uchar int vertex_indices\n";
  head += faces_first ? face + vertices : vertices + face;
  head += by.one_of(std::array{"end_header\n", "end_header \n", "END_HEADER\n"});
  std::string points, faces;
  const bool big = kind == 2;
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place p = by.hole[i] ? Place(by.points[i].x(), by.points[i].y(), std::nan("")) : by.points[i];
    if (kind == 0) {
      if (time) points += "1700000000000 ";
      points += fixed(p.x(), 3) + " " + fixed(p.y(), 3) + " " +
                (by.hole[i] ? by.one_of(std::array{"nan", "-1.#IND", "NaN"}) : "+" + fixed(p.z(), 3));
      points += list ? " 2 5 6\n" : "\n";
    } else {
      if (time) put_raw(points, std::int64_t{1'700'000'000'000}, big);
      for (int k = 0; k < 3; ++k) {
        if (wide)
          put_raw(points, p[k], big);
        else
          put_raw(points, static_cast<float>(p[k]), big);
      }
      if (list) put_raw(points, std::uint8_t{1}), put_raw(points, std::int32_t{7}, big);
    }
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    if (kind == 0) {
      faces += "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + "\n";
    } else {
      put_raw(faces, std::uint8_t{3});
      for (std::size_t k = 0; k < 3; ++k) put_raw(faces, static_cast<std::int32_t>(i + k), big);
    }
  }
  const std::string body = faces_first ? faces + points : points + faces;
  const char* const end = by.one_of(std::array{"\n", "\r\n", "\r"});
  by.out.bytes = with_line_ends(head, end) + (kind == 0 ? with_line_ends(body, end) : body);
  by.expect();
}

void pcd(Author& by) {
  by.out.ending = ".pcd";
  by.out.counted = true;
  const int kind = by.between(0, 2);
  const bool organised = by.maybe(), capital = by.maybe();
  std::string head = by.maybe() ? "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\n" : "VERSION 0.7\n";
  head += capital ? "FIELDS X Y Z intensity\n" : "FIELDS x y z intensity\n";
  head += "SIZE 4 4 4 2\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH " + std::to_string(by.points.size()) +
          "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n";
  if (!organised) head += "POINTS " + std::to_string(by.points.size()) + "\n";
  head += std::string{"DATA "} +
          (kind == 0   ? (capital ? "ASCII" : "ascii")
           : kind == 1 ? "binary"
                       : "binary_compressed") +
          "\n";
  std::string rows, columns;
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const float z = by.hole[i] ? std::nanf("") : static_cast<float>(by.points[i].z());
    if (kind == 0) {
      rows += fixed(by.points[i].x(), 3) + " " + fixed(by.points[i].y(), 3) + " " +
              (by.hole[i] ? "nan" : fixed(by.points[i].z(), 3)) + " 7\n";
    } else {
      put_raw(rows, static_cast<float>(by.points[i].x()));
      put_raw(rows, static_cast<float>(by.points[i].y()));
      put_raw(rows, z);
      put_raw(rows, std::uint16_t{7});
    }
  }
  if (kind == 2) {
    std::size_t first = 0;
    for (const std::size_t size : {4, 4, 4, 2}) {
      for (std::size_t i = 0; i < by.points.size(); ++i) columns += rows.substr(14 * i + first, size);
      first += size;
    }
    std::string packed(2 * columns.size(), '\0');
    unsigned size = lzf_compress(columns.data(), static_cast<unsigned>(columns.size()), packed.data(),
                                 static_cast<unsigned>(columns.size() - 1));
    packed.resize(size);
    if (size == 0) packed = columns;  // it did not shrink
    rows.clear();
    put_raw(rows, static_cast<std::uint32_t>(packed.size()));
    put_raw(rows, static_cast<std::uint32_t>(columns.size()));
    rows += packed;
  }
  by.out.bytes = head + rows;
  by.expect();
}

// ---- meshes: a strip of triangles over all points ----

void stl(Author& by) {
  by.out.ending = by.maybe() ? ".stl" : ".STL";
  by.out.mesh = by.out.counted = true;
  by.shrink();
  const bool text = by.maybe(), capitals = by.maybe();
  const std::size_t triangles = by.points.size() - 2;
  // One triangle without numbers, which nobody needs.
  const bool broken = by.maybe();
  std::string bytes;
  if (text) {
    bytes = by.one_of(std::array{"", " ", "\n"});
    bytes += "solid " + std::string(static_cast<std::size_t>(by.between(0, 200)), 'n') + " vertex 7\n";
    for (std::size_t i = 0; i < triangles + (broken ? 1 : 0); ++i) {
      bytes += "  facet normal 0 0 1\n    outer loop\n";
      for (std::size_t k = 0; k < 3; ++k) {
        const Place& p = by.points[std::min(i + k, by.points.size() - 1)];
        bytes +=
            "      vertex " +
            (i == triangles ? "nan nan nan"
                            : fixed(p.x(), 4) + " " + scientific(p.y(), 'e', true) + " " + fixed(p.z(), 4)) +
            "\n";
      }
      bytes += "    endloop\n  endfacet\n";
    }
    bytes += "endsolid\n";
    if (capitals)
      std::ranges::transform(bytes, bytes.begin(),
                             [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
    bytes = with_line_ends(bytes, by.one_of(std::array{"\n", "\r\n", "\r"}));
  } else {
    bytes = std::string(80, by.maybe() ? ' ' : '\0');
    if (by.maybe()) bytes.replace(0, 11, "solid facet");
    const std::size_t count = triangles + (broken ? 1 : 0);
    put_raw(bytes, static_cast<std::uint32_t>(by.between(0, 3) == 0 ? 0 : count));
    by.out.counted = false;  // count 0
    for (std::size_t i = 0; i < count; ++i) {
      for (int k = 0; k < 3; ++k) put_raw(bytes, 0.F);
      for (std::size_t k = 0; k < 3; ++k) {
        const Place& p = by.points[std::min(i + k, by.points.size() - 1)];
        for (int axis = 0; axis < 3; ++axis)
          put_raw(bytes, i == triangles ? std::nanf("") : static_cast<float>(p[axis]));
      }
      put_raw(bytes, std::uint16_t{0});
    }
  }
  by.out.bytes = bytes;
  by.out.points = by.points;
  by.out.without_number = broken ? 1 : 0;
}

void obj(Author& by) {
  by.out.ending = ".obj";
  by.out.mesh = by.maybe();
  const bool faces_first = by.maybe(), from_end = by.maybe(), goes_on = by.maybe(),
             unused = by.out.mesh && by.maybe();
  if (by.out.mesh) by.shrink();
  std::string vertices, faces;
  for (std::size_t i = 0; i < by.points.size(); ++i) {
    const Place& p = by.points[i];
    vertices += "v " + fixed(p.x(), 4) + (goes_on ? " \\\n  " : " ") + fixed(p.y(), 4) + " " +
                (by.hole[i] && !by.out.mesh ? "nan" : fixed(p.z(), 4)) + (i % 2 == 0 ? "" : " 0.5 0.5 0.5") +
                "\n";
  }
  if (unused) vertices += "v nan nan nan\n";
  const auto all = static_cast<long>(by.points.size() + (unused ? 1 : 0));
  for (long i = 0; by.out.mesh && i + 2 < static_cast<long>(by.points.size()); ++i) {
    faces += "f";
    for (long k = 0; k < 3; ++k) {
      const long number = from_end && !faces_first ? i + k - all : i + k + 1;
      faces += " " + std::to_string(number) + (i % 2 == 0 ? "//1" : "");
    }
    faces += "\n";
  }
  by.out.bytes = "# Blender\nmtllib a.mtl\no shoe\n" +
                 (faces_first ? faces + vertices : vertices + "vn 0 0 1\ns off\n" + faces);
  if (by.out.mesh) {
    by.out.points = by.points;
  } else {
    by.expect();
  }
}

struct Habit {
  const char* name;
  void (*write)(Author&);
};
constexpr std::array k_habits{Habit{"CloudCompare", cloud_compare},
                              Habit{"Excel", excel},
                              Habit{"pandas", pandas},
                              Habit{"ParaView", paraview},
                              Habit{"Matlab", matlab},
                              Habit{"Fortran", fortran},
                              Habit{"old Windows", old_windows},
                              Habit{"metrology", metrology},
                              Habit{"mixed units", mixed_units},
                              Habit{"PTS", pts},
                              Habit{"R", r_table},
                              Habit{"PLY", ply},
                              Habit{"PCD", pcd},
                              Habit{"STL", stl},
                              Habit{"OBJ", obj}};

}  // namespace

int writer_habits() {
  return static_cast<int>(k_habits.size());
}

WrittenCloud write_cloud_as(int habit, std::uint32_t seed) {
  WrittenCloud out;
  Author author{out, seed};
  const Habit& as = k_habits.at(static_cast<std::size_t>(habit));
  out.writer = std::string{as.name} + ", seed " + std::to_string(seed);
  as.write(author);
  return out;
}

}  // namespace biteline::cloud
