// SPDX-License-Identifier: MIT
// What becomes of a scan that has a line, over all facts.
#include "host/apps/biteline-host/next_of.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::service {
namespace {

constexpr unsigned k_facts = 1U << 10U;

NextFacts facts_of_bits(unsigned bits) {
  const auto bit = [bits](unsigned which) { return (bits >> which & 1U) != 0; };
  return {.sends = bit(0),
          .has_path = bit(1),
          .doors = bit(2),
          .waits = bit(3),
          .confirmed = bit(4),
          .seen = bit(5),
          .asks_by_gate = bit(6),
          .asked_to_hold = bit(7),
          .drift_stops = bit(8),
          .looks = bit(9) ? "somebody has to look" : ""};
}

bool needs_eyes(const NextFacts& facts) {
  return facts.drift_stops || facts.asked_to_hold || !facts.looks.empty();
}

}  // namespace

TEST_GROUP(NextOf){template <class Holds> static void for_all(Holds && holds){
    for (unsigned bits = 0; bits < k_facts; ++bits){const NextFacts facts = facts_of_bits(bits);
CHECK_TEXT(holds(facts, next_of(facts)), ("facts " + std::to_string(bits)).c_str());
}  // namespace biteline::service
}
}
;

TEST(NextOf, NothingIsSentUnaskedOrUnseen) {
  for_all([](const NextFacts& facts, const NextStep& step) {
    if (step.next != Next::Send) return true;
    return facts.sends && facts.has_path && !facts.waits && (facts.confirmed || !needs_eyes(facts));
  });
}

TEST(NextOf, WhatSomebodyCanBeAskedAboutIsNotRefused) {
  for_all([](const NextFacts& facts, const NextStep& step) {
    return step.next != Next::Refuse || (!facts.doors && !facts.confirmed && needs_eyes(facts));
  });
}

TEST(NextOf, OnlyWhatAPersonIsNeededForWaits) {
  for_all([](const NextFacts& facts, const NextStep& step) {
    const bool asks =
        facts.has_path && facts.doors && !facts.confirmed && (facts.asks_by_gate || needs_eyes(facts));
    return (step.next == Next::Hold) == (facts.sends && (facts.waits || asks));
  });
}

TEST(NextOf, WithoutAPathThatGoesToAnArmOnlyFilesAreLeft) {
  for_all([](const NextFacts& facts, const NextStep& step) {
    return (step.next == Next::Keep) == (!facts.sends || (!facts.waits && !facts.has_path));
  });
}

TEST(NextOf, ARefusalSaysWhyAndARecordingStaysWhileAYesIsPossible) {
  for_all([](const NextFacts& facts, const NextStep& step) {
    const bool yes_is_possible =
        step.next == Next::Hold || step.next == Next::Refuse ||
        (step.next == Next::Send && !facts.confirmed && (!facts.seen || facts.asks_by_gate));
    return step.why.empty() == (step.next != Next::Refuse) && step.keeps_recording == yes_is_possible;
  });
}

TEST(NextOf, TheWorstReasonIsTold) {
  NextFacts facts{.sends = true, .has_path = true, .asked_to_hold = true};
  STRCMP_CONTAINS("no door is open", next_of(facts).why.c_str());
  facts.looks = "it was worked before";
  STRCMP_EQUAL("it was worked before", next_of(facts).why.c_str());
  facts.drift_stops = true;
  STRCMP_CONTAINS("drifted", next_of(facts).why.c_str());
}

}  // namespace biteline::service
