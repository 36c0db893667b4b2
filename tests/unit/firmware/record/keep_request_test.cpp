// SPDX-License-Identifier: MIT
#include "firmware/record/keep_request.hpp"

#include <CppUTest/TestHarness.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::record {
namespace fs = std::filesystem;

TEST_GROUP(KeepRequest) {
  test::TemporaryFolder folder;
  fs::path series = folder.path() / "scan";

  KeepPolicy policy() const {
    return {.series = series, .asked = true, .realtime = runtime::RealtimeDemand::Ignored};
  }
  /// As a recorder leaves it.
  void let_one_wait() const {
    fs::create_directory(folder.path() / "scan-last");
    std::ofstream{folder.path() / "scan-last" / "recording.yaml"} << "";
  }
  static Result<std::string> outcome(KeepRequest & sut) {
    for (int i = 0; i < 5000; ++i) {
      if (std::optional<Result<std::string>> told = sut.take()) return *told;
      std::this_thread::sleep_for(std::chrono::milliseconds{2});
    }
    return fail(Errc::Timeout, "no answer");
  }
  static Result<std::string> kept(KeepRequest & sut, KeepWhich which, const LastScan& last = {}) {
    BITELINE_TRY(sut.begin(which, last));
    return outcome(sut);
  }
};

TEST(KeepRequest, WhoKeepsNothingOnRequestSaysWhatToDo) {
  KeepRequest none{{}};
  FAILS_NAMING(Errc::NotSupported, "records nothing; start it with --record",
               none.begin(KeepWhich::Last, {}));
  KeepPolicy all = policy();
  all.asked = false;
  KeepRequest always{all};
  FAILS_NAMING(Errc::NotSupported, "--record-asked", always.begin(KeepWhich::Next, {}));
  CHECK(!always.take());
}

TEST(KeepRequest, TheScanThatWaitsGetsItsNameAndIsToldWithWhatItLacks) {
  KeepRequest sut{policy()};
  FAILS_NAMING(Errc::FileNotFound, "no scan waits", kept(sut, KeepWhich::Last));
  let_one_wait();
  FAILS_NAMING(Errc::WrongState, "still being written", sut.begin(KeepWhich::Last, {.being_written = true}));
  const auto first = kept(sut, KeepWhich::Last);
  SUCCEEDS(first);
  STRCMP_EQUAL(series.c_str(), first->c_str());
  CHECK(fs::exists(series / "recording.yaml") && !fs::exists(folder.path() / "scan-last"));
  CHECK(!sut.take());
  let_one_wait();
  const auto second = kept(sut, KeepWhich::Last, {.fault = "disk full: scan.btln"});
  SUCCEEDS(second);
  STRCMP_EQUAL((series.string() + "-2; not whole: disk full: scan.btln").c_str(), second->c_str());
}

TEST(KeepRequest, TheNextOneIsWishedForAlsoWhileTheLastIsBeingWritten) {
  KeepRequest sut{policy()};
  const auto wished = kept(sut, KeepWhich::Next, {.being_written = true});
  SUCCEEDS(wished);
  STRCMP_CONTAINS("the scan that ends next", wished->c_str());
  CHECK(fs::exists(series.string() + ".wanted"));
  SUCCEEDS(sut.begin(KeepWhich::Next, {}));
  FAILS_NAMING(Errc::WrongState, "under way", sut.begin(KeepWhich::Next, {}));
  SUCCEEDS(outcome(sut));
  fs::permissions(folder.path(), fs::perms::owner_all);
  KeepPolicy nowhere = policy();
  nowhere.series = folder.path() / "not there" / "scan";
  KeepRequest lost{nowhere};
  FAILS_NAMING(Errc::WriteFailed, "not there", kept(lost, KeepWhich::Next));
}

TEST(KeepRequest, OnAFullDiskTheNextOneIsRefused) {
  // A child of its own: the mount goes with it.
  const pid_t child = ::fork();
  if (child == 0) {
    if (::unshare(CLONE_NEWNS) != 0 || ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=64k") != 0)
      ::_exit(77);
    std::ofstream{folder.path() / "other"} << std::string(200'000, 'x');
    KeepRequest sut{policy()};
    const auto refused = kept(sut, KeepWhich::Next);
    const bool right = !refused && refused.error().code == Errc::DiskFull &&
                       refused.error().where.view().find("make room") != std::string_view::npos;
    ::_exit(right && !fs::exists(series.string() + ".wanted") ? 0 : 1);
  }
  int status = 0;
  CHECK(::waitpid(child, &status, 0) == child && WIFEXITED(status));
  // 77: no right to mount here.
  CHECK(WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 77);
}

}  // namespace biteline::record
