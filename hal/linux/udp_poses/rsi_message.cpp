// SPDX-License-Identifier: MIT
#include "hal/linux/udp_poses/rsi_message.hpp"

#include <charconv>
#include <cstdio>
#include <numbers>
#include <optional>

#include "hal/linux/udp_poses/xml_tags.hpp"

namespace biteline::hal {
namespace {

/// A whole number text; nothing: it is none, or beyond its type.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  constexpr std::string_view k_blank = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(k_blank), text.size()));
  while (!text.empty() && k_blank.find(text.back()) != std::string_view::npos) text.remove_suffix(1);
  Number value{};
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

struct Found {
  std::optional<std::string_view> pose, ipoc;
};

/// The pose's attributes and the count's text; nothing: the text is no controller's.
std::optional<Found> find_parts(std::string_view text) {
  Found found;
  XmlTags tags{text};
  const std::optional<XmlTags::Tag> root = tags.next();
  if (!root || root->name != "Rob" || !root->opens || root->closes) return std::nullopt;
  int depth = 1;
  while (depth > 0) {
    const std::optional<XmlTags::Tag> tag = tags.next();
    if (!tag) return std::nullopt;
    if (tag->opens && depth == 1 && tag->name == "RIst") found.pose = tag->attributes;
    if (tag->opens && !tag->closes && depth == 1 && tag->name == "IPOC") found.ipoc = tag->text_after;
    depth += (tag->opens ? 1 : 0) - (tag->closes ? 1 : 0);
    if (depth == 0 && tag->name != "Rob") return std::nullopt;
  }
  if (tags.next() || !tags.whole()) return std::nullopt;
  return found;
}

Mat3 turn_of(double a_deg, double b_deg, double c_deg) {
  constexpr double k_rad_per_deg = std::numbers::pi / 180;
  return (Eigen::AngleAxisd{k_rad_per_deg * a_deg, Vec3::UnitZ()} *
          Eigen::AngleAxisd{k_rad_per_deg * b_deg, Vec3::UnitY()} *
          Eigen::AngleAxisd{k_rad_per_deg * c_deg, Vec3::UnitX()})
      .toRotationMatrix();
}

/// Nothing: no six numbers, no place of an arm, or no angles.
std::optional<SE3> motion_of(std::string_view attributes) {
  constexpr std::array<std::string_view, 6> k_names{"X", "Y", "Z", "A", "B", "C"};
  constexpr double k_turn_max_deg = 360;
  std::array<double, 6> value{};
  for (std::size_t i = 0; i < value.size(); ++i) {
    const std::optional<std::string_view> text = attribute(attributes, k_names[i]);
    const std::optional<double> number = text ? number_of<double>(*text) : std::nullopt;
    if (!number || !std::isfinite(*number)) return std::nullopt;
    if (i >= 3 && std::abs(*number) > k_turn_max_deg) return std::nullopt;
    value[i] = *number;
  }
  SE3 T = SE3::Identity();
  T.translation() = Vec3{value[0], value[1], value[2]};
  if (!within_reach(T.translation())) return std::nullopt;
  T.linear() = turn_of(value[3], value[4], value[5]);
  return T;
}

}  // namespace

Result<ToldPose> read_rsi(std::span<const std::uint8_t> message) {
  std::string_view text{reinterpret_cast<const char*>(message.data()), message.size()};
  while (text.ends_with('\0')) text.remove_suffix(1);
  const std::optional<Found> found = find_parts(text);
  if (!found) return fail(Errc::ProtocolError, "RSI: no text of a controller");
  if (!found->pose || !found->ipoc) return fail(Errc::BadFormat, "RSI: RIst and IPOC expected");
  constexpr std::uint64_t k_ipoc_max_ms =
      4'000'000'000'000;  // 127 years: nanoseconds in 63 bits hold twice that
  const std::optional<std::uint64_t> ipoc_ms = number_of<std::uint64_t>(*found->ipoc);
  if (!ipoc_ms || *ipoc_ms > k_ipoc_max_ms) return fail(Errc::BadValue, "RSI: IPOC is no count");
  const std::optional<SE3> T_base_flange = motion_of(*found->pose);
  if (!T_base_flange) return fail(Errc::BadValue, "RSI: RIst is no pose");
  return ToldPose{
      .stamp = RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(*ipoc_ms) * 1'000'000}},
      .T_base_flange = *T_base_flange};
}

RsiAnswer::RsiAnswer(RobotClock::time_point stamp) {
  const int size = std::snprintf(text_.data(), text_.size(), "<Sen Type=\"ImFree\"><IPOC>%lld</IPOC></Sen>",
                                 static_cast<long long>(stamp.time_since_epoch().count() / 1'000'000));
  size_ = static_cast<std::size_t>(size);
}

}  // namespace biteline::hal
