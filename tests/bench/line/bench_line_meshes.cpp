// SPDX-License-Identifier: MIT
// Our line and the published one on meshes of real and drawn shoes.
#include <cstdio>

#include "host/bite_line/published/published_line.hpp"
#include "tests/support/known_shoe.hpp"

int main() {
  using namespace biteline;
  for (const test::KnownShoe& shoe : test::k_known_shoes) {
    const auto scan = test::scan_of(shoe);
    if (!scan) continue;
    const test::ShoeVerdict ours = test::judge(shoe, bite_line::find_bite_line(*scan, {}));
    const test::ShoeVerdict peer = test::judge(shoe, published::find_bite_line(scan->points, {}));
    std::printf(
        "{\"bench\":\"line.mesh\",\"what\":\"%s: right (1) or "
        "not\",\"ours\":%d,\"unit\":\"shoes\",\"peer\":\"published\","
        "\"peer_value\":%d,\"off_mm\":%.3f,\"peer_off_mm\":%.3f,\"peer_why\":\"%s\"}\n",
        shoe.name, ours.right ? 1 : 0, peer.right ? 1 : 0, ours.off_mm, peer.off_mm,
        peer.right ? "" : peer.why.c_str());
    std::fflush(stdout);
  }
  return 0;
}
