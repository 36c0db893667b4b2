// SPDX-License-Identifier: MIT
// A stranger's ten lines: how high does the line of this cloud lie, and how long is it?
#include <biteline/biteline.hpp>
#include <cstdio>
int main(int, char** argv) {
  const auto found = biteline::sdk::find_line(biteline::sdk::read_cloud(argv[1]));
  double sum = 0;
  for (const auto& point : found.line.points) sum += point.position_mm.z();
  std::printf("%.9f %.9f\n", sum / double(found.line.points.size()), biteline::sdk::length_mm(found.line));
}
