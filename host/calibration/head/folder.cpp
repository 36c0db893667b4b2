// SPDX-License-Identifier: MIT
#include "host/calibration/head/folder.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>

#include "common/session/session.hpp"
#include "host/calibration/rings/picture.hpp"

namespace biteline::calibration {

namespace fs = std::filesystem;

namespace {

struct GridPicture {
  std::string name;
  PictureSize size;
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
    found[i].grids = find_grids(*picture, target, target.planes);
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

/// Why a picture cannot be used at all; "" when it can.
std::string fault_of(const GridPicture& picture, PictureSize size, const RingTarget& target) {
  if (picture.size.width_px != size.width_px || picture.size.height_px != size.height_px) {
    return std::to_string(picture.size.width_px) + " x " + std::to_string(picture.size.height_px) +
           " px where the others have " + std::to_string(size.width_px) + " x " +
           std::to_string(size.height_px) + " (another camera?)";
  }
  if (!picture.grids.empty()) return "";
  return target.chessboard() ? "no chessboard as target.yaml says found (square_rows and square_cols count "
                               "squares, first_square is the upper left one)"
                             : "no ring grid of target.yaml's shape found";
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
    const std::string fault = fault_of(picture, folder.size, folder.target);
    if (fault.empty()) {
      folder.views.push_back(make_plane_view(picture.name, picture.grids[0], folder.target));
    } else {
      folder.set_aside.push_back({.name = picture.name, .reason = fault});
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
  const PictureSize size = common_size(pictures);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    LaserPictures place{.name = pictures[i].name, .planes = {}, .stripe = {}};
    const auto laser = std::find_if(dark.begin(), dark.end(),
                                    [&](const NumberedPicture& p) { return p.number == lit[i].number; });
    // Set aside later, for it has no stripe; laser_leftovers() names the picture that is missing.
    if (laser == dark.end()) {
      if (fault_of(pictures[i], size, folder.target).empty())
        for (const GridView& grid : pictures[i].grids)
          place.planes.push_back(make_plane_view(place.name, grid, folder.target));
      folder.places.push_back(std::move(place));
      continue;
    }
    BITELINE_ASSIGN(const image::GreyImage picture, read_picture(laser->file));
    const bool same_size = picture.width_px == size.width_px && picture.height_px == size.height_px;
    if (same_size && fault_of(pictures[i], size, folder.target).empty()) {
      for (const GridView& grid : pictures[i].grids)
        place.planes.push_back(make_plane_view(place.name, grid, folder.target));
      constexpr int k_thinned_columns = 16;  // a tenth of a ring's width: straight, whatever the lens
      BITELINE_ASSIGN(const auto stripe, find_stripe(picture));
      place.stripe = thin_stripe(stripe, k_thinned_columns);
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
  BITELINE_ASSIGN(const auto poses, session::read_pose_table(table, session::RowOrder::Any));
  const std::vector<GridPicture> pictures = search_pictures(files, folder.target);
  BITELINE_TRY(first_error(pictures));
  const PictureSize size = common_size(pictures);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const auto pose = std::find_if(poses.begin(), poses.end(), [&](const session::StampedPose& p) {
      return p.stamp.time_since_epoch().count() == files[i].number;
    });
    std::string fault = fault_of(pictures[i], size, folder.target);
    if (fault.empty() && pose == poses.end()) fault = "no row with its number in handeye/poses.csv";
    if (fault.empty()) {
      folder.views.push_back({.view = make_plane_view(pictures[i].name, pictures[i].grids[0], folder.target),
                              .T_base_flange = pose->T_base_flange});
    } else {
      folder.set_aside.push_back({.name = pictures[i].name, .reason = fault});
    }
  }
  return folder;
}

}  // namespace biteline::calibration
