// SPDX-License-Identifier: MIT
#include "host/apps/biteline/other_reading.hpp"

#include <algorithm>

#include "common/core/fixed_text.hpp"
#include "common/core/plain_number.hpp"
#include "host/bite_line/find_bite_line.hpp"

namespace biteline::app {
namespace {

using cloud::Up;

cloud::PointCloud turned(const cloud::PointCloud& cloud, Up from, Up to) {
  // The places and normals alone: the line needs no more, and a scan's order stays as it is.
  const Eigen::Matrix3f turn = (cloud::turn_of(to) * cloud::turn_of(from).transpose()).cast<float>();
  cloud::PointCloud other;
  other.points.reserve(cloud.size());
  for (const Eigen::Vector3f& point : cloud.points) other.points.emplace_back(turn * point);
  return other;
}

struct Fit {
  double confidence{0};
  std::optional<cloud::Unit> unit;
  Up up{Up::Z};
};

/// The surest line of all axes, in one unit.
void look_at(const cloud::CloudFile& file, Up read_up, std::optional<cloud::Unit> unit, bool same_up_too,
             Fit& best) {
  for (const Up up : {Up::Z, Up::Y, Up::MinusZ, Up::MinusY, Up::X, Up::MinusX}) {
    if (up == read_up && !same_up_too) continue;
    const bite_line::Extraction found =
        bite_line::find_bite_line(turned(file.cloud, read_up, up), bite_line::Config{});
    if (found.found && found.confidence > best.confidence) best = {found.confidence, unit, up};
  }
}

}  // namespace

bool may_lie_otherwise(bite_line::Refused refused) {
  using enum bite_line::Refused;
  switch (refused) {
    case NothingConnected:
    case NotShoeSized:
    case NoCrease:
    case NoCreaseAllRound:
    case WithinOneSurface:
    case TooMuchMissing:
    case NotAShoe:
    case NoUpper:
    case NoSole:
    case Overhang:
      return true;
    default:
      return false;
  }
}

std::optional<report::ToldRefusal> other_reading(const std::filesystem::path& path,
                                                 const cloud::Reading& reading,
                                                 const cloud::CloudFile& file) {
  Fit best;
  const bool unit_unknown = cloud::unit_refusal(file).has_value();
  if (!unit_unknown) look_at(file, reading.up, std::nullopt, false, best);
  for (const cloud::Unit unit :
       unit_unknown ? cloud::units_of_a_shoe(file.size_mm) : std::vector<cloud::Unit>{}) {
    // Read anew: a mesh was sampled too coarsely, or not at all.
    const auto in_unit = cloud::read_cloud_file(path, {.unit = unit, .up = reading.up});
    if (in_unit && best.confidence == 0) look_at(*in_unit, reading.up, unit, true, best);
  }
  if (best.confidence == 0) return std::nullopt;
  std::string with, options;
  if (best.unit) {
    with = std::string{"in "} + cloud::unit_row(*best.unit).word;
    options = std::string{"--unit "} + cloud::unit_row(*best.unit).name;
  }
  if (best.up != reading.up) {
    const std::string axis = cloud::up_word(best.up);
    with += (with.empty() ? "with the file's " : " and with the file's ") +
            std::string(axis.size() == 1 ? "+" : "") + axis + " up";
    options += (options.empty() ? "--up " : " --up ") + axis;
  }
  report::ToldRefusal told;
  told.reason_code = best.unit ? "other_unit" : "other_up";
  told.reason =
      FixedText<300>::format("no line as the cloud was read, %s mm long, %s up; %s a line is found: give %s",
                             plain_number(file.size_mm).c_str(), cloud::up_word(reading.up), with.c_str(),
                             options.c_str())
          .view();
  told.next_step = "read the cloud again with " + options;
  return told;
}

}  // namespace biteline::app
