// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "host/apps/biteline-host/arm_lock.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {
namespace {

// Far from the ports that a controller or a test listens on; the locks of other processes are not met.
std::uint16_t own_port() {
  return static_cast<std::uint16_t>(1 + ::getpid() % 1000);
}

}  // namespace

TEST_GROUP(Locks) {
  test::TemporaryFolder folder;
  std::filesystem::path file() const {
    return folder.path() / "lock";
  }
};

TEST(Locks, SecondHolderIsRefusedByTheFirstOnesName) {
  auto first = report::FileLock::take(file(), "biteline-host 17 of /results");
  SUCCEEDS(first);
  FAILS_NAMING(Errc::PeerRefused, "biteline-host 17 of /results", report::FileLock::take(file(), "another"));
}

TEST(Locks, LockEndsWithItsOwner) {
  { SUCCEEDS(report::FileLock::take(file(), "first")); }
  SUCCEEDS(report::FileLock::take(file(), "second"));
}

TEST(Locks, LockEndsWithAProcessThatIsKilled) {
  int ready[2];
  LONGS_EQUAL(0, ::pipe(ready));
  const pid_t child = ::fork();
  if (child == 0) {
    const auto held = report::FileLock::take(file(), "child");
    const char said = held ? 'y' : 'n';
    (void)!::write(ready[1], &said, 1);
    ::pause();
    ::_exit(0);
  }
  char said = 0;
  LONGS_EQUAL(1, ::read(ready[0], &said, 1));
  BYTES_EQUAL('y', said);
  FAILS_NAMING(Errc::PeerRefused, "child", report::FileLock::take(file(), "parent"));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  SUCCEEDS(report::FileLock::take(file(), "parent"));
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST(Locks, LinkInPlaceOfALockIsNotFollowed) {
  const auto target = folder.write("precious", "untouched");
  std::filesystem::create_symlink(target, file());
  CHECK(!report::FileLock::take(file(), "x").has_value());
  LONGS_EQUAL(9, std::filesystem::file_size(target));
}

TEST(Locks, HoldersWordsAreOnePrintableLine) {
  auto first = report::FileLock::take(file(), "\x1b[31mred\nsecond line");
  SUCCEEDS(first);
  const auto second = report::FileLock::take(file(), "x");
  CHECK(!second);
  CHECK(to_line(second.error()).find('\x1b') == std::string::npos);
  CHECK(to_line(second.error()).find('\n') == std::string::npos);
}

TEST(Locks, OneArmHasOneHolderWhateverItIsCalled) {
  auto first = hold_arm("127.0.0.1", own_port(), "biteline-host 1");
  SUCCEEDS(first);
  FAILS_NAMING(Errc::PeerRefused, "biteline-host 1", hold_arm("127.0.0.1", own_port(), "biteline-host 2"));
  SUCCEEDS(hold_arm("127.0.0.1", static_cast<std::uint16_t>(own_port() + 2000), "biteline-host 2"));
}

TEST(Locks, ArmAtAnAddressIsOneArmOnEveryPort) {
  auto first = hold_arm("192.0.2.77", 30001, "biteline-host 1");
  SUCCEEDS(first);
  FAILS_NAMING(Errc::PeerRefused, "biteline-host 1", hold_arm("192.0.2.77", 30002, "biteline-host 2"));
}

TEST(Locks, UnitAndByHandHoldOneArmInBothOrders) {
  // As the unit has it: all but its own folders is read-only, /tmp and the umask are its own.
  const auto in_a_unit = [](const char* open_folder, const auto& body) {
    int said[2];
    LONGS_EQUAL(0, ::pipe(said));
    const pid_t child = ::fork();
    if (child == 0) {
      char answer = 's';
      const bool alone =
          ::unshare(CLONE_NEWNS) == 0 && ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
          ::mount("none", "/tmp", "tmpfs", 0, nullptr) == 0 &&
          ::mount("/run", "/run", nullptr, MS_BIND | MS_REC, nullptr) == 0 &&
          (open_folder == nullptr || ::mount(open_folder, open_folder, nullptr, MS_BIND, nullptr) == 0) &&
          ::mount(nullptr, "/run", nullptr, MS_REMOUNT | MS_BIND | MS_RDONLY, nullptr) == 0;
      ::umask(0077);
      if (alone) answer = body();
      (void)!::write(said[1], &answer, 1);
      ::pause();
      ::_exit(0);
    }
    char answer = 0;
    LONGS_EQUAL(1, ::read(said[0], &answer, 1));
    ::close(said[0]);
    ::close(said[1]);
    return std::pair{child, answer};
  };
  const auto end = [](pid_t child) {
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  };
  std::optional<report::FileLock> held;
  const auto take = [&held](const char* who) {
    auto lock = hold_arm("192.0.2.78", 30001, who);
    if (lock) held.emplace(std::move(*lock));
    return lock ? 'y' : lock.error().code == Errc::PeerRefused ? 'n' : 'w';
  };
  const auto unit_first = in_a_unit("/run/lock", [&] { return take("the unit"); });
  if (unit_first.second == 's') return end(unit_first.first);  // no rights for a mount namespace
  BYTES_EQUAL('y', unit_first.second);
  FAILS_NAMING(Errc::PeerRefused, "the unit", hold_arm("192.0.2.78", 30001, "by hand"));
  const auto second_unit = in_a_unit("/run/lock", [&] { return take("another unit"); });
  BYTES_EQUAL('n', second_unit.second);
  end(second_unit.first);
  end(unit_first.first);
  BYTES_EQUAL('y', take("by hand"));
  const auto unit_later = in_a_unit("/run/lock", [&] { return take("the unit"); });
  BYTES_EQUAL('n', unit_later.second);
  end(unit_later.first);
  held.reset();
  // A unit that was not told where: it refuses, and takes no place of its own.
  const auto closed = in_a_unit(nullptr, [&] { return take("a closed unit"); });
  BYTES_EQUAL('w', closed.second);
  end(closed.first);
}

TEST(Locks, ArmWithoutAnAddressIsTold) {
  FAILS_NAMING(Errc::ConnectFailed, "no-such-arm.invalid", hold_arm("no-such-arm.invalid", 1, "x"));
}

}  // namespace biteline::service
