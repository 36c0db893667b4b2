// SPDX-License-Identifier: MIT
// systemd's side is a socket of ours; /dev/watchdog itself is met in tests/vm.
#include <CppUTest/TestHarness.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstring>

#include "hal/linux/ptp/phc.hpp"
#include "hal/linux/watchdog/kernel_watchdog.hpp"
#include "hal/linux/watchdog/line_watchdog.hpp"
#include "hal/linux/watchdog/systemd_watchdog.hpp"
#include "tests/hal/conformance/watchdog.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

TEST_GROUP(SystemdWatchdog) {
  Descriptor systemd{::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)};
  std::string address{"@biteline-test-" + std::to_string(::getpid())};

  void setup() override {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path + 1, address.data() + 1, address.size() - 1);
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address.size());
    CHECK_EQUAL(0, ::bind(systemd.number(), reinterpret_cast<const sockaddr*>(&name), size));
  }
  [[nodiscard]] std::string heard() const {
    std::array<char, 200> text{};
    const ssize_t size = ::recv(systemd.number(), text.data(), text.size(), 0);
    return {text.data(), static_cast<std::size_t>(size < 0 ? 0 : size)};
  }
};

TEST(SystemdWatchdog, FollowsItsStateTable) {
  const auto sut = SystemdWatchdog::open(address).value();
  CHECK(sut->feed().error().code == Errc::WrongState);
  CHECK(sut->arm(2500us).value() == 2500us);
  CHECK(heard() == "READY=1\nWATCHDOG=1\nWATCHDOG_USEC=2500");
  CHECK(sut->feed().has_value());
  CHECK(heard() == "WATCHDOG=1");
  CHECK(sut->disarm().has_value());
  CHECK(heard() == "WATCHDOG_USEC=0");
  CHECK(sut->feed().error().code == Errc::WrongState);
}

TEST(SystemdWatchdog, SystemdThatIsGoneIsSaid) {
  const auto sut = SystemdWatchdog::open(address).value();
  CHECK(sut->arm(1s).has_value());
  systemd.close();
  CHECK(sut->feed().error().code == Errc::DeviceLost);
}

TEST(SystemdWatchdog, FullSocketIsAnOverrunAndNoWait) {
  const auto sut = SystemdWatchdog::open(address).value();
  CHECK(sut->arm(1s).has_value());
  Result<void> fed;
  for (int i = 0; i < 100000 && fed; ++i) fed = sut->feed();
  CHECK(fed.error().code == Errc::Overrun);
}

TEST(SystemdWatchdog, ProcessNotStartedBySystemdIsSaid) {
  ::unsetenv("NOTIFY_SOCKET");
  CHECK(SystemdWatchdog::open_from_environment().error().code == Errc::DeviceNotFound);
}

TEST_GROUP(KernelDevices){};

TEST(KernelDevices, MissingNodeIsDeviceNotFound) {
  CHECK(KernelWatchdog::open("/dev/biteline-no-such-watchdog").error().code == Errc::DeviceNotFound);
  CHECK(Phc::open("/dev/biteline-no-such-ptp").error().code == Errc::DeviceNotFound);
}

TEST(KernelDevices, PlainFileIsNoDevice) {
  CHECK(KernelWatchdog::open("/etc/passwd").error().code == Errc::DeviceNotFound);
  CHECK(Phc::open("/etc/passwd").error().code == Errc::NotSupported);
}

class NotedLine final : public GpioOut {
 public:
  explicit NotedLine(std::string& levels) : levels_{levels} {}
  Result<void> set(bool active) noexcept override {
    levels_ += active ? '1' : '0';
    return {};
  }
  Result<bool> read_back() noexcept override { return levels_.ends_with('1'); }

 private:
  std::string& levels_;
};

TEST_GROUP(LineWatchdog){};

TEST(LineWatchdog, EveryMealIsAnEdgeAndTheLastLevelIsLow) {
  std::string levels;
  LineWatchdog sut{std::make_unique<NotedLine>(levels)};
  conformance::check_watchdog(sut);
  levels.clear();
  CHECK(sut.arm(1s).has_value());
  for (int i = 0; i < 4; ++i) CHECK(sut.feed().has_value());
  CHECK(sut.disarm().has_value());
  STRCMP_EQUAL("101010", levels.c_str());
}

}  // namespace
}  // namespace biteline::hal
