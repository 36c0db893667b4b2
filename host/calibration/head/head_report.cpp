// SPDX-License-Identifier: MIT
#include "host/calibration/head/head_report.hpp"

#include <cmath>
#include <numbers>

namespace biteline::calibration {

namespace {

using Json = nlohmann::ordered_json;

constexpr double k_degrees_per_rad = 180 / std::numbers::pi;

Json vector_json(const auto& vector) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) list.push_back(vector[i]);
  return list;
}

Json matrix_json(const SE3& T) {
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) rows.push_back(vector_json(Eigen::Vector4d(T.matrix().row(i).transpose())));
  return rows;
}

Json camera_json(const HeadCalibration& all) {
  const CameraCalibration& camera = *all.camera;
  const geometry::Camera& c = all.fit.state.camera;
  const CameraVector sigma = all.fit.camera_sigma();
  const std::array<std::pair<const char*, double>, 9> values{{{"fu_px", c.fu_px},
                                                              {"fv_px", c.fv_px},
                                                              {"cu_px", c.cu_px},
                                                              {"cv_px", c.cv_px},
                                                              {"k1", c.k1},
                                                              {"k2", c.k2},
                                                              {"p1", c.p1},
                                                              {"p2", c.p2},
                                                              {"k3", c.k3}}};
  Json json;
  json["rms_px"] = all.fit.rms_px;
  json["rms_alone_px"] = camera.rms_px;
  json["centre_sigma_px"] = camera.sigma_px;
  for (int i = 0; i < 9; ++i) {
    const auto& [name, value] = values[static_cast<std::size_t>(i)];
    json[name] = {{"value", value}, {"sigma", sigma[i]}};
    if (i >= 4 && !camera.distortion[static_cast<std::size_t>(i - 4)])
      json[name]["left_out"] = "not to be told from 0";
  }
  const PixelGrid& grid = all.pixel_grid;
  json["pixel_grid"] = {{"uneven", grid.uneven()},
                        {"shift_rms_px", grid.rms_px()},
                        {"explained_ratio", grid.explained_ratio()}};
  json["coverage_ratio"] = camera.coverage_ratio;
  json["largest_tilt_deg"] = camera.largest_tilt_rad * k_degrees_per_rad;
  json["views"] = Json::array();
  for (const CameraView& view : camera.views) {
    json["views"].push_back({{"name", view.view.name},
                             {"rms_px", view.rms_px},
                             {"rings", view.view.centres.size()},
                             {"rings_missing", view.view.grid.missing},
                             {"rings_set_aside", view.rings_set_aside}});
  }
  return json;
}

Json laser_json(const HeadCalibration& all) {
  const LaserCalibration& laser = *all.laser;
  const geometry::LaserPlane& plane = all.fit.state.plane;
  Json json;
  json["plane"] = {plane.normal_cam.x(), plane.normal_cam.y(), plane.normal_cam.z(), plane.distance_mm};
  json["rms_mm"] = all.fit.stripe_rms_mm;
  json["rms_alone_mm"] = laser.rms_mm;
  const auto& covariance = all.fit.covariance;
  json["normal_sigma_rad"] = {std::sqrt(covariance(9, 9)), std::sqrt(covariance(10, 10))};
  json["distance_sigma_mm"] = std::sqrt(covariance(11, 11));
  const Vec2 middle_px = all.fit.state.camera.project(all.fit.plane_middle_cam);
  json["at_working_distance"] = {{"point_cam_mm", vector_json(all.fit.plane_middle_cam)},
                                 {"sigma_mm", vector_json(all.fit.triangulation_sigma_mm(middle_px))}};
  json["points"] = laser.points;
  json["points_set_aside"] = laser.points_set_aside;
  if (laser.two_planes) {
    const SE3& T_12 = all.fit.state.T_plane1_plane2;
    json["target_angle_deg"] = std::acos(std::clamp(T_12.linear()(2, 2), -1.0, 1.0)) * k_degrees_per_rad;
  }
  json["views"] = Json::array();
  for (const LaserView& view : laser.views) {
    std::size_t rings = 0;
    for (const PlaneView& grid : view.pictures.planes) rings += grid.centres.size();
    json["views"].push_back({{"name", view.pictures.name},
                             {"grids", view.pictures.planes.size()},
                             {"rings", rings},
                             {"points", view.points.size()},
                             {"rms_mm", view.rms_mm}});
  }
  return json;
}

Json hand_eye_json(const HeadCalibration& all) {
  const HandEyeCalibration& hand_eye = *all.hand_eye;
  const Twist sigma = all.fit.mounting_sigma();
  Json json;
  json["T_flange_cam"] = matrix_json(all.fit.state.T_flange_cam);
  json["mounting_mm"] = all.fit.state.T_flange_cam.translation().norm();
  json["T_base_target"] = matrix_json(all.fit.state.T_base_target);
  json["sigma_mm"] = vector_json(Vec3(sigma.head<3>()));
  json["sigma_deg"] = vector_json(Vec3(sigma.tail<3>() * k_degrees_per_rad));
  json["rms_px"] = all.fit.arm_rms_px;
  json["robot_noise"] = {{"sigma_mm", hand_eye.pose_sigma_mm},
                         {"sigma_deg", hand_eye.pose_sigma_rad * k_degrees_per_rad}};
  json["left_out_rms_mm"] = hand_eye.left_out_rms_mm;
  json["left_out_rms_deg"] = hand_eye.left_out_rms_rad * k_degrees_per_rad;
  json["axes_spread_deg"] = hand_eye.axes_spread_rad * k_degrees_per_rad;
  json["largest_turn_deg"] = hand_eye.largest_turn_rad * k_degrees_per_rad;
  json["views"] = Json::array();
  for (std::size_t i = 0; i < hand_eye.stops.size(); ++i) {
    const HandEyeStop& stop = hand_eye.stops[i];
    json["views"].push_back({{"name", all.arm_views[i].view.name},
                             {"rings", all.arm_views[i].view.centres.size()},
                             {"left_out_mm", stop.left_out_mm},
                             {"left_out_deg", stop.left_out_rad * k_degrees_per_rad}});
  }
  return json;
}

}  // namespace

Json report_fields(const HeadCalibration& calibration) {
  Json fields;
  const bool together = calibration.fit.converged;
  if (calibration.camera && together) fields["camera"] = camera_json(calibration);
  if (calibration.laser && together) fields["laser"] = laser_json(calibration);
  if (calibration.hand_eye && together) fields["hand_eye"] = hand_eye_json(calibration);
  fields["set_aside"] = Json::array();
  for (const SetAside& one : calibration.set_aside)
    fields["set_aside"].push_back({{"name", one.name}, {"reason", one.reason}});
  return fields;
}

}  // namespace biteline::calibration
