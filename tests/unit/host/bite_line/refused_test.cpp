// SPDX-License-Identifier: MIT
#include "host/bite_line/refused.hpp"

#include "tests/support/refusals.hpp"

namespace biteline::bite_line {

TEST_GROUP(BiteLineRefused){};

TEST(BiteLineRefused, EveryCodeHasItsRow) {
  test::check_refusal_table(Refused::NotSure);
}

}  // namespace biteline::bite_line
