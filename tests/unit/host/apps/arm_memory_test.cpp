// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/arm_memory.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {

TEST_GROUP(ArmMemory) {
  test::TemporaryFolder folder;
  Result<memory::Memory> memory = memory::Memory::open(folder.path() / memory::k_memory_file);

  void show(double give_mm_per_m_s2, uncertainty::ArmSource source = uncertainty::ArmSource::Table) {
    SUCCEEDS(remember_arm(
        "scan-0001",
        uncertainty::ArmMotion{.sigma_mm = 0.02, .source = source, .give_mm_per_m_s2 = give_mm_per_m_s2},
        *memory));
  }
  std::optional<uncertainty::ArmGive> remembered() {
    const auto arm = remembered_arm(*memory);
    SUCCEEDS(arm);
    return *arm;
  }
};

TEST(ArmMemory, IsSilentUntilThreeScansHaveShownTheArm) {
  show(0.03);
  show(0.05);
  CHECK_FALSE(remembered().has_value());
  show(0.04);
  const auto sut = remembered();
  CHECK(sut.has_value());
  DOUBLES_EQUAL(0.05, sut->mm_per_m_s2, 1e-12);
  CHECK(sut->source == uncertainty::ArmSource::EarlierScans);
}

TEST(ArmMemory, OneScanInTenMayBeWorse) {
  for (int i = 0; i < 19; ++i) show(0.03 + 0.0001 * i);
  show(0.5);
  DOUBLES_EQUAL(0.0318, remembered()->mm_per_m_s2, 1e-12);
}

TEST(ArmMemory, AnArmThatWasMendedIsForgotten) {
  for (int i = 0; i < 10; ++i) show(0.5);
  for (int i = 0; i < 20; ++i) show(0.03);
  DOUBLES_EQUAL(0.03, remembered()->mm_per_m_s2, 1e-12);
}

TEST(ArmMemory, WhatAScanDidNotShowItselfIsNotKept) {
  for (const auto source : {uncertainty::ArmSource::Assumed, uncertainty::ArmSource::EarlierScans,
                            uncertainty::ArmSource::Stated, uncertainty::ArmSource::Assumed})
    show(0.1, source);
  SUCCEEDS(remember_arm("scan-0002", {}, *memory));
  CHECK_FALSE(remembered().has_value());
  CHECK(memory->log_rows(0, 10)->empty());
}

TEST(ArmMemory, ATextThatIsNoneIsBegunAnew) {
  memory::LogRow event;
  event.who = "anna";
  event.action = "test";
  SUCCEEDS(memory->put_setting("arm_give", "{nothing", event));
  CHECK_FALSE(remembered().has_value());
  for (int i = 0; i < 3; ++i) show(0.03);
  CHECK(remembered().has_value());
}

}  // namespace biteline::service
