// SPDX-License-Identifier: MIT
#include "hal/linux/udp_poses/egm_message.hpp"

#include <array>
#include <limits>

#include "hal/api/pose_source.hpp"
#include "hal/linux/udp_poses/proto_fields.hpp"

namespace biteline::hal {
namespace {

using Type = ProtoFields::Type;

// egm.proto: EgmHeader.MessageType.  2 is what a controller sends; some leave it out.
constexpr std::uint64_t k_undefined = 0, k_data = 2;
// EgmRapidCtrlExecState
constexpr std::uint64_t k_rapid_running = 2;

struct Header {
  std::optional<std::uint64_t> number{}, time_ms{};
  std::uint64_t kind{k_undefined};
};

struct EgmClock {
  std::optional<std::uint64_t> s{}, us{};
};

/// `Count` doubles in fields 1 to Count.
template <std::size_t Count>
struct Doubles {
  std::array<double, Count> value{};
  unsigned seen{0};  ///< bits

  [[nodiscard]] bool all() const { return seen == (1U << Count) - 1U; }
};

struct Feedback {
  Doubles<3> place_mm;
  Doubles<4> turn;
  EgmClock clock;
};

/// Calls `take` for each field of one message.  false: the bytes are none, or `take` says so.
template <class Take>
bool each_field(std::span<const std::uint8_t> message, const Take& take) {
  ProtoFields fields{message};
  while (const std::optional<ProtoFields::Field> field = fields.next()) {
    if (!take(*field)) return false;
  }
  return fields.whole();
}

template <std::size_t Count>
bool read_doubles(std::span<const std::uint8_t> message, Doubles<Count>& out) {
  return each_field(message, [&](const ProtoFields::Field& field) {
    if (field.number > Count) return true;
    if (field.type != Type::Fixed64) return false;
    out.value[field.number - 1] = field.as_double();
    out.seen |= 1U << (field.number - 1);
    return true;
  });
}

bool read_header(std::span<const std::uint8_t> message, Header& out) {
  return each_field(message, [&](const ProtoFields::Field& field) {
    if (field.number > 3) return true;
    if (field.number == 1) out.number = field.value;
    if (field.number == 2) out.time_ms = field.value;
    if (field.number == 3) out.kind = field.value;
    return field.type == Type::Varint;
  });
}

bool read_clock(std::span<const std::uint8_t> message, EgmClock& out) {
  return each_field(message, [&](const ProtoFields::Field& field) {
    if (field.number > 2) return true;
    (field.number == 1 ? out.s : out.us) = field.value;
    return field.type == Type::Varint;
  });
}

bool read_pose(std::span<const std::uint8_t> message, Feedback& out) {
  return each_field(message, [&](const ProtoFields::Field& field) {
    if (field.number > 2) return true;
    if (field.type != Type::Bytes) return false;
    return field.number == 1 ? read_doubles(field.bytes, out.place_mm) : read_doubles(field.bytes, out.turn);
  });
}

bool read_feedback(std::span<const std::uint8_t> message, Feedback& out) {
  return each_field(message, [&](const ProtoFields::Field& field) {
    if (field.number != 2 && field.number != 4) return true;
    if (field.type != Type::Bytes) return false;
    return field.number == 2 ? read_pose(field.bytes, out) : read_clock(field.bytes, out.clock);
  });
}

bool read_state(std::span<const std::uint8_t> message, std::uint64_t& out) {
  return each_field(message, [&](const ProtoFields::Field& field) {
    if (field.number == 1) out = field.value;
    return field.number != 1 || field.type == Type::Varint;
  });
}

/// The controller's instant of the pose; nothing: not told, or beyond what anybody can mean.
std::optional<RobotClock::time_point> stamp_of(const Header& header, const EgmClock& clock) {
  constexpr std::uint64_t k_longest_s = 4'000'000'000;  // 127 years: nanoseconds in 63 bits hold twice that
  if (clock.s && clock.us) {
    if (*clock.s > k_longest_s || *clock.us >= 1'000'000) return std::nullopt;
    return RobotClock::time_point{
        Nanoseconds{static_cast<std::int64_t>(*clock.s * 1'000'000'000 + *clock.us * 1000)}};
  }
  if (!header.time_ms || *header.time_ms > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(*header.time_ms) * 1'000'000}};
}

/// Nothing: no place of an arm, or no rotation.
std::optional<SE3> motion_of(const Feedback& feedback) {
  constexpr double k_length_tolerance = 1e-3;  // controllers tell some six digits
  const Vec3 place_mm{feedback.place_mm.value[0], feedback.place_mm.value[1], feedback.place_mm.value[2]};
  double length_squared = 0;
  for (const double part : feedback.turn.value) {
    if (!std::isfinite(part) || std::abs(part) > 1 + k_length_tolerance) return std::nullopt;
    length_squared += part * part;
  }
  if (!within_reach(place_mm) || std::abs(std::sqrt(length_squared) - 1) > k_length_tolerance)
    return std::nullopt;
  const Eigen::Quaterniond turn{feedback.turn.value[0], feedback.turn.value[1], feedback.turn.value[2],
                                feedback.turn.value[3]};
  return geometry::make_se3(turn.normalized(), place_mm);
}

}  // namespace

Result<ToldPose> read_egm(std::span<const std::uint8_t> message) {
  Header header;
  Feedback feedback;
  std::uint64_t rapid = 0;
  const bool readable = each_field(message, [&](const ProtoFields::Field& field) {
    if (field.number != 1 && field.number != 2 && field.number != 8) return true;
    if (field.type != Type::Bytes) return false;
    if (field.number == 1) return read_header(field.bytes, header);
    return field.number == 2 ? read_feedback(field.bytes, feedback) : read_state(field.bytes, rapid);
  });
  if (!readable || message.empty() || (header.kind != k_undefined && header.kind != k_data))
    return fail(Errc::ProtocolError, "EGM: no message of a controller");
  if (!feedback.place_mm.all() || !feedback.turn.all())
    return fail(Errc::BadFormat, "EGM: feedBack.cartesian with pos and orient expected");
  const std::optional<RobotClock::time_point> stamp = stamp_of(header, feedback.clock);
  if (!stamp) return fail(Errc::BadFormat, "EGM: feedBack.time or header.tm expected");
  const std::optional<SE3> T_base_flange = motion_of(feedback);
  if (!T_base_flange) return fail(Errc::BadValue, "EGM: feedBack.cartesian is no pose");
  ToldPose told{.stamp = *stamp, .T_base_flange = *T_base_flange};
  if (header.number) told.number = static_cast<std::uint32_t>(*header.number);
  if (rapid == k_rapid_running) told.status |= k_pose_program_running;
  return told;
}

}  // namespace biteline::hal
