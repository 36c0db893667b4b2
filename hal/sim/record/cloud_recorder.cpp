// SPDX-License-Identifier: MIT
#include "hal/sim/record/cloud_recorder.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>

#include "hal/sim/record/files.hpp"

namespace biteline::sim {
namespace {

constexpr std::size_t k_most_rows = std::numeric_limits<std::uint16_t>::max();

/// Binary, 16 bytes for each point.  Pre: at most 65535 profiles.
Result<void> write_cloud_ply(const std::filesystem::path& file, const ScannedCloud& cloud,
                             std::string_view shoe) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(file.c_str(), "wb"), &std::fclose);
  if (!out) return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  std::fprintf(out.get(),
               "ply\nformat binary_little_endian 1.0\ncomment simulated scan of a made shoe, %.*s\n"
               "element vertex %zu\nproperty float x\nproperty float y\nproperty float z\n"
               "property ushort profile\nproperty ushort column\nend_header\n",
               static_cast<int>(shoe.size()), shoe.data(), cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto profile = static_cast<std::uint16_t>(cloud.profile[i]);
    std::array<char, 16> row;
    std::memcpy(row.data(), cloud.points[i].data(), 12);
    std::memcpy(row.data() + 12, &profile, 2);
    std::memcpy(row.data() + 14, &cloud.column[i], 2);
    std::fwrite(row.data(), 1, row.size(), out.get());
  }
  if (std::fflush(out.get()) != 0 || std::ferror(out.get()) != 0)
    return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  return {};
}

}  // namespace

Result<void> record_cloud(const std::filesystem::path& folder, const SceneSettings& scene,
                          const ScanSettings& scan) {
  const PlacedShoe placed = place_shoe(scene);
  if (placed.shoe.perimeter_mm() / scan.profile_step_mm > static_cast<double>(k_most_rows))
    return fail(Errc::InvalidArgument, "profiles %.4f mm apart are too many for one cloud: at most %zu",
                scan.profile_step_mm, k_most_rows);
  BITELINE_TRY(write_line_truth(folder / "truth", placed));
  return write_cloud_ply(folder / "cloud.ply", scan_quickly(placed.shoe, scan, placed.T_base_shoe),
                         name_of(scene.shoe.shoe_class));
}

}  // namespace biteline::sim
