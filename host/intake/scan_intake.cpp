// SPDX-License-Identifier: MIT
#include "host/intake/scan_intake.hpp"

#include <algorithm>
#include <utility>

#include "host/intake/live_line.hpp"

namespace biteline::intake {
namespace {

namespace fs = std::filesystem;

Error error_of(const wire::EndOfScan& end) {
  const auto rows = error_table();
  const bool known = std::any_of(rows.begin(), rows.end(), [&](const ErrorRow& row) {
    return static_cast<std::uint16_t>(row.code) == end.errc;
  });
  return fail(known ? static_cast<Errc>(end.errc) : Errc::ProtocolError, "%s", end.where.c_str()).value();
}

void keep_pose(const profile::ProfileHeader& header, std::vector<TakenFrom>& poses) {
  if ((header.flags & profile::k_profile_not_usable) != 0) return;
  const auto number = static_cast<std::uint32_t>(header.sequence);
  if (poses.empty() || number > poses.back().profile)
    poses.push_back({.profile = number, .pose = pose_of(header)});
}

}  // namespace

Result<ScanIntake> ScanIntake::begin(const fs::path& folder, const Hello& hello,
                                     std::span<const std::uint8_t> hello_packet) {
  BITELINE_ASSIGN(ScanJournal journal, ScanJournal::create(folder / k_messages_name));
  BITELINE_TRY(journal.append(hello_packet));
  return ScanIntake{std::move(journal), hello.sensor, {.scan_id = hello.scan_id, .next_sequence = 0}};
}

Result<ScanIntake> ScanIntake::recover(const fs::path& folder) {
  // The hello comes first and makes the intake; the journal follows once it is read.
  struct Kept {
    std::optional<wire::SensorHello> sensor;
    std::optional<CloudBuilder> builder;
    std::vector<TakenFrom> poses;
    ScanGaps gaps;
    std::optional<wire::EndOfScan> end;
    std::uint64_t lost{0};
    std::uint64_t next{0};
  } kept;
  const auto on_message = [&](wire::Message message) {
    if (auto* hello = std::get_if<wire::SensorHello>(&message.body)) {
      if (!kept.sensor) {
        kept.builder.emplace(hello->model);
        kept.gaps = ScanGaps{hello->model.rate_hz.value_or(0)};
      }
      kept.sensor = std::move(*hello);
    } else if (const auto* profile = std::get_if<profile::Profile>(&message.body)) {
      kept.builder->add(*profile);
      keep_pose(profile->header, kept.poses);
      kept.gaps.add(profile->header);
      kept.next = message.sequence + 1;
    } else if (const auto* gap = std::get_if<wire::Gap>(&message.body)) {
      const std::uint64_t end = gap->first + gap->count;
      if (end > kept.next) kept.lost += end - kept.next;
      kept.next = std::max(kept.next, end);
    } else if (auto* end = std::get_if<wire::EndOfScan>(&message.body)) {
      kept.end = std::move(*end);
    }
  };
  BITELINE_ASSIGN(ScanJournal::Recovered recovered,
                  ScanJournal::recover(folder / k_messages_name, on_message));
  ScanIntake intake{std::move(recovered.journal), std::move(*kept.sensor), recovered.position};
  intake.builder_ = std::move(*kept.builder);
  intake.poses_ = std::move(kept.poses);
  intake.gaps_ = std::move(kept.gaps);
  intake.messages_lost_ = kept.lost;
  if (kept.end) intake.account(*kept.end);
  return intake;
}

bool ScanIntake::is_in(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / k_messages_name, error);
}

Result<void> ScanIntake::take(const LinkEvent& event, std::span<const std::uint8_t> packet) {
  if (const auto* profile = std::get_if<ProfileEvent>(&event)) {
    BITELINE_TRY(journal_.append(packet));
    builder_.add(profile->profile);
    keep_pose(profile->profile.header, poses_);
    gaps_.add(profile->profile.header);
    position_.next_sequence = profile->sequence + 1;
  } else if (const auto* loss = std::get_if<LossEvent>(&event)) {
    BITELINE_TRY(journal_.append(packet));
    messages_lost_ += loss->messages;
    position_.next_sequence += loss->messages;
  } else if (const auto* end = std::get_if<wire::EndOfScan>(&event)) {
    BITELINE_TRY(journal_.append(packet));
    ++position_.next_sequence;
    account(*end);
  } else if (const auto* health = std::get_if<wire::Health>(&event)) {
    light_.add(*health);
    light_told_ = ended_;
  }
  return {};
}

void ScanIntake::account(const wire::EndOfScan& end) {
  ended_ = true;
  end_ = end;
}

ScanOutcome ScanIntake::finish() {
  ScanOutcome outcome;
  outcome.counts = builder_.counts();
  outcome.cloud = builder_.take();
  outcome.poses = poses_;
  outcome.sensor = sensor_;
  outcome.sensor_counters = end_.counters;
  outcome.sensor_stages = end_.stages;
  outcome.sensor_devices = end_.devices;
  outcome.messages_lost = messages_lost_;
  if (sensor_.test_pattern) {
    outcome.failure = fail(Errc::WrongState, "the sensor shows its test pattern, and no shoe").value();
  } else if (const auto state = geometry::expect_state(sensor_.model.camera_state, sensor_.camera_state);
             !state) {
    outcome.failure = state.error();
  } else if (!ended_) {
    outcome.failure = fail(Errc::ConnectionLost, "the sensor no longer has the scan's end").value();
  } else if (end_.errc != 0) {
    outcome.failure = error_of(end_);
  } else if (const auto why = contradiction(end_, sensor_, outcome.counts, messages_lost_, light_)) {
    outcome.failure = fail(Errc::Truncated, "%.200s", why->c_str()).value();
  }
  outcome.lost = gaps_.longest();
  return outcome;
}

void ScanIntake::forget() {
  std::error_code ignored;  // a file that stays is found again and finished again: harmless
  fs::remove(journal_.file(), ignored);
}

}  // namespace biteline::intake
