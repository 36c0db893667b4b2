// SPDX-License-Identifier: MIT
#include "hal/sim/record/made_scene.hpp"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "hal/sim/record/files.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Result<void> close(File file, const std::filesystem::path& path) {
  if (std::ferror(file.get()) != 0 || std::fclose(file.release()) != 0) {
    return fail_errno(Errc::WriteFailed, errno, "%s", path.c_str());
  }
  return {};
}

Result<File> create(const std::filesystem::path& path) {
  File file(std::fopen(path.c_str(), "wb"), &std::fclose);
  if (!file) return fail_errno(Errc::WriteFailed, errno, "%s", path.c_str());
  return file;
}

Result<void> write_line(const std::filesystem::path& path, const MadeScene& scene) {
  BITELINE_ASSIGN(File file, create(path));
  std::fprintf(file.get(), "#x [mm],y [mm],z [mm]\n");
  for (const auto& place : scene.line) {
    const Vec3 p = scene.T_base_shoe * place.point_shoe;
    std::fprintf(file.get(), "%.4f,%.4f,%.4f\n", p.x(), p.y(), p.z());
  }
  return close(std::move(file), path);
}

Result<void> write_matrix(const std::filesystem::path& path, const SE3& T) {
  BITELINE_ASSIGN(File file, create(path));
  for (int row = 0; row < 4; ++row) {
    const auto& m = T.matrix();
    std::fprintf(file.get(), "%.9f %.9f %.9f %.9f\n", m(row, 0), m(row, 1), m(row, 2), m(row, 3));
  }
  return close(std::move(file), path);
}

}  // namespace

SE3 draw_place(std::uint64_t seed) {
  Random random(seed ^ 0x504C414345ULL);
  const double yaw_rad = random.uniform({-std::numbers::pi, std::numbers::pi});
  const SE3 T_base_middle = geometry::make_se3(Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ())),
                                               {random.uniform({450, 550}), random.uniform({-100, 100}), random.uniform({20, 60})});
  // The middle of a common shoe stands there, whatever its yaw.
  return T_base_middle * Eigen::Translation3d(-140, 0, 0);
}

Result<std::unique_ptr<MadeScene>> make_scene(const SceneSettings& settings) {
  MadeShoe shoe(settings.shoe);
  MadeHead head = draw_head(settings.head_seed);
  head.model.rate_hz = settings.rate_hz;
  SurfaceMesh mesh = mesh_of(shoe, settings.fineness);
  BITELINE_ASSIGN(Scene scene, Scene::build(mesh));
  const ScanPathSettings path{.target_z_mm = 0.55 * settings.shoe.upper.top_z_mm, .speed_mm_s = settings.scan_speed_mm_s};
  ScanPath scan_path(shoe.outline(), head, path);
  auto line = true_line(shoe, k_true_line_spacing_mm);
  if (settings.shoe.bare && settings.shoe.shoe_class != ShoeClass::Bare) {
    // An upper of a known sample: its line is the sample's.
    ShoeParameters sample = settings.shoe;
    sample.bare = false;
    sample.last_difference_mm = 0;
    line = carried_line(true_line(MadeShoe(sample), k_true_line_spacing_mm), shoe);
  }
  return std::make_unique<MadeScene>(MadeScene{.settings = settings,
                                               .shoe = std::move(shoe),
                                               .T_base_shoe = draw_place(settings.place_seed),
                                               .head = head,
                                               .mesh = std::move(mesh),
                                               .scene = std::move(scene),
                                               .path = std::move(scan_path),
                                               .line = std::move(line)});
}

Result<void> write_truth(const std::filesystem::path& folder, const MadeScene& scene) {
  BITELINE_TRY(make_folder(folder));
  if (!scene.line.empty()) BITELINE_TRY(write_line(folder / "groove.csv", scene));
  BITELINE_TRY(write_matrix(folder / "T_base_shoe.txt", scene.T_base_shoe));
  return write_mesh_ply(folder / "reference.ply", scene.mesh, scene.T_base_shoe);
}

}  // namespace biteline::sim
