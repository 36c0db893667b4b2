// SPDX-License-Identifier: MIT
#include "hal/sim/record/made_scene.hpp"

#include <cerrno>
#include <cmath>
#include <cstdio>

#include "hal/sim/record/files.hpp"
#include "hal/sim/record/surroundings.hpp"

namespace biteline::sim {

namespace {

/// On the arm the wrist turns over so much of the way round at once.  The beam then leaves the outline's
/// normal by up to 26 degrees, and the scan takes half the time: the wrist's last joint is what limits it.
constexpr double k_turn_ratio = 0.6;

/// A film's edges are as fine as the line: so far from it, at least.
constexpr double k_worked_band_mm = 16;

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

Result<void> write_line(const std::filesystem::path& path, const PlacedShoe& placed) {
  BITELINE_ASSIGN(File file, create(path));
  std::fprintf(file.get(), "#x [mm],y [mm],z [mm]\n");
  for (const auto& place : placed.line) {
    const Vec3 p = placed.T_base_shoe * place.point_shoe;
    std::fprintf(file.get(), "%.4f,%.4f,%.4f\n", p.x(), p.y(), p.z());
  }
  return close(std::move(file), path);
}

Result<void> write_band(const std::filesystem::path& path, const PlacedShoe& placed) {
  const WorkedBand& band = *placed.shoe.parameters().worked;
  BITELINE_ASSIGN(File file, create(path));
  std::fprintf(file.get(),
               "#low_x [mm],low_y [mm],low_z [mm],high_x [mm],high_y [mm],high_z [mm],layers []\n");
  for (const TrueLinePoint& place : placed.line) {
    const Section section = placed.shoe.section(place.s_mm);
    const BandHere here = band_at(band, place.s_mm);
    const Vec3 low = placed.T_base_shoe * section.point(here.edges.low_z_mm),
               high = placed.T_base_shoe * section.point(here.edges.high_z_mm);
    std::fprintf(file.get(), "%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.2f\n", low.x(), low.y(), low.z(), high.x(),
                 high.y(), high.z(), here.layers);
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

PlaceRange places_within_reach_of(std::string_view arm) {
  constexpr double k_degree = std::numbers::pi / 180;
  if (arm == "ur10e")
    return {
        .x_mm = {600, 670}, .y_mm = {-40, 40}, .z_mm = {90, 150}, .yaw_rad = {70 * k_degree, 110 * k_degree}};
  return {.x_mm = {435, 470}, .y_mm = {-20, 20}, .z_mm = {20, 40}, .yaw_rad = {82 * k_degree, 98 * k_degree}};
}

SE3 draw_place(std::uint64_t seed, const PlaceRange& range, double shoe_length_mm) {
  Random random(seed ^ 0x504C414345ULL);
  const double yaw_rad = random.uniform(range.yaw_rad);
  const Vec3 middle_base{random.uniform(range.x_mm), random.uniform(range.y_mm), random.uniform(range.z_mm)};
  const SE3 T_base_middle =
      geometry::make_se3(Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ())), middle_base);
  return T_base_middle * Eigen::Translation3d(-shoe_length_mm / 2, 0, 0);
}

PlacedShoe place_shoe(const SceneSettings& settings) {
  MadeShoe shoe(settings.shoe);
  auto line = true_line(shoe, k_true_line_spacing_mm);
  if (settings.shoe.bare && settings.shoe.shoe_class != ShoeClass::Bare) {
    // An upper of a known sample: its line is the sample's.
    ShoeParameters sample = settings.shoe;
    sample.bare = false;
    sample.last_difference_mm = 0;
    line = carried_line(true_line(MadeShoe(sample), k_true_line_spacing_mm), shoe);
  }
  if (settings.work && !line.empty()) {
    ShoeParameters worked = settings.shoe;
    worked.worked =
        lay_band(shoe, line, settings.work->plan, draw_film(settings.work->work, settings.work->film_seed));
    shoe = MadeShoe(std::move(worked));
  }
  return {.shoe = std::move(shoe),
          .T_base_shoe = draw_place(settings.place_seed, settings.places, settings.shoe.outline.length_mm),
          .line = std::move(line)};
}

SceneMeshes meshes_of(const MadeShoe& shoe, const SceneSettings& settings) {
  MeshFineness fineness = settings.fineness;
  if (settings.work || settings.will_be_worked)
    fineness.fine_band_mm = std::max(fineness.fine_band_mm, k_worked_band_mm);
  SceneMeshes meshes{.shoe = mesh_of(shoe, fineness), .all = {}};
  meshes.all = meshes.shoe;
  if (settings.surroundings) add_surroundings(meshes.all, shoe.outline());
  return meshes;
}

Result<std::unique_ptr<MadeScene>> make_scene(const SceneSettings& settings) {
  PlacedShoe placed = place_shoe(settings);
  MadeHead head = draw_head(settings.head_seed, settings.holder);
  head.model.rate_hz = settings.rate_hz;
  head.faults.ambient_grey = settings.ambient_grey;
  set_light(head, settings.light);
  SceneMeshes meshes = meshes_of(placed.shoe, settings);
  BITELINE_ASSIGN(Scene scene, Scene::build(meshes.all));
  const ScanPathSettings path{.target_z_mm = 0.55 * settings.shoe.upper.top_z_mm,
                              .speed_mm_s = settings.scan_speed_mm_s,
                              .turn_over_mm = settings.holder == Holder::Bracket
                                                  ? k_turn_ratio * placed.shoe.outline().perimeter_mm()
                                                  : 0,
                              .begin_mm = settings.scan_begin_ratio * placed.shoe.outline().perimeter_mm(),
                              .check = settings.check};
  ScanPath scan_path(placed.shoe.outline(), head, path);
  return std::make_unique<MadeScene>(MadeScene{std::move(placed), settings, head, std::move(meshes.shoe),
                                               std::move(scene), std::move(scan_path)});
}

Result<void> write_line_truth(const std::filesystem::path& folder, const PlacedShoe& placed) {
  BITELINE_TRY(make_folder(folder));
  if (!placed.line.empty()) BITELINE_TRY(write_line(folder / "groove.csv", placed));
  if (placed.shoe.parameters().worked) BITELINE_TRY(write_band(folder / "worked.csv", placed));
  return write_matrix(folder / "T_base_shoe.txt", placed.T_base_shoe);
}

Result<void> write_truth(const std::filesystem::path& folder, const MadeScene& scene,
                         const std::optional<OutlinePart>& part) {
  BITELINE_TRY(write_line_truth(folder, scene));
  const std::filesystem::path file = folder / "reference.ply";
  if (!part) return write_mesh_ply(file, scene.mesh, scene.T_base_shoe);
  return write_mesh_ply(file, mesh_of_part(scene.shoe, *part, scene.settings.fineness), scene.T_base_shoe);
}

}  // namespace biteline::sim
