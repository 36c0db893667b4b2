// SPDX-License-Identifier: MIT
// find_line CLOUD OUT.csv: the bite line of a shoe's cloud.
#include <biteline/biteline.hpp>
#include <cstdio>

namespace bl = biteline::sdk;

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    const bl::FoundLine found = bl::find_line(bl::read_cloud(argv[1]));
    bl::write_line(argv[2], found.line);
    std::printf("%zu points, %.1f mm, confidence %.2f\n", found.line.points.size(), bl::length_mm(found.line),
                found.confidence);
    if (!found.review.empty()) std::printf("a person must look: %s\n", found.review.c_str());
    return 0;
  } catch (const bl::Refused& refused) {
    std::fprintf(stderr, "%s: %s; %s\n", refused.reason_code().c_str(), refused.what(),
                 refused.next_step().c_str());
    return 3;
  } catch (const bl::Error& error) {
    std::fprintf(stderr, "%s; %s\n", error.what(), error.next_step().c_str());
    return 2;
  }
}
