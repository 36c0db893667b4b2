// SPDX-License-Identifier: MIT
// calibrate FOLDER: calibration pictures to sensor.yaml, on standard output.
#include <biteline/biteline.hpp>
#include <cstdio>

namespace bl = biteline::sdk;

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const bl::Calibration calibration = bl::calibrate_head(argv[1]);
    std::fputs(calibration.head.yaml().c_str(), stdout);
    for (const std::string& reason : calibration.reasons) std::fprintf(stderr, "fair: %s\n", reason.c_str());
    return 0;
  } catch (const bl::Error& error) {
    std::fprintf(stderr, "%s; %s\n", error.what(), error.next_step().c_str());
    return 2;
  }
}
