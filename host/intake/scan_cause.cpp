// SPDX-License-Identifier: MIT
#include "host/intake/scan_cause.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "common/core/fixed_text.hpp"

namespace biteline::intake {
namespace {

/// Why a profile is left out; a profile with several flags counts under each.
struct FlagCause {
  std::uint32_t flag;
  Refused code;
  const char* words;
};
constexpr std::array k_flag_causes{
    FlagCause{profile::k_profile_pose_missing, Refused::NoPoses, "no pose"},
    FlagCause{profile::k_profile_pose_stale, Refused::PosesTooFar, "no pose near enough to the exposure"},
    FlagCause{profile::k_profile_clock_unsure, Refused::ClockUnsure, "the camera's clock is not sure"},
    FlagCause{profile::k_profile_trigger_mismatch, Refused::TriggerMismatch, "no trigger edge of its own"},
    FlagCause{profile::k_profile_frame_damaged, Refused::FramesDamaged, "the picture is damaged"}};

unsigned long long printed(std::uint64_t count) {
  return count;
}

std::uint64_t with_flag(const IngestCounts& counts, std::uint32_t flag) {
  return counts.profiles_by_flag[static_cast<std::size_t>(__builtin_ctz(flag))];
}

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// Those that keep profiles out, the most frequent first.
std::vector<FlagCause> flag_causes(const IngestCounts& counts) {
  std::vector<FlagCause> causes;
  for (const FlagCause& cause : k_flag_causes)
    if (with_flag(counts, cause.flag) > 0) causes.push_back(cause);
  std::ranges::stable_sort(causes, std::greater{},
                           [&](const FlagCause& cause) { return with_flag(counts, cause.flag); });
  return causes;
}

/// What never became a profile, or came too late to be one.
std::optional<Refusal> lost_cause(const IngestCounts& counts, const wire::Counters& sensor,
                                  const wire::Devices* devices) {
  const std::uint64_t late =
      std::max(sensor.overruns,
               counts.profiles_by_flag[static_cast<std::size_t>(__builtin_ctz(profile::k_profile_overrun))]);
  const std::uint64_t without_buffer = devices == nullptr ? 0 : devices->camera_underruns;
  const std::uint64_t dropped = sensor.profiles_dropped + sensor.messages_lost;
  // A gap in the numbers that the sensor does not explain: lost behind it.
  const std::uint64_t lost_behind = counts.profiles_lost - std::min(counts.profiles_lost, dropped);
  const std::uint64_t lost = sensor.frames_lost + dropped + lost_behind;
  const std::uint64_t all = counts.profiles + lost;
  if (ratio(lost, all) < k_many_unusable_ratio) return std::nullopt;
  // What was on this machine or the sensor and had to go shows that they had no time; a picture that never
  // came may have been lost on its cable.
  const bool busy = dropped + lost_behind + without_buffer > 0 || ratio(late, all) >= k_many_unusable_ratio;
  return Refusal{
      .code = busy ? Refused::NoTime : Refused::FramesLost,
      .reason = FixedText<240>::format(
                    busy ? "sensor or host had no time: of %llu pictures %llu were lost (%llu before they "
                           "became profiles, %llu after), and %llu came late"
                         : "of %llu pictures %llu were lost on the way from the camera (%llu before they "
                           "became profiles, %llu after), and %llu came late",
                    printed(all), printed(lost), printed(sensor.frames_lost), printed(dropped + lost_behind),
                    printed(late))
                    .c_str()};
}

std::optional<Refusal> stripe_cause(const IngestCounts& counts) {
  const std::uint64_t without = with_flag(counts, profile::k_profile_stripe_lost);
  const double dark_ratio = 1 - ratio(counts.columns_with_stripe, counts.columns);
  const std::uint64_t with = counts.profiles - std::min(without, counts.profiles);
  // Along the columns only few columns meet it, so that such profiles may count as without stripe, too.
  if (ratio(counts.profiles_along_columns, counts.profiles) > k_many_without_stripe_ratio &&
      dark_ratio > k_many_without_stripe_ratio) {
    return Refusal{
        .code = Refused::StripeAlongColumns,
        .reason = FixedText<240>::format("columns without a stripe: %.0f %%; does the stripe run "
                                         "along the columns? (so it does in %llu of %llu profiles)",
                                         100 * dark_ratio, printed(counts.profiles_along_columns),
                                         printed(counts.profiles))
                      .c_str()};
  }
  if (ratio(without, counts.profiles) <= k_many_without_stripe_ratio) return std::nullopt;
  const std::uint64_t saturated =
      counts.points_by_flag[static_cast<std::size_t>(__builtin_ctz(profile::k_point_saturated))];
  return Refusal{.code = Refused::NoStripe,
                 .reason = FixedText<240>::format(
                               "only %llu of %llu profiles show a stripe (columns without: %.0f %%; points "
                               "that are saturated: %.0f %%)",
                               printed(with), printed(counts.profiles), 100 * dark_ratio,
                               100 * ratio(saturated, counts.points))
                               .c_str()};
}

}  // namespace

std::string usable_words(const IngestCounts& counts, const wire::Counters& sensor) {
  std::string words{FixedText<120>::format("%llu of %llu profiles can be used", printed(counts.profiles_used),
                                           printed(counts.profiles))
                        .view()};
  const char* before = ": ";
  for (const FlagCause& cause : flag_causes(counts)) {
    words +=
        FixedText<120>::format("%s%s (%llu)", before, cause.words, printed(with_flag(counts, cause.flag)))
            .view();
    before = ", ";
  }
  if (sensor.profiles > 0 && with_flag(counts, profile::k_profile_pose_stale) > 0) {
    words += FixedText<120>::format("; %llu poses came, the nearest up to %.0f ms away",
                                    printed(sensor.poses), 1e3 * counts.pose_age_max_s)
                 .view();
  }
  return words;
}

std::optional<Refusal> scan_cause(const IngestCounts& counts, const wire::Counters& sensor,
                                  const wire::Devices* devices) {
  if (const std::optional<Refusal> lost = lost_cause(counts, sensor, devices)) return lost;
  const std::uint64_t unusable = counts.profiles - counts.profiles_used;
  if (ratio(unusable, counts.profiles) >= k_many_unusable_ratio) {
    const std::vector<FlagCause> causes = flag_causes(counts);
    if (!causes.empty()) return Refusal{.code = causes.front().code, .reason = usable_words(counts, sensor)};
  }
  return stripe_cause(counts);
}

}  // namespace biteline::intake
