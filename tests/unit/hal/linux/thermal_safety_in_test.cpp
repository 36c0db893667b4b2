// SPDX-License-Identifier: MIT
#include "hal/linux/thermal/thermal_safety_in.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::hal {
namespace {

class ClosedLoop final : public SafetyIn {
 public:
  Result<SafetyInputs> read() noexcept override {
    return SafetyInputs{.interlock_closed = true, .key_on = true, .read_at = {}};
  }
};

}  // namespace

TEST_GROUP(ThermalSafetyIn) {
  test::TemporaryFolder folder;

  std::string file(const char* millidegrees) const {
    return folder.write("temp", std::string{millidegrees} + "\n");
  }
  /// Six looks: one of them reads.
  static Result<SafetyInputs> look(SafetyIn & sut) {
    for (int i = 0; i < 5; ++i) {
      if (auto inputs = sut.read(); !inputs || inputs->too_hot) return inputs;
    }
    return sut.read();
  }
};

TEST(ThermalSafetyIn, HeadBeyondItsLimitIsTooHotAndCoolsDown) {
  const std::string path = file("59999");
  const auto sut =
      ThermalSafetyIn::open(std::make_unique<ClosedLoop>(), {.file = path, .max_degc = 60}).value();
  CHECK(!sut->read()->too_hot);
  CHECK(sut->read()->interlock_closed && sut->read()->key_on);
  file("60001");
  CHECK(look(*sut)->too_hot);
  file("41500");
  for (int i = 0; i < 5; ++i) (void)sut->read();
  CHECK(!sut->read()->too_hot);
}

TEST(ThermalSafetyIn, SensorThatCannotBeReadIsUnknownAndNoPermission) {
  const std::string path = file("20000");
  const auto sut =
      ThermalSafetyIn::open(std::make_unique<ClosedLoop>(), {.file = path, .max_degc = 60}).value();
  std::filesystem::remove(path);
  CHECK(!look(*sut).has_value());
  CHECK(!ThermalSafetyIn::open(std::make_unique<ClosedLoop>(), {.file = path, .max_degc = 60}).has_value());
}

}  // namespace biteline::hal
