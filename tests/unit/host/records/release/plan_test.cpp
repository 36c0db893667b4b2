// SPDX-License-Identifier: MIT
#include "host/records/release/plan.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::release {
namespace {

const std::string k_old(64, 'a'), k_new(64, 'b');

Plan planned(bool sure) {
  return {.current = k_old,
          .before = {},
          .next = k_new,
          .at_ms = 1000,
          .sure = sure,
          .number = 7,
          .newest = 8,
          .order = std::string(64, 'd')};
}

}  // namespace

TEST_GROUP(ReleasePlan){};

TEST(ReleasePlan, ComesBackAsItWas) {
  for (const Plan& plan : {Plan{}, planned(false), planned(true)}) {
    const auto back = read_plan(to_text(plan));
    SUCCEEDS(back);
    CHECK(*back == plan);
  }
  const std::string sound = to_text(planned(true));
  for (std::size_t at = 0; at < sound.size(); ++at) CHECK_TEXT(!read_plan(sound.substr(0, at)), "cut short");
  CHECK(!read_plan(sound + "more\n"));
}

TEST(ReleasePlan, ReadsWhatVersionsWithoutSignedOrdersWrote) {
  const auto plan =
      read_plan("biteline-plan 1\ncurrent " + k_old + "\nbefore -\nnext -\nat_ms 0\nsure 0\nnumber 7\n");
  SUCCEEDS(plan);
  STRCMP_EQUAL(k_old.c_str(), plan->current.c_str());
  LONGS_EQUAL(7, plan->newest);
  STRCMP_EQUAL("", plan->order.c_str());
}

TEST(ReleasePlan, SwitchesAtItsTimeAndOnlyWhenSure) {
  STRCMP_EQUAL(k_old.c_str(), planned(true).in_force(999).c_str());
  STRCMP_EQUAL(k_new.c_str(), planned(true).in_force(1000).c_str());
  STRCMP_EQUAL(k_old.c_str(), planned(false).in_force(5000).c_str());
}

TEST(ReleasePlan, SettledIsTheSameReleaseWithTheWayBack) {
  CHECK(planned(true).settled(999) == planned(true));
  CHECK(planned(false).settled(5000) == planned(false));
  const Plan settled = planned(true).settled(1000);
  STRCMP_EQUAL(k_new.c_str(), settled.current.c_str());
  STRCMP_EQUAL(k_old.c_str(), settled.before.c_str());
  CHECK(settled.next.empty());
  LONGS_EQUAL(7, settled.number);
  CHECK(settled.settled(9000) == settled);
}

TEST(ReleasePlan, NoneYetIsEmptyAndADamagedOneIsTold) {
  const test::TemporaryFolder folder;
  const auto none = plan_of(folder.path());
  SUCCEEDS(none);
  CHECK(*none == Plan{});
  folder.write(k_plan_file, "biteline-plan 1\ncurrent zz\n");
  FAILS_NAMING(Errc::BadFormat, "current", plan_of(folder.path()));
}

}  // namespace biteline::release
