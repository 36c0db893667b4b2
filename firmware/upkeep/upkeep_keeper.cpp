// SPDX-License-Identifier: MIT
#include "firmware/upkeep/upkeep_keeper.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <ctime>
#include <string>
#include <utility>

namespace biteline::upkeep {
namespace {

namespace fs = std::filesystem;

constexpr double k_between_writes_s = 600;

/// On the disk before it has its name: a cut leaves the file of before.
Result<void> replace(const fs::path& folder, const std::string& text) {
  const fs::path file = folder / k_file, beside = folder / "upkeep.yaml.new";
  // Others may read it: there is no secret in it.
  const int fd = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (fd < 0) return fail_errno(Errc::WriteFailed, errno, "%s", beside.c_str());
  bool good = ::fchmod(fd, 0644) == 0;
  good = good && ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  good = good && ::fsync(fd) == 0;
  int reason = good ? 0 : errno;
  if (::close(fd) != 0 && good) {
    good = false;
    reason = errno;
  }
  if (good && ::rename(beside.c_str(), file.c_str()) != 0) {
    good = false;
    reason = errno;
  }
  if (!good) {
    ::unlink(beside.c_str());
    return fail_errno(Errc::WriteFailed, reason, "%s", file.c_str());
  }
  const int place = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (place >= 0) {
    ::fsync(place);
    ::close(place);
  }
  return {};
}

}  // namespace

double since_boot_s() {
  timespec now{};
  ::clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Boot present_boot() {
  Boot boot{.id = {}, .up_s = since_boot_s()};
  const int fd = ::open("/proc/sys/kernel/random/boot_id", O_RDONLY | O_CLOEXEC);
  if (fd < 0) return boot;
  char text[64];
  const ssize_t length = ::read(fd, text, sizeof text);
  ::close(fd);
  if (length > 0) boot.id.assign(text, static_cast<std::size_t>(length));
  boot.id.erase(std::min(boot.id.size(), boot.id.find_first_not_of("0123456789abcdef-")));
  return boot;
}

Result<UpkeepKeeper> UpkeepKeeper::open(const fs::path& folder, const Boot& boot) {
  Upkeep upkeep;
  const Result<Upkeep> before = read_upkeep(folder / k_file);
  if (before) {
    upkeep = *before;
  } else if (before.error().code != Errc::FileNotFound) {
    std::fprintf(stderr, "biteline-sensor: the unit's count begins anew: %s\n",
                 to_line(before.error()).c_str());
    std::error_code ignored;
    fs::rename(folder / k_file, folder / "upkeep.bad.yaml", ignored);
  }
  if (!before || boot.id != upkeep.boot_id) ++upkeep.boots;
  upkeep.boot_id = boot.id;
  ++upkeep.starts;
  UpkeepKeeper keeper{folder, upkeep, boot.up_s};
  BITELINE_TRY(keeper.write());
  return keeper;
}

UpkeepKeeper::UpkeepKeeper(fs::path folder, Upkeep upkeep, double up_s)
    : folder_{std::move(folder)}, upkeep_{upkeep}, seen_s_{up_s}, written_s_{up_s} {}

void UpkeepKeeper::see(const Look& look) {
  const double since_s = std::max(0.0, look.up_s - seen_s_);
  seen_s_ = look.up_s;
  upkeep_.run_s += since_s;
  // Lit at both ends: a time that began or ended in between is as long as half of them, and few.
  if (lit_ && look.laser_on) upkeep_.laser_s += since_s;
  if (lit_ != look.laser_on) upkeep_.laser_s += since_s / 2;
  if (look.laser_on && !lit_) ++upkeep_.lightings;
  lit_ = look.laser_on;
  if (look.frames > seen_frames_) upkeep_.frames += look.frames - seen_frames_;
  seen_frames_ = std::max(seen_frames_, look.frames);
  // A camera that says nonsense once would cost the whole count at the next start.
  if (!look.head_degc || !k_degc.holds(*look.head_degc)) return;
  upkeep_.hottest_degc = std::max(upkeep_.hottest_degc.value_or(*look.head_degc), *look.head_degc);
  upkeep_.coldest_degc = std::min(upkeep_.coldest_degc.value_or(*look.head_degc), *look.head_degc);
}

bool UpkeepKeeper::due() const {
  return !lit_ && seen_s_ - written_s_ >= k_between_writes_s;
}

Result<void> UpkeepKeeper::write() {
  // Also where it fails: a full disk is asked again in ten minutes.
  written_s_ = seen_s_;
  return replace(folder_, upkeep_text(upkeep_));
}

}  // namespace biteline::upkeep
