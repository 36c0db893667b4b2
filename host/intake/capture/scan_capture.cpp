// SPDX-License-Identifier: MIT
#include "host/intake/capture/scan_capture.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "host/intake/cloud_builder.hpp"
#include "host/intake/live_line.hpp"
#include "host/intake/scan_cause.hpp"
#include "host/intake/sensor_link.hpp"
#include "host/intake/sensor_process.hpp"

namespace biteline::capture {
namespace {

using calibration::Grade;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr Nanoseconds k_turn = std::chrono::milliseconds{100};
constexpr seconds k_start_limit{30};
/// A network camera is opened and told within some hundred ms.
constexpr seconds k_begin_limit{15};
/// What waits for the disk is written before the program ends: up to 130 MB.
constexpr seconds k_write_limit{120};
constexpr std::uint32_t k_start_id = 1, k_stop_id = 2;

/// A tenth of the profiles without stripe: the ends of a scan beside the piece.
constexpr double k_few_lost = 0.1;
constexpr double k_few_unusable = 0.01;
constexpr double k_many_saturated = 0.3;
constexpr std::uint64_t k_least_profiles = 10;

std::vector<std::string> arguments_of(const ScanOrder& order) {
  std::vector<std::string> arguments{"--source",
                                     "board:" + order.board.string(),
                                     "--sensor",
                                     order.sensor.string(),
                                     "--rt",
                                     order.rt,
                                     "--record",
                                     order.session.string(),
                                     "--record-pictures",
                                     std::to_string(order.pictures_every),
                                     "--exit-with-parent"};
  if (!order.settings.empty()) {
    arguments.emplace_back("--settings");
    arguments.push_back(order.settings.string());
  }
  return arguments;
}

/// One scan from its start to its end.
class Taking {
 public:
  Taking(intake::SensorProcess& process, intake::SensorLink& link, const OnTurn& on_turn)
      : process_{process}, link_{link}, on_turn_{on_turn} {}

  Result<TakenScan> run() {
    const Clock::time_point begun = Clock::now();
    while (!ended_) {
      const Result<std::optional<intake::LinkEvent>> event = link_.next(k_turn);
      // A dead sensor explains a broken link, and not the other way round.
      if ((!event || !*event) && !process_.child().running()) return tl::unexpected<Error>{process_.death()};
      if (!event) return tl::unexpected<Error>{event.error()};
      if (*event) BITELINE_TRY(take(**event));
      if (!scanning_ && Clock::now() - begun > k_begin_limit)
        return fail(Errc::Timeout, "the scan did not begin within %d s",
                    static_cast<int>(k_begin_limit.count()));
      if (scanning_ && !stop_said_ && !on_turn_(taken_.count)) {
        link_.command({.id = k_stop_id, .command = wire::Command::StopScan});
        stop_said_ = true;
      }
    }
    if (cloud_)
      taken_.pictures =
          consistency::check_pictures({cloud_->cloud().points, cloud_->cloud().profile, poses_}, head_, {});
    return std::move(taken_);
  }

 private:
  Result<void> take(const intake::LinkEvent& event) {
    if (const auto* hello = std::get_if<intake::Hello>(&event)) {
      scanning_ = hello->sensor.scanning;
      head_ = hello->sensor.model;
      if (!scanning_ && !start_said_) {
        link_.command({.id = k_start_id, .command = wire::Command::StartScan});
        start_said_ = true;
      }
    } else if (const auto* reply = std::get_if<wire::ControlReply>(&event)) {
      if (reply->id == k_start_id && reply->errc != 0)
        return fail(Errc::PeerRefused, "the scan did not begin: %s", reply->where.c_str());
    } else if (const auto* profile = std::get_if<intake::ProfileEvent>(&event)) {
      count(profile->profile);
    } else if (const auto* end = std::get_if<wire::EndOfScan>(&event)) {
      taken_.end = *end;
      ended_ = true;
    }
    return {};
  }

  void count(const profile::Profile& profile) {
    if (!cloud_) cloud_.emplace(head_);
    if (!cloud_->add(profile).empty())
      poses_.push_back({.profile = static_cast<std::uint32_t>(profile.header.sequence),
                        .pose = intake::pose_of(profile.header)});
    ScanCount& count = taken_.count;
    ++count.profiles;
    intake::count_profile(profile, head_.region.width_px, taken_.seen);
    if ((profile.header.flags & profile::k_profile_stripe_lost) != 0) ++count.without_stripe;
    if ((profile.header.flags & profile::k_profile_not_usable) != 0) ++count.not_usable;
    for (const profile::ProfilePoint& point : profile.points) {
      if ((point.flags & profile::k_point_not_surface) != 0) continue;
      ++count.points;
      if ((point.flags & profile::k_point_saturated) != 0) ++count.saturated;
    }
  }

  intake::SensorProcess& process_;
  intake::SensorLink& link_;
  const OnTurn& on_turn_;
  TakenScan taken_;
  geometry::SensorModel head_{};
  std::optional<intake::CloudBuilder> cloud_;
  std::vector<drift::PosedProfile> poses_;
  bool scanning_{false}, start_said_{false}, stop_said_{false}, ended_{false};
};

std::string percent(const char* words, double ratio) {
  char text[120];
  std::snprintf(text, sizeof text, "%.0f %% %s", 100 * ratio, words);
  return text;
}

}  // namespace

Result<TakenScan> capture_scan(const ScanOrder& order, const OnTurn& on_turn) {
  std::error_code error;
  if (std::filesystem::exists(order.session, error))
    return fail(Errc::WrongState, "%s: is there already; name another folder", order.session.c_str());
  BITELINE_ASSIGN(const std::filesystem::path program, intake::find_sensor_program());
  BITELINE_ASSIGN(intake::SensorProcess process,
                  intake::SensorProcess::start(program, arguments_of(order), k_start_limit));
  Result<TakenScan> taken;
  {
    intake::SensorLinkConfig config;
    config.sensor = process.endpoint();
    config.protocol.name = "biteline capture";
    BITELINE_ASSIGN(const std::unique_ptr<intake::SensorLink> link, intake::SensorLink::open(config));
    taken = Taking{process, *link, on_turn}.run();
  }
  // Also after a failure: the laser is dark and the recording whole when it has ended by itself.
  process.child().stop(k_write_limit);
  if (!taken) return taken;
  BITELINE_ASSIGN(taken->facts, session::read_recording_facts(order.session / "recording.yaml"));
  return taken;
}

std::optional<intake::Refusal> cause_of(const TakenScan& scan) {
  return intake::scan_cause(scan.seen, scan.end.counters, &scan.end.devices);
}

calibration::Verdict judge_scan(const TakenScan& scan) {
  calibration::Verdict verdict;
  const auto note = [&](Grade grade, const std::string& reason) {
    verdict.grade = std::max(verdict.grade, grade);
    verdict.reasons.push_back(reason);
  };
  const ScanCount& count = scan.count;
  const session::RecordingFacts& facts = scan.facts;
  if (scan.end.errc != 0) note(Grade::Bad, "the scan was ended: " + scan.end.where);
  if (!facts.fault.empty()) note(Grade::Bad, "the recording was ended: " + facts.fault);
  if (count.profiles < k_least_profiles)
    note(Grade::Bad,
         std::to_string(count.profiles) + " profiles: the arm did not move, or the scan ended at once");
  if (const auto refusal = consistency::refusal_of(scan.pictures))
    note(Grade::Bad, refusal->reason + "; " + report::told(*refusal).next_step);
  const double profiles = std::max(1.0, static_cast<double>(count.profiles));
  const double lost = static_cast<double>(count.without_stripe) / profiles;
  const double unusable = static_cast<double>(count.not_usable) / profiles;
  const double saturated =
      static_cast<double>(count.saturated) / std::max(1.0, static_cast<double>(count.points));
  const std::optional<intake::Refusal> cause = cause_of(scan);
  if (cause) note(Grade::Bad, cause->reason);
  if (!cause && lost > k_few_lost)
    note(lost > intake::k_many_without_stripe_ratio ? Grade::Bad : Grade::Fair,
         percent("of the profiles show no stripe: look at region, exposure and the arm's path", lost));
  if (!cause && unusable > k_few_unusable)
    note(unusable >= intake::k_many_unusable_ratio ? Grade::Bad : Grade::Fair,
         percent("of the profiles have no pose that fits: look at the robot's link and clock", unusable));
  if (saturated > k_many_saturated)
    note(Grade::Fair, percent("of the points are saturated: expose shorter", saturated));
  if (scan.end.counters.frames_lost > 0)
    note(Grade::Fair,
         std::to_string(scan.end.counters.frames_lost) + " pictures were lost by the camera's link");
  if (facts.pictures_left_out > 0)
    note(Grade::Fair,
         std::to_string(facts.pictures_left_out) + " pictures are not kept: the disk is too slow");
  if (facts.unrepeatable > 0)
    note(Grade::Fair,
         std::to_string(facts.unrepeatable) + " profiles come out otherwise in a replay of the pictures");
  if (!facts.complete && verdict.grade == Grade::Good) note(Grade::Fair, "the recording is not complete");
  return verdict;
}

}  // namespace biteline::capture
