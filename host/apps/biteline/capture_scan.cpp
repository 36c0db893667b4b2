// SPDX-License-Identifier: MIT
// biteline capture scan: one live scan of the unit's camera and robot, kept as a session.
#include "host/apps/biteline/capture_scan.hpp"

#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/options/command.hpp"
#include "host/intake/capture/scan_capture.hpp"
#include "host/report/json_text.hpp"

namespace biteline::app {
namespace {

using Clock = std::chrono::steady_clock;

struct CaptureScanOptions {
  capture::ScanOrder order{
      .board = "/etc/biteline/board.yaml", .sensor = "/etc/biteline/sensor.yaml", .session = {}};
  double seconds{600};
};

/// What a person sees and says while the scan is on.
class Watch {
 public:
  Watch(const GlobalOptions& global, double longest_s)
      : quiet_{global.quiet || global.json},
        ends_{Clock::now() +
              std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{longest_s})} {
    if (quiet_) return;
    std::printf("the scan ends with the robot's own, after %.0f s, or with Enter\n", longest_s);
    std::fflush(stdout);
  }

  bool operator()(const capture::ScanCount& count) {
    constexpr std::chrono::seconds k_between_lines{2};
    if (!quiet_ && Clock::now() - told_ > k_between_lines) {
      told_ = Clock::now();
      std::printf("%llu profiles, %llu points, %llu profiles without stripe\n",
                  static_cast<unsigned long long>(count.profiles),
                  static_cast<unsigned long long>(count.points),
                  static_cast<unsigned long long>(count.without_stripe));
      std::fflush(stdout);
    }
    return Clock::now() < ends_ && !enter_came();
  }

 private:
  /// Without waiting.  An input that has ended says nothing any more.
  bool enter_came() {
    pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (input_over_ || ::poll(&input, 1, 0) <= 0) return false;
    char bytes[64];
    const ssize_t got = ::read(STDIN_FILENO, bytes, sizeof bytes);
    input_over_ = got <= 0;
    return got > 0;
  }

  bool quiet_, input_over_{false};
  Clock::time_point ends_, told_{Clock::now()};
};

void tell_scan(const CaptureScanOptions& options, const capture::TakenScan& scan,
               const calibration::Verdict& verdict, const GlobalOptions& global) {
  const std::optional<intake::Refusal> cause = capture::cause_of(scan);
  if (global.json) {
    nlohmann::ordered_json json{{"part", "scan"},
                                {"grade", calibration::name_of(verdict.grade)},
                                {"reasons", verdict.reasons},
                                {"session", options.order.session.string()},
                                {"profiles", scan.count.profiles},
                                {"points", scan.count.points},
                                {"pictures", scan.facts.pictures},
                                {"complete", scan.facts.complete}};
    if (cause) {
      const report::ToldRefusal told = report::told(*cause);
      json["reason_code"] = told.reason_code;
      json["next_step"] = told.next_step;
    }
    std::printf("%s\n", report::to_text(json).c_str());
    return;
  }
  if (global.quiet) return;
  std::printf("scan: %s\n", calibration::name_of(verdict.grade));
  for (const std::string& reason : verdict.reasons) std::printf("  %s\n", reason.c_str());
  if (cause) std::printf("  next: %s\n", report::told(*cause).next_step.c_str());
  std::printf("%s: %llu profiles, %llu pictures; biteline replay %s --out DIR finds its line\n",
              options.order.session.c_str(), static_cast<unsigned long long>(scan.count.profiles),
              static_cast<unsigned long long>(scan.facts.pictures), options.order.session.c_str());
}

Result<ExitStatus> run(const CaptureScanOptions& options, const GlobalOptions& global) {
  std::signal(SIGPIPE, SIG_IGN);  // a sensor program that died is an error, not our death
  const auto watch = std::make_shared<Watch>(global, options.seconds);
  BITELINE_ASSIGN(const capture::TakenScan scan,
                  capture::capture_scan(
                      options.order, [watch](const capture::ScanCount& count) { return (*watch)(count); }));
  const calibration::Verdict verdict = capture::judge_scan(scan);
  tell_scan(options, scan, verdict, global);
  return verdict.grade == calibration::Grade::Bad ? ExitStatus::Refused : ExitStatus::Done;
}

}  // namespace

void add_capture_scan(options::Command& capture, Context& context) {
  auto options = std::make_shared<CaptureScanOptions>();
  capture::ScanOrder& order = options->order;
  options::Command* command = capture.add_subcommand(
      "scan", "One live scan as a session folder: pictures, poses, profiles, settings; what it is worth");
  command->add_option("SESSION", order.session, "The folder, not there yet")->required();
  command->add_option("--board", order.board, "The unit's board.yaml; its sensor program must be off")
      ->capture_default_str();
  command->add_option("--sensor", order.sensor, "The head's sensor.yaml")->capture_default_str();
  command->add_option(
      "--settings", order.settings,
      "A settings file, or a folder whose start-up.yaml it is; with the head's own when left out");
  command->add_option("--pictures", order.pictures_every, "Every so many pictures one; 1: all, 0: none")
      ->check(options::number({.minimum = 0, .maximum = 1e6}, "pictures"))
      ->capture_default_str();
  command->add_option("--seconds", options->seconds, "The scan ends then at the latest")
      ->check(options::number({.minimum = 1, .maximum = 3600}, "s"))
      ->capture_default_str();
  command->add_option("--rt", order.rt, "As of biteline-sensor: required or ignore")
      ->check(options::one_of({"required", "ignore"}))
      ->capture_default_str();
  command->callback(
      [options, &context] { context.run = [options, &context] { return run(*options, context.options); }; });
}

}  // namespace biteline::app
