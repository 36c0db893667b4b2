// SPDX-License-Identifier: MIT
// bench_spoilt_session SESSION OUT KIND [AMOUNT]: a session as if its camera had told its pictures otherwise
// than when the head was calibrated.  KIND: mirrored, upside_down, turned, or rows and columns with an
// amount.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "tests/support/spoilt_pictures.hpp"

namespace {

using Kind = biteline::test::Spoil::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 5> k_kinds{{{"mirrored", Kind::Mirrored},
                                                                    {"upside_down", Kind::UpsideDown},
                                                                    {"turned", Kind::Turned},
                                                                    {"rows", Kind::Rows},
                                                                    {"columns", Kind::Columns}}};

}  // namespace

int main(int argc, char** argv) {
  for (const auto& [name, kind] : k_kinds) {
    if (argc < 4 || name != argv[3]) continue;
    const auto written = biteline::test::write_spoilt_session(
        argv[1], argv[2], {.kind = kind, .amount = argc > 4 ? std::atoi(argv[4]) : 0});
    if (written) return 0;
    std::fprintf(stderr, "%s\n", biteline::to_line(written.error()).c_str());
    return 1;
  }
  std::fprintf(stderr,
               "bench_spoilt_session SESSION OUT mirrored|upside_down|turned|rows|columns [AMOUNT]\n");
  return 2;
}
