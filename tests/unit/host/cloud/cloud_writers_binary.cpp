// SPDX-License-Identifier: MIT
// PLY, PCD and meshes, as texts and as bytes.
#include <liblzf/lzf.h>

#include <cmath>

#include "tests/unit/host/cloud/cloud_author.hpp"

namespace biteline::cloud::writers {

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

}  // namespace biteline::cloud::writers
