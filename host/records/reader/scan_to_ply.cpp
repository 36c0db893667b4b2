// SPDX-License-Identifier: MIT
// scan_to_ply scan.btln cloud.ply: an example of biteline_scan.hpp: the surface's points in base, mm.
//     c++ -std=c++17 -O2 scan_to_ply.cpp -o scan_to_ply
#include <cstdio>

#include "biteline_scan.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "scan_to_ply scan.btln cloud.ply\n");
    return 2;
  }
  const std::optional<biteline_scan::Scan> scan = biteline_scan::read_scan(argv[1]);
  if (!scan) {
    std::fprintf(stderr, "%s: not a recorded scan\n", argv[1]);
    return 2;
  }
  std::string rows;
  std::size_t points = 0;
  for (const biteline_scan::Profile& profile : scan->profiles) {
    for (const biteline_scan::Place& place : biteline_scan::places_base(profile)) {
      char row[96];
      std::snprintf(row, sizeof row, "%.6g %.6g %.6g %u %u\n", place.mm[0], place.mm[1], place.mm[2],
                    static_cast<unsigned>(profile.sequence), unsigned{place.column});
      rows += row;
      ++points;
    }
  }
  std::ofstream out{argv[2], std::ios::binary};
  out << "ply\nformat ascii 1.0\nelement vertex " << points
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty uint profile\nproperty ushort "
         "column\n"
      << "end_header\n"
      << rows;
  out.flush();
  if (!out) {
    std::fprintf(stderr, "%s: not written\n", argv[2]);
    return 2;
  }
  std::printf("%zu profiles, %zu points, %s\n", scan->profiles.size(), points,
              scan->complete ? "whole" : "cut");
  return 0;
}
