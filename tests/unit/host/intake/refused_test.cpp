// SPDX-License-Identifier: MIT
#include "host/intake/refused.hpp"

#include "tests/support/refusals.hpp"

namespace biteline::intake {

TEST_GROUP(IntakeRefused){};

TEST(IntakeRefused, EveryCodeHasItsRow) {
  test::check_refusal_table(Refused::StripeAlongColumns);
}

}  // namespace biteline::intake
