// SPDX-License-Identifier: MIT
// Our line and the published one on meshes of real and drawn shoes.
#include <cstdio>

#include "tests/support/known_shoe.hpp"

int main() {
  using namespace biteline;
  for (const test::KnownShoe& shoe : test::k_known_shoes) {
    const auto scan = test::scan_of(shoe);
    if (!scan) continue;
    const auto judged = [&](bite_line::Method method) {
      return test::judge(shoe, bite_line::extract(*scan, {.method = method, .keep_products = false}));
    };
    const test::ShoeVerdict ours = judged(bite_line::Method::Ours),
                            published = judged(bite_line::Method::Published);
    std::printf(
        "{\"bench\":\"line.mesh\",\"what\":\"%s: right (1) or "
        "not\",\"ours\":%d,\"unit\":\"shoes\",\"peer\":\"published\","
        "\"peer_value\":%d,\"off_mm\":%.3f,\"peer_off_mm\":%.3f,\"peer_why\":\"%s\"}\n",
        shoe.name, ours.right ? 1 : 0, published.right ? 1 : 0, ours.off_mm, published.off_mm,
        published.right ? "" : published.why.c_str());
    std::fflush(stdout);
  }
  return 0;
}
