// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>
#include <sys/wait.h>
#include <unistd.h>

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

TEST(Locks, ArmWithoutAnAddressIsTold) {
  FAILS_NAMING(Errc::ConnectFailed, "no-such-arm.invalid", hold_arm("no-such-arm.invalid", 1, "x"));
}

}  // namespace biteline::service
