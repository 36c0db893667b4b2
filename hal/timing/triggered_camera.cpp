// SPDX-License-Identifier: MIT
#include "hal/timing/triggered_camera.hpp"

#include <cmath>

namespace biteline::hal {

Result<CameraSettings> TriggeredCamera::configure(const CameraSettings& wanted) {
  BITELINE_ASSIGN(settings_, camera_->configure(wanted));
  // A camera that cannot say its exposure has the one that was asked, by the width of the trigger or its own
  // settings.
  if (settings_.exposure == Nanoseconds{0}) settings_.exposure = wanted.exposure;
  if (wanted.rate_hz > 0) settings_.rate_hz = wanted.rate_hz;
  return settings_;
}

Result<void> TriggeredCamera::start() {
  if (on_grid()) {
    const Nanoseconds period{std::llround(1e9 / settings_.rate_hz)};
    // An eighth: what a rolling count could take for the neighbour is four times as far.
    grid_ = EdgeGrid{{.period = period, .tolerance = period / 8}};
  }
  pairing_ = TriggerPairing{config_.pairing};
  publish();
  while (strobe_echo_->next_edge(Nanoseconds{0})) {
    // Edges from before the start belong to no frame.
  }
  return camera_->start();
}

Result<FrameView> TriggeredCamera::next_frame(Nanoseconds timeout) {
  BITELINE_ASSIGN(FrameView frame, camera_->next_frame(timeout));
  take_edges();
  const TriggerPairing::Match match = pairing_.on_frame(frame.exposure_mid);
  if (match.edge) {
    frame.exposure_mid = *match.edge + settings_.exposure / 2;
    frame.flags &= ~std::uint32_t{k_frame_stamp_uncertain};
  } else {
    frame.flags |= k_frame_trigger_mismatch;
  }
  publish();
  return frame;
}

void TriggeredCamera::take_edges() {
  while (true) {
    const Result<Edge> edge = strobe_echo_->next_edge(Nanoseconds{0});
    if (!edge)
      return;  // none waits, or the line cannot be read: then frames come without edges, and are counted
    if (!edge->rising) continue;
    // A second edge in a slot is no exposure: it must not make the first one's pairing ambiguous for a wide
    // window.
    if (!on_grid() || grid_.on_edge(edge->stamp) != EdgeVerdict::Doubled) pairing_.on_edge(edge->stamp);
  }
}

Result<Nanoseconds> TriggeredCamera::adjust_exposure(Nanoseconds exposure) {
  BITELINE_ASSIGN(settings_.exposure, camera_->adjust_exposure(exposure));
  return settings_.exposure;
}

void TriggeredCamera::publish() {
  const EdgeGridHealth& grid = grid_.health();
  const PairingHealth& pairing = pairing_.health();
  const profile::TriggerCounts counts{
      .edges = grid.slots,
      .edges_missed = grid.missed,
      .edges_doubled = grid.doubled,
      .edges_late = grid.late,
      .edges_lost = strobe_echo_->health().edges_lost,
      .frames_paired = pairing.paired,
      .frames_without_edge = pairing.frames_without_edge,
      .frames_with_two_edges = pairing.frames_with_two_edges,
      .edges_without_frame = pairing.edges_without_frame + pairing.edges_overrun};
  published_.rt_store({counts, true});
}

CameraHealth TriggeredCamera::health() const noexcept {
  CameraHealth health = camera_->health();
  health.trigger = published_.rt_load().value_or(TriggerHealth{{}, true});
  return health;
}

}  // namespace biteline::hal
