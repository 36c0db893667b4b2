// SPDX-License-Identifier: MIT
#include "tests/support/picture_cell/scan_account.hpp"

#include <algorithm>

#include "tests/support/same_bits.hpp"

namespace biteline::test {

void ScanAccount::clear() {
  profiles = usable = wrong = disordered = frames_missing = lost = 0;
  flagged.clear();
  pose_off_max_mm = 0;
  last_profile.reset();
  last_frame.reset();
  health = {};
  end.reset();
}

void ScanAccount::take(const intake::LinkEvent& event) {
  if (const auto* profile = std::get_if<intake::ProfileEvent>(&event)) take_profile(profile->profile);
  if (const auto* loss = std::get_if<intake::LossEvent>(&event)) lost += loss->messages;
  if (const auto* over = std::get_if<wire::EndOfScan>(&event)) end = *over;
  if (const auto* newest = std::get_if<wire::Health>(&event)) {
    health = *newest;
    ++healths;
  }
}

void ScanAccount::take_profile(const profile::Profile& profile) {
  const profile::ProfileHeader& header = profile.header;
  ++profiles;
  const bool rises = (!last_profile || header.sequence > *last_profile) &&
                     (!last_frame || header.frame_sequence > *last_frame);
  disordered += rises ? 0 : 1;
  if (rises && last_frame) frames_missing += header.frame_sequence - *last_frame - 1;
  last_profile = header.sequence;
  last_frame = header.frame_sequence;
  for (std::uint32_t bit = 1; bit <= profile::k_profile_frame_damaged; bit <<= 1U) {
    if ((header.flags & bit) != 0) ++flagged[bit];
  }
  if ((header.flags & profile::k_profile_frame_damaged) == 0) {
    const std::optional<std::size_t> picture = cell_->picture_of(profile.points);
    const bool right = picture && std::equal(expected_[*picture].begin(), expected_[*picture].end(),
                                             profile.points.begin(), profile.points.end(), same_bits);
    wrong += right ? 0 : 1;
  }
  if ((header.flags & profile::k_profile_not_usable) != 0) return;
  ++usable;
  const SE3 error =
      cell_->T_base_flange_at(header.exposure_mid).inverse(Eigen::Isometry) * header.T_base_flange;
  pose_off_max_mm = std::max(pose_off_max_mm, error.translation().norm());
}

}  // namespace biteline::test
