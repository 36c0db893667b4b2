// SPDX-License-Identifier: MIT
// On a folder of plain files that look like /sys/class/pwm; the real one is met in tests/vm.
#include "hal/linux/pwm/sysfs_pwm.hpp"

#include <CppUTest/TestHarness.h>

#include <filesystem>
#include <fstream>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

TEST_GROUP(SysfsPwm) {
  fs::path root;

  void setup() override {
    std::string pattern = (fs::temp_directory_path() / "biteline-pwm-XXXXXX").string();
    root = ::mkdtemp(pattern.data());
    fs::create_directories(root / "devices/3f20c000.pwm");
    fs::create_directories(root / "pwm/pwmchip0/pwm1");
    fs::create_directory_symlink(root / "devices/3f20c000.pwm", root / "pwm/pwmchip0/device");
    for (const char* attribute : {"period", "duty_cycle"}) write(attribute, 0);
    write("enable", 1);  // left running by a killed process
  }
  void teardown() override {
    fs::remove_all(root);
  }

  [[nodiscard]] std::string path(const char* attribute) const {
    return (root / "pwm/pwmchip0/pwm1" / attribute).string();
  }
  void write(const char* attribute, int value) const {
    std::ofstream{path(attribute)} << value << "\n";
  }
  [[nodiscard]] std::int64_t read(const char* attribute) const {
    return read_integer(path(attribute).c_str()).value();
  }
  [[nodiscard]] Result<std::unique_ptr<SysfsPwm>> open(const char* chip = "3f20c000.pwm") const {
    return SysfsPwm::open({.chip = chip, .channel = 1, .root = (root / "pwm").string()});
  }
};

TEST(SysfsPwm, OpeningStopsATrainLeftRunning) {
  const auto sut = open();
  CHECK(sut.has_value());
  CHECK_EQUAL(0, read("enable"));
}

TEST(SysfsPwm, IsFoundByNumberAndByItsDevice) {
  CHECK(open("pwmchip0").has_value());
  CHECK(open("3f20c000.pwm").has_value());
  CHECK(open("pwmchip7").error().code == Errc::DeviceNotFound);
}

TEST(SysfsPwm, FollowsItsStateTable) {
  auto sut = open().value();
  CHECK(sut->start().error().code == Errc::WrongState);
  CHECK(sut->configure({.period = 10ms, .pulse = 100us}).has_value());
  CHECK_FALSE(sut->running());
  CHECK(sut->start().has_value());
  CHECK(sut->running());
  CHECK_EQUAL(1, read("enable"));
  CHECK_EQUAL(10'000'000, read("period"));
  CHECK_EQUAL(100'000, read("duty_cycle"));
  sut.reset();
  CHECK_EQUAL(0, read("enable"));
}

TEST(SysfsPwm, PulseLongerThanThePeriodIsRefused) {
  auto sut = open().value();
  CHECK(sut->configure({.period = 1ms, .pulse = 2ms}).error().code == Errc::BadValue);
  CHECK(sut->configure({.period = 0ms, .pulse = 0ms}).error().code == Errc::BadValue);
}

}  // namespace
}  // namespace biteline::hal
