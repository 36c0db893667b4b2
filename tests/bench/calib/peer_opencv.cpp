// SPDX-License-Identifier: MIT
#include "tests/bench/calib/peer_opencv.hpp"

#include <array>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>

namespace biteline::bench {

std::optional<std::vector<Vec2>> opencv_grid(const image::GreyImage& picture,
                                             const calibration::RingTarget& target) {
  const cv::Mat grey(picture.height_px, picture.width_px, CV_8UC1,
                     const_cast<std::uint8_t*>(picture.pixels.data()));
  cv::Mat inverted;
  cv::bitwise_not(grey, inverted);
  cv::SimpleBlobDetector::Params params;
  params.minArea = 30;
  params.maxArea = 20000;
  const auto detector = cv::SimpleBlobDetector::create(params);
  std::vector<cv::Point2f> centres;
  if (!cv::findCirclesGrid(inverted, cv::Size(target.cols, target.rows), centres, cv::CALIB_CB_SYMMETRIC_GRID,
                           detector))
    return std::nullopt;
  std::vector<Vec2> result;
  for (const cv::Point2f& c : centres) result.emplace_back(c.x, c.y);
  return result;
}

OpencvCamera opencv_camera(const std::vector<std::vector<Vec2>>& views, const calibration::RingTarget& target,
                           calibration::PictureSize size) {
  std::vector<std::vector<cv::Point3f>> objects;
  std::vector<std::vector<cv::Point2f>> pictures;
  for (const std::vector<Vec2>& view : views) {
    objects.emplace_back();
    pictures.emplace_back();
    for (int row = 0; row < target.rows; ++row) {
      for (int col = 0; col < target.cols; ++col) {
        const Vec3 p = target.ring_target(row, col);
        objects.back().emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
      }
    }
    for (const Vec2& c : view)
      pictures.back().emplace_back(static_cast<float>(c.x()), static_cast<float>(c.y()));
  }
  cv::Mat K, distortion;
  std::vector<cv::Mat> rotations, translations;
  OpencvCamera result;
  result.rms_px = cv::calibrateCamera(objects, pictures, cv::Size(size.width_px, size.height_px), K,
                                      distortion, rotations, translations);
  result.camera = {.fu_px = K.at<double>(0, 0),
                   .fv_px = K.at<double>(1, 1),
                   .cu_px = K.at<double>(0, 2),
                   .cv_px = K.at<double>(1, 2),
                   .k1 = distortion.at<double>(0),
                   .k2 = distortion.at<double>(1),
                   .p1 = distortion.at<double>(2),
                   .p2 = distortion.at<double>(3),
                   .k3 = distortion.at<double>(4)};
  return result;
}

SE3 opencv_pose(const geometry::Camera& camera, const std::vector<Vec2>& centres,
                const calibration::RingTarget& target) {
  std::vector<cv::Point3f> object;
  std::vector<cv::Point2f> picture;
  for (int i = 0; i < target.rings(); ++i) {
    const Vec3 p = target.ring_target(i / target.cols, i % target.cols);
    object.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F);
    const Vec2& c = centres[static_cast<std::size_t>(i)];
    picture.emplace_back(static_cast<float>(c.x()), static_cast<float>(c.y()));
  }
  const cv::Matx33d K(camera.fu_px, 0, camera.cu_px, 0, camera.fv_px, camera.cv_px, 0, 0, 1);
  const cv::Vec<double, 5> distortion(camera.k1, camera.k2, camera.p1, camera.p2, camera.k3);
  cv::Vec3d rotation, translation;
  cv::solvePnP(object, picture, K, distortion, rotation, translation);
  SE3 T = SE3::Identity();
  T.linear() = geometry::exp_so3(Vec3(rotation[0], rotation[1], rotation[2]));
  T.translation() = Vec3(translation[0], translation[1], translation[2]);
  return T;
}

const char* hand_eye_name(int method) {
  constexpr std::array<const char*, k_hand_eye_methods> k_names{"OpenCV Tsai", "OpenCV Park", "OpenCV Horaud",
                                                                "OpenCV Andreff", "OpenCV Daniilidis"};
  return k_names[static_cast<std::size_t>(method)];
}

SE3 opencv_hand_eye(const std::vector<calibration::Stop>& stops, int method) {
  std::vector<cv::Mat> R_base_flange, t_base_flange, R_cam_target, t_cam_target;
  const auto put = [](const SE3& T, std::vector<cv::Mat>& R, std::vector<cv::Mat>& t) {
    cv::Mat rotation(3, 3, CV_64F), translation(3, 1, CV_64F);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rotation.at<double>(i, j) = T.linear()(i, j);
      translation.at<double>(i) = T.translation()[i];
    }
    R.push_back(rotation);
    t.push_back(translation);
  };
  for (const calibration::Stop& stop : stops) {
    put(stop.T_base_flange, R_base_flange, t_base_flange);
    put(stop.T_cam_target, R_cam_target, t_cam_target);
  }
  cv::Mat R, t;
  cv::calibrateHandEye(R_base_flange, t_base_flange, R_cam_target, t_cam_target, R, t,
                       static_cast<cv::HandEyeCalibrationMethod>(method));
  SE3 T = SE3::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) T.linear()(i, j) = R.at<double>(i, j);
    T.translation()[i] = t.at<double>(i);
  }
  return T;
}

}  // namespace biteline::bench
