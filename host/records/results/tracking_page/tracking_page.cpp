// SPDX-License-Identifier: MIT
#include "host/records/results/tracking_page/tracking_page.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/records/results/tracking_page/embedded_texts.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"
#include "host/robot/kinematics/arm_shape.hpp"

namespace biteline::results {
namespace {

using nlohmann::ordered_json;

/// As many digits as can be seen keep the page small.
double rounded(double value, double per_unit) {
  return std::round(value * per_unit) / per_unit;
}

ordered_json as_json(const Vec3& p) {
  return {rounded(p.x(), 100), rounded(p.y(), 100), rounded(p.z(), 100)};
}

/// Row-major, as three.js' Matrix4.set() takes it.
ordered_json as_json(const SE3& T) {
  ordered_json out = ordered_json::array();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) out.push_back(T.matrix()(row, column));
  }
  return out;
}

ordered_json arm_json(const kinematics::ArmModel& arm) {
  ordered_json out{{"name", arm.name},
                   {"frames", ordered_json::array()},
                   {"links", ordered_json::array()},
                   {"max_speed", ordered_json::array()}};
  for (const SE3& T : arm.T_fixed) out["frames"].push_back(as_json(T));
  for (const kinematics::LinkCapsule& link : kinematics::link_capsules(arm)) {
    out["links"].push_back({{"name", link.name},
                            {"joint", link.joint},
                            {"a", as_json(link.capsule.a)},
                            {"b", as_json(link.capsule.b)},
                            {"r", link.capsule.radius_mm}});
  }
  for (const double speed_rad_s : arm.limits.speed_rad_s) out["max_speed"].push_back(speed_rad_s);
  return out;
}

ordered_json path_json(const path::PlannedPath& path) {
  ordered_json out{{"time", ordered_json::array()},     {"q", ordered_json::array()},
                   {"tip", ordered_json::array()},      {"speed", ordered_json::array()},
                   {"distance", ordered_json::array()}, {"on_line", ordered_json::array()},
                   {"line", ordered_json::array()}};
  for (const path::Waypoint& w : path.waypoints) {
    out["time"].push_back(rounded(w.time_s, 1e4));
    ordered_json q = ordered_json::array();
    for (const double angle_rad : w.q_rad) q.push_back(rounded(angle_rad, 1e5));
    out["q"].push_back(std::move(q));
    out["tip"].push_back(as_json(Vec3(w.T_base_tcp.translation())));
    out["speed"].push_back(rounded(w.speed_mm_s, 100));
    out["distance"].push_back(rounded((w.T_base_tcp.translation() - w.line_base).norm(), 1000));
    const bool on_line = w.segment == path::Segment::Line;
    out["on_line"].push_back(on_line ? 1 : 0);
    if (on_line) out["line"].push_back(as_json(w.line_base));
  }
  return out;
}

ordered_json shoe_json(const std::vector<Vec3>& points) {
  const std::size_t step = std::max<std::size_t>(1, (points.size() + k_most_points - 1) / k_most_points);
  ordered_json out = ordered_json::array();
  for (std::size_t i = 0; i < points.size(); i += step) {
    for (int axis = 0; axis < 3; ++axis) out.push_back(rounded(points[i][axis], 10));
  }
  return out;
}

/// Thinned to some 1500 samples: more than a plot has pixels.
ordered_json track_json(const std::vector<path::TrackSample>& track) {
  ordered_json out{{"time", ordered_json::array()}, {"tip", ordered_json::array()}};
  const std::size_t step = std::max<std::size_t>(1, track.size() / 1500);
  for (std::size_t i = 0; i < track.size(); i += step) {
    out["time"].push_back(rounded(track[i].time_s, 1e3));
    out["tip"].push_back(as_json(Vec3(track[i].T_base_tcp.translation())));
  }
  return out;
}

void replace(std::string& text, const std::string& mark, const std::string& by) {
  const std::size_t at = text.find(mark);
  if (at != std::string::npos) text.replace(at, mark.size(), by);
}

}  // namespace

Result<void> write_tracking_page(const std::filesystem::path& file, const Scene& scene) {
  const ordered_json data{{"process", scene.path.process},
                          {"arm", arm_json(scene.arm)},
                          {"tool",
                           {{"frame", as_json(scene.tool.T_flange_tcp)},
                            {"radius", scene.tool.body_radius_mm},
                            {"contact", scene.tool.contact_length_mm}}},
                          {"path", path_json(scene.path)},
                          {"table_z", scene.table_z_mm},
                          {"shoe", shoe_json(scene.shoe_points_base)},
                          {"shoe_is_guessed", scene.shoe_is_guessed},
                          {"track", track_json(scene.track)}};
  std::string text = report::to_text(data, -1);
  // A name with "</script>" in it would end the page's script.
  for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at + 3))
    text.replace(at, 2, "<\\/");
  std::string page{tracking_html()};
  replace(page, "/*BITELINE_THREE*/", std::string{three_js()});
  replace(page, "/*BITELINE_DATA*/", text);
  return report::write_file_atomically(file, page);
}

}  // namespace biteline::results
