// SPDX-License-Identifier: MIT
// transfer SAMPLE UPPER OUT.csv: a sample's line (a folder with cloud.ply and line.csv) on the next upper.
#include <biteline/biteline.hpp>
#include <cstdio>

namespace bl = biteline::sdk;

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  try {
    const bl::Sample sample = bl::read_sample(argv[1]);
    const bl::CarriedLine carried = bl::transfer_line(sample, bl::read_cloud(argv[2]));
    bl::write_line(argv[3], carried.line);
    std::printf("carried, within %.2f mm; the surfaces agree to %.3f mm\n", carried.bound_mm,
                carried.shape_rms_mm);
    return 0;
  } catch (const bl::Error& error) {
    std::fprintf(stderr, "%s; %s\n", error.what(), error.next_step().c_str());
    return 2;
  }
}
