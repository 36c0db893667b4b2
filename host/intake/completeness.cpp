// SPDX-License-Identifier: MIT
#include "host/intake/completeness.hpp"

#include <algorithm>

#include "common/core/fixed_text.hpp"

namespace biteline::intake {
namespace {

// At a scan's end some edges are on their way to frames that nobody takes any more: half a second at 100 a
// second, and never more than a twentieth of the scan.
constexpr std::uint64_t k_edges_under_way = 50;
constexpr std::uint64_t k_edges_share = 20;

unsigned long long shown(std::uint64_t count) {
  return count;
}

template <class... Values>
std::string text(const char* pattern, Values... values) {
  return std::string{FixedText<200>::format(pattern, values...).view()};
}

}  // namespace

void LightAccount::add(const wire::Health& health) {
  // What the light did before it first shone belongs to the scan before.
  if (health.laser == wire::LaserState::On) shone_ = true;
  if (shone_ && !fault_ && health.laser == wire::LaserState::Fault) fault_ = health.laser_reason;
}

std::optional<std::string> contradiction(const wire::EndOfScan& end, const wire::SensorHello& hello,
                                         const IngestCounts& counts, std::uint64_t messages_lost,
                                         const LightAccount& light) {
  if (light.fault()) return "the light failed: " + *light.fault();
  const wire::Counters& sensor = end.counters;
  if (hello.frames_expected > sensor.frames + sensor.frames_lost) {
    return text("only %llu of %llu frames were taken", shown(sensor.frames), shown(hello.frames_expected));
  }
  // Lost ones are counted: they are for whoever decides whether that matters.
  const std::uint64_t accounted = counts.profiles + messages_lost + sensor.profiles_dropped;
  if (accounted < sensor.profiles) {
    return text("%llu of %llu profiles are unaccounted for", shown(sensor.profiles - accounted),
                shown(sensor.profiles));
  }
  if (const std::optional<wire::TriggerState>& trigger = end.devices.trigger) {
    const std::uint64_t paired =
        trigger->frames_paired + trigger->edges_without_frame + 2 * trigger->frames_with_two_edges;
    const std::uint64_t allowed = std::min(k_edges_under_way, trigger->edges / k_edges_share + 2);
    if (trigger->edges > paired + allowed) {
      return text("of %llu edges %llu gave neither a frame nor the account of a lost one",
                  shown(trigger->edges), shown(trigger->edges - paired));
    }
  }
  return std::nullopt;
}

}  // namespace biteline::intake
