// SPDX-License-Identifier: MIT
#include "hal/sim/record/cloud_recorder.hpp"

#include <CppUTest/TestHarness.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "hal/sim/shoe/surface_distance.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::sim {

TEST_GROUP(CloudRecorder) {
  test::TemporaryFolder folder;
  SceneSettings scene{.shoe = draw_shoe(ShoeClass::Deep, 4), .place_seed = 9};

  [[nodiscard]] std::string cloud() const {
    std::ifstream in(folder.path() / "cloud.ply", std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST(CloudRecorder, EveryPointLiesOnTheShoeInItsPlaceAndTheRowsAreWhole) {
  SUCCEEDS(record_cloud(folder.path(), scene, {.profile_step_mm = 5, .column_step_mm = 1, .noise_mm = 0}));
  const std::string bytes = cloud();
  const std::string ending = "end_header\n";
  const std::size_t body = bytes.find(ending) + ending.size();
  constexpr std::size_t k_row = 16;
  LONGS_EQUAL(0, (bytes.size() - body) % k_row);
  CHECK(bytes.find("element vertex " + std::to_string((bytes.size() - body) / k_row) + "\n") < body);
  CHECK(bytes.find("simulated") < body);

  const PlacedShoe placed = place_shoe(scene);
  const SurfaceDistance distance(placed.shoe);
  const SE3 T_shoe_base = placed.T_base_shoe.inverse();
  std::uint16_t last_profile = 0;
  for (std::size_t at = body; at < bytes.size(); at += k_row) {
    Eigen::Vector3f point;
    std::uint16_t profile = 0;
    std::memcpy(point.data(), bytes.data() + at, 12);
    std::memcpy(&profile, bytes.data() + at + 12, 2);
    CHECK(profile == last_profile || profile == last_profile + 1);
    last_profile = profile;
    // A float at 600 mm is good to 3e-5 mm.
    DOUBLES_EQUAL(0, distance.signed_distance_mm(T_shoe_base * point.cast<double>()), 1e-3);
  }
}

TEST(CloudRecorder, TruthIsThatOfTheShoeAndAnUpperHasItsSamplesLine) {
  SUCCEEDS(record_cloud(folder.path() / "sample", scene, {.profile_step_mm = 5, .column_step_mm = 1}));
  scene.shoe = bare_upper_of(scene.shoe, 0.15, 3);
  SUCCEEDS(record_cloud(folder.path() / "upper", scene, {.profile_step_mm = 5, .column_step_mm = 1}));
  scene.shoe = draw_shoe(ShoeClass::Bare, 4);
  SUCCEEDS(record_cloud(folder.path() / "bare", scene, {.profile_step_mm = 5, .column_step_mm = 1}));
  CHECK(std::filesystem::exists(folder.path() / "sample/truth/groove.csv"));
  CHECK(std::filesystem::exists(folder.path() / "upper/truth/groove.csv"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "bare/truth/groove.csv"));
}

TEST(CloudRecorder, MoreProfilesThanAFileHoldsAreRefused) {
  FAILS_NAMING(Errc::InvalidArgument, "too many",
               record_cloud(folder.path(), scene, {.profile_step_mm = 0.005}));
}

}  // namespace biteline::sim
