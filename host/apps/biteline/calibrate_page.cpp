// SPDX-License-Identifier: MIT
#include "host/apps/biteline/calibrate_page.hpp"

#include <array>
#include <string>
#include <vector>

#include "host/report/page.hpp"

namespace biteline::app {
namespace {

using Json = nlohmann::ordered_json;

struct Figure {
  const char* place;  ///< in the report
  const char* words;
  const char* unit;
};
constexpr std::array k_figures{
    Figure{"/camera/rms_px", "rings or corners off the camera model, RMS", "px"},
    Figure{"/camera/coverage_ratio", "share of the picture that held rings or corners", ""},
    Figure{"/laser/rms_mm", "stripe points off the laser plane, RMS", "mm"},
    Figure{"/hand_eye/left_out_rms_mm", "target as the other views predict it, RMS", "mm"},
    Figure{"/hand_eye/axes_spread_deg", "spread of the axes that the wrist turned about", "deg"},
    Figure{"/clock/offset_ms", "robot's clock minus the sensor's", "ms"},
};

struct Picture {
  const char* file;
  const char* caption;
};
constexpr std::array k_pictures{
    Picture{"stages/coverage.png",
            "Where in the picture rings or corners were seen, with what the model is off by"},
    Picture{"stages/rings_camera.png", "Camera: found rings or corners"},
    Picture{"stages/rings_laser.png", "Laser: found rings or corners, and stripe"},
    Picture{"stages/stripe.png", "Laser: each place's distance from the plane"},
    Picture{"stages/rings_handeye.png", "Hand-eye: found rings or corners"},
    Picture{"stages/left_out.png", "Hand-eye: each view as the others predict it"},
};

void add_list(report::Page& page, const char* heading, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  page.heading(heading);
  for (const std::string& line : lines) page.paragraph(line);
}

}  // namespace

Result<void> write_calibration_page(const Json& fields, const calibration::Verdict& verdict,
                                    const std::filesystem::path& folder) {
  using calibration::Grade;
  using Mood = report::Page::Mood;
  const Mood mood = verdict.grade == Grade::Good   ? Mood::Good
                    : verdict.grade == Grade::Fair ? Mood::Look
                                                   : Mood::Refused;
  report::Page page{"Calibration of a head", calibration::name_of(verdict.grade), mood};
  add_list(page, "What keeps it from good", verdict.reasons);
  add_list(page, "Take again", verdict.retake);
  add_list(page, "Warnings", fields.value("warnings", std::vector<std::string>{}));
  std::vector<std::pair<std::string, std::string>> figures;
  for (const Figure& figure : k_figures) {
    const Json::json_pointer place{figure.place};
    if (fields.contains(place) && fields.at(place).is_number())
      figures.emplace_back(figure.words, report::value_text(fields.at(place).get<double>(), figure.unit));
  }
  if (!figures.empty()) {
    page.heading("Figures");
    page.figures(figures);
  }
  for (const Picture& picture : k_pictures) {
    std::error_code ignored;
    if (std::filesystem::exists(folder / picture.file, ignored)) page.picture(picture.file, picture.caption);
  }
  page.link("report.json", "All numbers");
  return page.write(folder / "index.html");
}

}  // namespace biteline::app
