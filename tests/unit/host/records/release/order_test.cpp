// SPDX-License-Identifier: MIT
#include "host/records/release/order.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"

namespace biteline::release {
namespace {

const std::string k_old(64, 'a'), k_new(64, 'b');
constexpr std::int64_t k_before = 500, k_at = 1000, k_after = 2000;

HeardOrder heard(std::int64_t number, bool sure, const std::string& sha256 = k_new) {
  const Order order{.number = number, .sha256 = sha256, .at_ms = k_at, .cells = {"cell-1"}};
  // Whatever tells one order's text from another's.
  return {.order = order, .digest = std::string(60, 'd') + std::to_string(1000 + number), .sure = sure};
}

Plan heard_of(const Plan& stands, const HeardOrder& order, std::int64_t now_ms) {
  const Result<Plan> plan = follow(stands, &order, true, now_ms);
  SUCCEEDS(plan);
  return *plan;
}

/// In force since switch 5.
const Plan k_stands{.current = k_old,
                    .before = {},
                    .next = {},
                    .number = 5,
                    .newest = 5,
                    .order = std::string(60, 'd') + "1005"};

}  // namespace

TEST_GROUP(ReleaseOrder){};

TEST(ReleaseOrder, ComesBackAsItWasAndNothingElse) {
  const Order order{.number = 7, .sha256 = k_new, .at_ms = 1700, .cells = {"cell-1", "cell-22"}};
  const std::string sound = to_text(order);
  const auto back = read_order(sound);
  SUCCEEDS(back);
  STRCMP_EQUAL(sound.c_str(), to_text(*back).c_str());
  CHECK(back->is_for("cell-22"));
  CHECK(!back->is_for("cell-2"));
  for (std::size_t at = 0; at < sound.size(); ++at) CHECK_TEXT(!read_order(sound.substr(0, at)), "cut short");
  CHECK(!read_order(sound + "more\n"));
  for (const Order& wrong : {Order{.number = 0, .sha256 = k_new, .at_ms = 1, .cells = {"a"}},
                             Order{.number = 1LL << 31, .sha256 = k_new, .at_ms = 1, .cells = {"a"}},
                             Order{.number = 1, .sha256 = "../etc", .at_ms = 1, .cells = {"a"}},
                             Order{.number = 1, .sha256 = k_new, .at_ms = 1, .cells = {}},
                             Order{.number = 1, .sha256 = k_new, .at_ms = 1, .cells = {"a", ""}},
                             Order{.number = 1, .sha256 = k_new, .at_ms = 1, .cells = {"a/b"}}})
    CHECK_TEXT(!read_order(to_text(wrong)), to_text(wrong).c_str());
}

TEST(ReleaseOrder, IsKnownThenSureThenInForce) {
  Plan plan = heard_of(k_stands, heard(6, false), k_before);
  STRCMP_EQUAL(k_old.c_str(), plan.in_force(k_after).c_str());
  LONGS_EQUAL(6, plan.number);
  plan = heard_of(plan, heard(6, true), k_before);
  STRCMP_EQUAL(k_old.c_str(), plan.in_force(k_before).c_str());
  STRCMP_EQUAL(k_new.c_str(), plan.in_force(k_at).c_str());
  plan = heard_of(plan, heard(6, true), k_after);
  STRCMP_EQUAL(k_new.c_str(), plan.current.c_str());
  STRCMP_EQUAL(k_old.c_str(), plan.before.c_str());
  LONGS_EQUAL(6, plan.number);
  // Told again and again.
  CHECK(heard_of(plan, heard(6, true), k_after) == plan);
}

TEST(ReleaseOrder, OfACellThatWasCutOffBeforeItHeardThatItIsSure) {
  const Plan known = heard_of(k_stands, heard(6, false), k_before);
  STRCMP_EQUAL(k_new.c_str(), heard_of(known, heard(6, true), k_after).current.c_str());
}

TEST(ReleaseOrder, OldOneIsRefusedAndChangesNothing) {
  const Plan newer = heard_of(k_stands, heard(6, true), k_after - 1500);
  const Plan in_force = newer.settled(k_after);
  // The order that brought the release before it into force, signed as it was.
  const HeardOrder old = heard(5, true, k_old);
  FAILS_NAMING(Errc::WrongState, "a newer or another one is known", follow(in_force, &old, true, k_after));
  const HeardOrder forged_number = {.order = heard(6, true, k_old).order, .digest = k_old, .sure = true};
  FAILS_NAMING(Errc::WrongState, "a newer or another one is known",
               follow(in_force, &forged_number, true, k_after));
}

TEST(ReleaseOrder, WithdrawnOneCannotComeBackAfterItsTime) {
  Plan plan = heard_of(k_stands, heard(6, false), k_before);
  // The centre tells of the one in force again.
  plan = heard_of(plan, heard(5, true, k_old), k_before);
  STRCMP_EQUAL("", plan.next.c_str());
  LONGS_EQUAL(5, plan.number);
  LONGS_EQUAL(6, plan.newest);
  const HeardOrder again = heard(6, true);
  FAILS_NAMING(Errc::WrongState, "first heard after its time", follow(plan, &again, true, k_after));
  // Before it, it may: a message that came late took it away.
  STRCMP_EQUAL(k_new.c_str(), heard_of(plan, heard(6, false), k_before).next.c_str());
  // One that this cell never heard of is not brought up afterwards either.
  const HeardOrder unheard = heard(7, true);
  FAILS_NAMING(Errc::WrongState, "first heard after its time", follow(plan, &unheard, true, k_after));
}

TEST(ReleaseOrder, NewCellTakesWhatTheOthersHave) {
  STRCMP_EQUAL(k_new.c_str(), heard_of(Plan{}, heard(6, true), k_after).current.c_str());
}

TEST(ReleaseOrder, SureOneStaysWhateverIsTold) {
  const Plan sure = heard_of(k_stands, heard(6, true), k_before);
  CHECK(*follow(sure, nullptr, false, k_before) == sure);
  CHECK(heard_of(sure, heard(5, true, k_old), k_before) == sure);
  const HeardOrder newer = heard(7, false, k_old);
  FAILS_NAMING(Errc::WrongState, "another one is sure", follow(sure, &newer, true, k_before));
}

TEST(ReleaseOrder, WithoutItsReleaseIsNotKnown) {
  const HeardOrder order = heard(6, false);
  const auto plan = follow(k_stands, &order, false, k_before);
  SUCCEEDS(plan);
  CHECK(*plan == k_stands);
}

TEST(ReleaseOrder, WithdrawnByNoWordAtAll) {
  const Plan known = heard_of(k_stands, heard(6, false), k_before);
  const auto plan = follow(known, nullptr, false, k_before);
  SUCCEEDS(plan);
  STRCMP_EQUAL("", plan->next.c_str());
  LONGS_EQUAL(0, plan->number);
  LONGS_EQUAL(6, plan->newest);
  STRCMP_EQUAL(k_old.c_str(), plan->in_force(k_after).c_str());
}

}  // namespace biteline::release
