// SPDX-License-Identifier: MIT
#include "host/calibration/head/folder.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>

#include "host/calibration/head/pose_file.hpp"
#include "host/calibration/rings/mosaic.hpp"
#include "host/calibration/rings/picture.hpp"

namespace biteline::calibration {

namespace fs = std::filesystem;

namespace {

struct GridPicture {
  std::string name;
  PictureSize size;
  bool mosaic{false};
  std::vector<GridView> grids;
  std::optional<Error> error;
};

std::vector<GridPicture> search_pictures(const std::vector<NumberedPicture>& pictures,
                                         const RingTarget& target) {
  std::vector<GridPicture> found(pictures.size());
  tbb::parallel_for(std::size_t{0}, pictures.size(), [&](std::size_t i) {
    const fs::path& file = pictures[i].file;
    found[i].name = (file.parent_path().filename() / file.filename()).string();
    const Result<image::GreyImage> picture = read_picture(file);
    if (!picture) {
      found[i].error = picture.error();
      return;
    }
    found[i].size = {.width_px = picture->width_px, .height_px = picture->height_px};
    found[i].mosaic = is_mosaic(*picture);
    // A mosaic has edges at every pixel: what would be found in it is not the target's.
    if (!found[i].mosaic) found[i].grids = find_grids(*picture, target, target.planes);
  });
  return found;
}

Result<void> first_error(const std::vector<GridPicture>& pictures) {
  Error first;
  int faults = 0;
  for (const GridPicture& picture : pictures) {
    if (picture.error && faults++ == 0) first = *picture.error;
  }
  if (faults == 0) return {};
  first.more_faults = faults - 1;
  return tl::unexpected<Error>(first);
}

/// The size that most pictures have.
PictureSize common_size(const std::vector<GridPicture>& pictures) {
  std::map<std::pair<int, int>, int> counts;
  for (const GridPicture& picture : pictures) ++counts[{picture.size.width_px, picture.size.height_px}];
  const auto most = std::max_element(counts.begin(), counts.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return {.width_px = most->first.first, .height_px = most->first.second};
}

std::string words_of(PictureSize size) {
  return std::to_string(size.width_px) + " x " + std::to_string(size.height_px);
}

/// Why a picture cannot be used at all; nothing when it can.
std::optional<SetAside> fault_of(const GridPicture& picture, PictureSize size, const RingTarget& target) {
  if (picture.size.width_px != size.width_px || picture.size.height_px != size.height_px) {
    return SetAside{.name = picture.name,
                    .reason = words_of(picture.size) + " px where the others have " + words_of(size) +
                              " (another camera?)",
                    .fault = PictureFault::Size};
  }
  if (picture.mosaic)
    return SetAside{.name = picture.name, .reason = k_mosaic_words, .fault = PictureFault::Mosaic};
  if (!picture.grids.empty()) return std::nullopt;
  return SetAside{
      .name = picture.name,
      .reason = target.chessboard()
                    ? "no chessboard as target.yaml says found (square_rows and square_cols count "
                      "squares, first_square is the upper left one)"
                    : "no ring grid of target.yaml's shape found"};
}

}  // namespace

Result<CameraFolder> read_camera_folder(const fs::path& calib) {
  CameraFolder folder;
  BITELINE_ASSIGN(folder.target, read_target(calib / "target.yaml"));
  BITELINE_ASSIGN(const auto files, numbered_pictures(calib / "camera", ".png"));
  const std::vector<GridPicture> pictures = search_pictures(files, folder.target);
  BITELINE_TRY(first_error(pictures));
  folder.size = common_size(pictures);
  for (const GridPicture& picture : pictures) {
    if (auto fault = fault_of(picture, folder.size, folder.target)) {
      folder.set_aside.push_back(std::move(*fault));
    } else {
      folder.views.push_back(make_plane_view(picture.name, picture.grids[0], folder.target));
    }
  }
  return folder;
}

Result<LaserFolder> read_laser_folder(const fs::path& calib) {
  LaserFolder folder;
  BITELINE_ASSIGN(folder.target, read_target(calib / "laser/target.yaml"));
  BITELINE_ASSIGN(const auto lit, numbered_pictures(calib / "laser", "_rings.png"));
  BITELINE_ASSIGN(const auto dark, numbered_pictures(calib / "laser", "_laser.png"));
  const std::vector<GridPicture> pictures = search_pictures(lit, folder.target);
  BITELINE_TRY(first_error(pictures));
  folder.size = common_size(pictures);
  const PictureSize size = folder.size;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    auto fault = fault_of(pictures[i], size, folder.target);
    if (fault && fault->fault != PictureFault::None) {
      folder.set_aside.push_back(std::move(*fault));
      continue;
    }
    LaserPictures place{.name = pictures[i].name, .planes = {}, .stripe = {}};
    const auto laser = std::find_if(dark.begin(), dark.end(),
                                    [&](const NumberedPicture& p) { return p.number == lit[i].number; });
    // Set aside later, for it has no stripe; laser_leftovers() names the picture that is missing.
    if (laser == dark.end()) {
      if (!fault)
        for (const GridView& grid : pictures[i].grids)
          place.planes.push_back(make_plane_view(place.name, grid, folder.target));
      folder.places.push_back(std::move(place));
      continue;
    }
    BITELINE_ASSIGN(const image::GreyImage picture, read_picture(laser->file));
    place.along_columns = runs_along_columns(picture);
    const bool same_size = picture.width_px == size.width_px && picture.height_px == size.height_px;
    if (same_size && !fault) {
      for (const GridView& grid : pictures[i].grids)
        place.planes.push_back(make_plane_view(place.name, grid, folder.target));
      constexpr int k_thinned_columns = 16;  // a tenth of a ring's width: straight, whatever the lens
      BITELINE_ASSIGN(const auto stripe, find_stripe(picture));
      place.stripe = thin_stripe(stripe.points, k_thinned_columns);
      place.speckle_contrast = stripe.speckle_contrast;
    }
    folder.places.push_back(std::move(place));
  }
  return folder;
}

Result<HandEyeFolder> read_hand_eye_folder(const fs::path& calib) {
  HandEyeFolder folder;
  BITELINE_ASSIGN(folder.target, read_target(calib / "target.yaml"));
  BITELINE_ASSIGN(const auto files, numbered_pictures(calib / "handeye", ".png"));
  const fs::path table = calib / "handeye/poses.csv";
  BITELINE_ASSIGN(const auto poses, read_hand_eye_poses(table));
  const std::vector<GridPicture> pictures = search_pictures(files, folder.target);
  BITELINE_TRY(first_error(pictures));
  folder.size = common_size(pictures);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const auto pose = std::find_if(poses.begin(), poses.end(), [&](const session::StampedPose& p) {
      return p.stamp.time_since_epoch().count() == files[i].number;
    });
    auto fault = fault_of(pictures[i], folder.size, folder.target);
    if (!fault && pose == poses.end())
      fault = SetAside{.name = pictures[i].name, .reason = "no row with its number in handeye/poses.csv"};
    if (fault) {
      folder.set_aside.push_back(std::move(*fault));
    } else {
      folder.views.push_back({.view = make_plane_view(pictures[i].name, pictures[i].grids[0], folder.target),
                              .T_base_flange = pose->T_base_flange});
    }
  }
  return folder;
}

}  // namespace biteline::calibration
