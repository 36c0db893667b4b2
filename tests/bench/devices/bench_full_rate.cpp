// SPDX-License-Identifier: MIT
// bench_full_rate [SECONDS]: the sensor program on whole frames over GigE Vision's loopback, for as long as
// asked: the rate, what was lost, and whether its memory grows.  Without an argument 30 s, so that ./run
// bench stays short; a release has 600.  Then again with --record into a folder, and into an MCAP file, for
// at most 20 s each: what the disk takes, beside what it takes of one plain file.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/mcap/reader.hpp"
#include "common/session/recording_facts.hpp"
#include "host/intake/sensor_link.hpp"
#include "host/intake/sensor_process.hpp"
#include "tests/support/picture_cell/picture_cell.hpp"
#include "tests/support/picture_cell/scan_account.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace biteline;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds k_patience{30};
/// Buffers, rings and the store's first pages are in use by then.
constexpr seconds k_warm_up{10};

/// Resident memory of a process (proc(5), VmRSS).
double resident_megabytes(int pid) {
  std::ifstream status{"/proc/" + std::to_string(pid) + "/status"};
  for (std::string key; status >> key;) {
    double kilobytes = 0;
    if (key == "VmRSS:" && status >> kilobytes) return kilobytes / 1024;
  }
  return 0;
}

void row(const char* what, double ours, const char* unit, const char* target,
         const char* bench = "full_rate") {
  std::printf("{\"bench\":\"devices.%s\",\"what\":\"%s\",\"ours\":%.6g,\"unit\":\"%s\",\"target\":%s}\n",
              bench, what, ours, unit, target);
}

enum class Recording { None, Folder, File };

/// Of one file of 256 MB that is written plainly, and on the disk at the end; 0: it could not be written.
double disk_megabytes_s(const std::filesystem::path& folder) {
  constexpr std::size_t k_piece = 1U << 20U, k_pieces = 256;
  const std::filesystem::path file = folder / "plain";
  std::vector<char> piece(k_piece);
  for (std::size_t i = 0; i < piece.size(); ++i) piece[i] = static_cast<char>(i * 2654435761U >> 13U);
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (fd < 0) return 0;
  const Clock::time_point begin = Clock::now();
  bool good = true;
  for (std::size_t i = 0; i < k_pieces && good; ++i)
    good = ::write(fd, piece.data(), piece.size()) == static_cast<ssize_t>(piece.size());
  good = good && ::fdatasync(fd) == 0;
  const double seconds_taken = std::chrono::duration<double>(Clock::now() - begin).count();
  ::close(fd);
  std::filesystem::remove(file);
  return good ? 1e-6 * static_cast<double>(k_piece * k_pieces) / seconds_taken : 0;
}

Result<session::RecordingFacts> facts_of(const std::filesystem::path& recording) {
  if (std::filesystem::is_directory(recording))
    return session::read_recording_facts(recording / "recording.yaml");
  const test::TemporaryFolder folder;
  std::filesystem::path facts;
  BITELINE_ASSIGN(
      const mcap::FileEnd end,
      mcap::read_messages(
          recording, {.on_message = {},
                      .on_attachment = [&](const mcap::Attachment& file) -> Result<void> {
                        if (file.name == "recording.yaml")
                          facts = folder.write("facts.yaml", std::string{file.data.begin(), file.data.end()});
                        return {};
                      },
                      .on_metadata = {}}));
  if (!end.damage.empty()) return fail(Errc::BadFormat, "%s: %.200s", recording.c_str(), end.damage.c_str());
  return session::read_recording_facts(facts);
}

std::uint64_t bytes_of(const std::filesystem::path& recording) {
  if (!std::filesystem::is_directory(recording)) return std::filesystem::file_size(recording);
  std::uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator{recording})
    if (entry.is_regular_file()) bytes += entry.file_size();
  return bytes;
}

class Run {
 public:
  Run(test::PictureCell& cell, intake::SensorProcess& sensor, intake::SensorLink& link)
      : sensor_{sensor}, link_{link}, account_{cell} {}

  Result<void> run(seconds duration) {
    bool known = false;
    while (!known) {
      BITELINE_ASSIGN(const auto event, link_.next(milliseconds{100}));
      known = event && std::holds_alternative<intake::Hello>(*event);
    }
    link_.command({.id = 1, .command = wire::Command::StartScan});
    const Clock::time_point give_up = Clock::now() + k_patience;
    while (account_.profiles == 0 && Clock::now() < give_up) BITELINE_TRY(step());
    const Clock::time_point begin = Clock::now();
    while (Clock::now() - begin < duration && !account_.end) {
      BITELINE_TRY(step());
      measure_memory(Clock::now() - begin);
    }
    duration_s_ = std::chrono::duration<double>(Clock::now() - begin).count();
    if (!account_.end) link_.command({.id = 2, .command = wire::Command::StopScan});
    const Clock::time_point stop_by = Clock::now() + k_patience;
    while (!account_.end && Clock::now() < stop_by) BITELINE_TRY(step());
    if (!account_.end) return fail(Errc::Timeout, "the scan's end never came");
    if (account_.end->errc != 0) return fail(Errc::DeviceError, "%s", account_.end->where.c_str());
    return {};
  }

  /// Of a run with --record; call once the sensor has ended.  True: no profile, message or pose is lost.
  Result<bool> tell_recording(const std::filesystem::path& recording, double disk_megabytes_s) const {
    BITELINE_ASSIGN(const session::RecordingFacts facts, facts_of(recording));
    const double written_megabytes_s = 1e-6 * static_cast<double>(bytes_of(recording)) / duration_s_;
    const wire::Counters& counters = account_.end->counters;
    const auto all = static_cast<double>(facts.pictures + facts.pictures_left_out);
    const std::uint64_t lost = counters.profiles_dropped + counters.messages_lost + account_.lost,
                        left_out = facts.messages_left_out + facts.poses_left_out;
    const char* const bench = std::filesystem::is_directory(recording) ? "recording" : "recording_mcap";
    const auto tell = [bench](const char* what, double ours, const char* unit, const char* target) {
      row(what, ours, unit, target, bench);
    };
    tell("duration", duration_s_, "s", "null");
    tell("rate", static_cast<double>(counters.frames) / duration_s_, "1/s", "100");
    tell("written", written_megabytes_s, "MB/s", "null");
    tell("one plain file in the same folder", disk_megabytes_s, "MB/s", "null");
    if (disk_megabytes_s > 0)
      tell("written, of the plain file's rate", 100 * written_megabytes_s / disk_megabytes_s, "%", "null");
    tell("pictures kept", all > 0 ? 100 * static_cast<double>(facts.pictures) / all : 0, "%", "null");
    tell("profiles lost", static_cast<double>(lost), "1", "0");
    tell("frames lost or damaged", static_cast<double>(counters.frames_lost + counters.frames_damaged), "1",
         "0");
    tell("messages and poses left out", static_cast<double>(left_out), "1", "0");
    return lost + left_out == 0;
  }

  /// True: nothing is lost, doubled or wrong.
  bool tell(std::uint64_t triggers_missed) const {
    const wire::Counters& counters = account_.end->counters;
    const std::uint64_t lost = counters.frames_lost + counters.frames_damaged + counters.profiles_dropped +
                               counters.messages_lost + account_.lost;
    row("duration", duration_s_, "s", "null");
    row("frames of 1626 x 1236", static_cast<double>(counters.frames), "1", "null");
    row("rate", static_cast<double>(counters.frames) / duration_s_, "1/s", "100");
    row("frames lost or damaged", static_cast<double>(counters.frames_lost + counters.frames_damaged), "1",
        "0");
    row("profiles dropped in the sensor", static_cast<double>(counters.profiles_dropped), "1", "0");
    row("messages lost", static_cast<double>(counters.messages_lost + account_.lost), "1", "0");
    row("profiles doubled or out of order", static_cast<double>(account_.disordered), "1", "0");
    row("profiles of other bits", static_cast<double>(account_.wrong), "1", "0");
    row("triggers that the simulated camera missed", static_cast<double>(triggers_missed), "1", "null");
    row("sensor's memory", newest_megabytes_, "MB", "null");
    row("sensor's memory growth after warm-up", newest_megabytes_ - warm_megabytes_, "MB", "null");
    return lost == 0 && account_.frames_missing == 0 && account_.disordered == 0 && account_.wrong == 0 &&
           account_.profiles == counters.profiles;
  }

 private:
  Result<void> step() {
    BITELINE_ASSIGN(const auto event, link_.next(milliseconds{20}));
    if (event) account_.take(*event);
    return {};
  }
  void measure_memory(Clock::duration since_begin) {
    if (since_begin < next_measure_) return;
    next_measure_ = since_begin + seconds{5};
    newest_megabytes_ = resident_megabytes(sensor_.child().pid());
    if (since_begin < k_warm_up) warm_megabytes_ = newest_megabytes_;
    std::fprintf(stderr, "%6.0f s  %8llu profiles  %.1f MB\n",
                 std::chrono::duration<double>(since_begin).count(),
                 static_cast<unsigned long long>(account_.profiles), newest_megabytes_);
  }

  intake::SensorProcess& sensor_;
  intake::SensorLink& link_;
  test::ScanAccount account_;
  Clock::duration next_measure_{0};
  double warm_megabytes_{0}, newest_megabytes_{0};
  double duration_s_{0};
};

Result<bool> bench(seconds duration, Recording recording) {
  const test::TemporaryFolder folder;
  BITELINE_ASSIGN(const auto cell,
                  test::PictureCell::open({.width_px = 1626, .height_px = 1236, .rate_hz = 101}));
  const std::string board_file = folder.write("board.yaml", cell->board_file_text());
  const std::string sensor_file = folder.write("sensor.yaml", cell->sensor_file_text());
  BITELINE_ASSIGN(const auto program, intake::find_sensor_program());
  // A store that is full after the warm-up: from then on every profile takes the room of an old one.
  std::vector<std::string> arguments{"--source", "board:" + board_file, "--sensor", sensor_file, "--store-mb",
                                     "16",       "--rt=required"};
  const std::filesystem::path session =
      folder.path() / (recording == Recording::File ? "session.mcap" : "session");
  const bool records = recording != Recording::None;
  const double plain_megabytes_s = records ? disk_megabytes_s(folder.path()) : 0;
  if (records) arguments.insert(arguments.begin(), {"--record", session.string()});
  auto sensor = intake::SensorProcess::start(program, arguments, k_patience);
  if (!sensor) {
    std::fprintf(stderr, "%s; as any program then\n", to_line(sensor.error()).c_str());
    arguments.back() = "--rt=ignore";
    sensor = intake::SensorProcess::start(program, arguments, k_patience);
  }
  if (!sensor) return tl::unexpected<Error>{sensor.error()};
  intake::SensorLinkConfig config;
  config.sensor = sensor->endpoint();
  BITELINE_ASSIGN(const auto link, intake::SensorLink::open(config));
  Run run{*cell, *sensor, *link};
  BITELINE_TRY(run.run(duration));
  if (records) {
    sensor->child().stop(k_patience);
    return run.tell_recording(session, plain_megabytes_s);
  }
  return run.tell(cell->triggers_missed());
}

}  // namespace

int main(int argc, char** argv) {
  const seconds duration{argc > 1 ? std::atoi(argv[1]) : 30};
  Result<bool> done = bench(duration, Recording::None);
  for (const Recording kind : {Recording::Folder, Recording::File}) {
    if (!done) break;
    const Result<bool> recorded = bench(std::min(duration, seconds{20}), kind);
    done = recorded ? Result<bool>{*done && *recorded} : recorded;
  }
  if (!done) {
    std::fprintf(stderr, "bench_full_rate: %s\n", to_line(done.error()).c_str());
    return done.error().code == Errc::ConnectFailed ? 77 : 1;
  }
  return *done ? 0 : 1;
}
