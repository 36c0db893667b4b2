// SPDX-License-Identifier: MIT
#include "hal/sim/live/cell_track.hpp"

#include <cerrno>
#include <cstdio>

namespace biteline::sim {

namespace {

/// The track is for one cell's life; a row each 2 ms for an hour.
constexpr std::size_t k_most_rows = 1'800'000;

constexpr const char* k_head =
    "#timestamp [ns],p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z [],script [],outputs [],"
    "scan_active [],time_ratio []\n";

}  // namespace

void CellTrack::add(const TrackRow& row) {
  const std::lock_guard lock(mutex_);
  if (rows_.size() < k_most_rows) rows_.push_back(row);
}

Result<void> CellTrack::write(const std::filesystem::path& file) const {
  const std::lock_guard lock(mutex_);
  std::FILE* out = std::fopen(file.c_str(), "wb");
  if (out == nullptr) return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  std::fputs(k_head, out);
  for (const TrackRow& row : rows_) {
    const Vec3 p = row.T_base_tcp.translation();
    const Eigen::Quaterniond q(row.T_base_tcp.linear());
    std::fprintf(out, "%lld,%.5f,%.5f,%.5f,%.9f,%.9f,%.9f,%.9f,%d,%u,%d,%.4g\n",
                 static_cast<long long>(row.stamp.count()), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(),
                 row.program ? 1 : 0, row.outputs, row.scans ? 1 : 0, row.time_ratio);
  }
  const bool failed = std::ferror(out) != 0;
  if (std::fclose(out) != 0 || failed) return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  return {};
}

}  // namespace biteline::sim
