// SPDX-License-Identifier: MIT
#include "host/calibration/head/leftovers.hpp"

#include <map>
#include <set>

#include "common/config/camera_state_yaml.hpp"
#include "host/calibration/head/pose_file.hpp"
#include "host/calibration/rings/picture.hpp"

namespace biteline::calibration {
namespace {

namespace fs = std::filesystem;

/// Pictures by their number.
using Numbers = std::map<std::int64_t, std::string>;

/// A folder of pictures "12.png" or "12_rings.png", and what else lies in it.
class Folder {
 public:
  Folder(const fs::path& calib, const char* name)
      : path_{calib / name}, name_{name}, known_{config::k_camera_state_file} {}

  /// The numbers of the pictures with this ending.
  Numbers take(const std::string& ending) {
    Numbers numbers;
    const auto pictures = numbered_pictures(path_, ending);
    if (!pictures) return numbers;
    for (const NumberedPicture& picture : *pictures) {
      numbers.emplace(picture.number, picture.file.filename().string());
      known_.insert(picture.file.filename().string());
    }
    return numbers;
  }
  void know(const char* file) { known_.insert(file); }

  /// What nobody took.  `expected`: as it would have to be called.
  void tell_others(const char* expected, std::vector<std::string>& lines) const {
    std::error_code error;
    std::set<std::string> others;
    for (fs::directory_iterator entry{path_, error}, end; !error && entry != end; entry.increment(error)) {
      const std::string name = entry->path().filename().string();
      if (!known_.contains(name) && !name.starts_with('.')) others.insert(name);
    }
    for (const std::string& name : others)
      lines.push_back(std::string{name_} + "/" + name + " is not used: " + expected + " expected");
  }

 private:
  fs::path path_;
  const char* name_;
  std::set<std::string> known_;
};

void tell_lonely(const Numbers& pictures, const Numbers& partners, const char* lacks,
                 std::vector<std::string>& lines) {
  for (const auto& [number, name] : pictures) {
    if (partners.contains(number)) continue;
    lines.push_back("laser/" + name + " is not used: no picture " + std::to_string(number) + lacks +
                    " beside it");
  }
}

}  // namespace

std::vector<std::string> camera_leftovers(const fs::path& calib) {
  std::vector<std::string> lines;
  Folder folder{calib, "camera"};
  folder.take(".png");
  folder.tell_others("NN.png", lines);
  return lines;
}

std::vector<std::string> laser_leftovers(const fs::path& calib) {
  std::vector<std::string> lines;
  Folder folder{calib, "laser"};
  folder.know("target.yaml");
  const Numbers rings = folder.take("_rings.png"), stripes = folder.take("_laser.png");
  tell_lonely(rings, stripes, "_laser.png", lines);
  tell_lonely(stripes, rings, "_rings.png", lines);
  folder.tell_others("NN_rings.png or NN_laser.png", lines);
  return lines;
}

std::vector<std::string> hand_eye_leftovers(const fs::path& calib) {
  std::vector<std::string> lines;
  Folder folder{calib, "handeye"};
  folder.know("poses.csv");
  const Numbers pictures = folder.take(".png");
  const auto poses = read_hand_eye_poses(calib / "handeye/poses.csv");
  if (poses) {
    for (const session::StampedPose& pose : *poses) {
      const std::int64_t number = pose.stamp.time_since_epoch().count();
      if (!pictures.contains(number))
        lines.push_back("handeye/poses.csv: the pose of " + std::to_string(number) +
                        " is not used: no picture of that number");
    }
  }
  folder.tell_others("NN.png", lines);
  return lines;
}

}  // namespace biteline::calibration
