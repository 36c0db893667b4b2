// SPDX-License-Identifier: MIT
#pragma once
/// \file What the public types hold, and how a failure of the rooms becomes an exception.

#include <optional>
#include <utility>
#include <vector>

#include "biteline/cloud.hpp"
#include "biteline/error.hpp"
#include "biteline/line.hpp"
#include "biteline/motion.hpp"
#include "biteline/stripe.hpp"
#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/report/refusal.hpp"

namespace biteline::sdk {

struct Cloud::State {
  cloud::PointCloud cloud;
};

struct Head::State {
  geometry::SensorModel model;
};

[[nodiscard]] Cloud make_cloud(cloud::PointCloud cloud);
[[nodiscard]] Head make_head(const geometry::SensorModel& model);
[[nodiscard]] Line from_inside(const cloud::ClosedLine& line);
/// Throws Error where a number is not finite, or there are fewer than three points.
[[nodiscard]] cloud::ClosedLine to_inside(const Line& line);
[[nodiscard]] inline Motion from_inside(const SE3& T) {
  return Motion{T.matrix()};
}

[[noreturn]] void throw_error(const biteline::Error& error);
[[noreturn]] void throw_refusal(report::ToldRefusal refusal);

template <class T>
T or_throw(Result<T> result) {
  if (!result) throw_error(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace biteline::sdk
