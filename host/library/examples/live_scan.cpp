// SPDX-License-Identifier: MIT
// live_scan tcp://HOST:PORT SCAN.btln CLOUD.ply [KEYS]: one scan of a sensor, kept and as a cloud.
#include <biteline/biteline.hpp>
#include <biteline/sensor.hpp>
#include <cstdio>

namespace bl = biteline::sdk;

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) return 2;
  try {
    bl::SensorClient sensor{{.endpoint = argv[1], .keys = argc == 5 ? argv[4] : "", .name = "live_scan"}};
    const bl::Recording scan = sensor.scan(argv[2], std::chrono::minutes{2});
    bl::write_cloud(argv[3], scan.cloud);
    std::printf("%zu profiles, %zu points\n", scan.profiles.size(), scan.cloud.size());
    return 0;
  } catch (const bl::Error& error) {
    std::fprintf(stderr, "%s; %s\n", error.what(), error.next_step().c_str());
    return 2;
  }
}
