// SPDX-License-Identifier: MIT
#include "biteline/cloud.hpp"

#include "host/cloud/cloud_file.hpp"
#include "host/cloud/ply.hpp"
#include "host/library/source/inside.hpp"

namespace biteline::sdk {
namespace {

cloud::Unit inside_of(Unit unit) {
  switch (unit) {
    case Unit::Millimetre:
      return cloud::Unit::Millimetre;
    case Unit::Centimetre:
      return cloud::Unit::Centimetre;
    case Unit::Metre:
      return cloud::Unit::Metre;
    case Unit::Inch:
      return cloud::Unit::Inch;
  }
  throw Error{"unit: none of those that are known", "give one of Unit's names"};
}

}  // namespace

Cloud make_cloud(cloud::PointCloud cloud) {
  return Cloud{std::make_shared<const Cloud::State>(Cloud::State{.cloud = std::move(cloud)})};
}

Cloud::Cloud(std::shared_ptr<const State> state) : state_{std::move(state)} {}

Cloud::Cloud(std::vector<Eigen::Vector3f> points_mm) {
  if (points_mm.empty()) throw Error{"cloud: no point", "give at least one point"};
  for (std::size_t i = 0; i < points_mm.size(); ++i)
    if (!points_mm[i].allFinite())
      throw Error{"cloud: point " + std::to_string(i) + " is not finite", "leave such points out"};
  State state;
  state.cloud.points = std::move(points_mm);
  state_ = std::make_shared<const State>(std::move(state));
}

std::size_t Cloud::size() const {
  return state_->cloud.size();
}
std::span<const Eigen::Vector3f> Cloud::points_mm() const {
  return state_->cloud.points;
}
std::span<const std::uint32_t> Cloud::profile() const {
  return state_->cloud.profile;
}
std::span<const std::uint16_t> Cloud::column() const {
  return state_->cloud.column;
}
std::span<const float> Cloud::sigma_mm() const {
  return state_->cloud.sigma_mm;
}

Cloud read_cloud(const std::filesystem::path& file, Unit unit) {
  return make_cloud(or_throw(cloud::read_cloud_file(file, {.unit = inside_of(unit)})).cloud);
}

void write_cloud(const std::filesystem::path& file, const Cloud& cloud) {
  or_throw(cloud::write_cloud(file, cloud.state().cloud));
}

}  // namespace biteline::sdk
