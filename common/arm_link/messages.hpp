// SPDX-License-Identifier: MIT
#pragma once
/// \file The generic arm protocol: messages of one fixed length between the host and a program on any make's
/// controller.
///
/// For people who write such a program: docs/other-arms.md has the tables.  128 bytes each, little-endian:
/// header of 16, body of 108, sum of 4.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"

namespace biteline::arm_link {

inline constexpr std::size_t k_message_bytes = 128, k_header_bytes = 16, k_sum_bytes = 4;
inline constexpr std::uint8_t k_version = 1;
inline constexpr std::uint16_t k_usual_port = 30400;       ///< of the host
inline constexpr std::uint16_t k_usual_pose_port = 30401;  ///< where states are heard and nothing is said
inline constexpr int k_joints = 6;
using Message = std::array<std::uint8_t, k_message_bytes>;
using Joints = Eigen::Matrix<double, k_joints, 1>;  ///< rad

/// Without a beat for so long a program that runs ends, its tool off.
inline constexpr Nanoseconds k_dead_man{500'000'000};
/// A path is gone to within so long after its upload, or not at all.
inline constexpr Nanoseconds k_path_age_max{10'000'000'000};
inline constexpr std::uint32_t k_most_points = 2000;

// From the host.
struct Hello {};
/// A path's beginning: it replaces whatever was uploaded before.
struct PathBegin {
  std::uint32_t path{0};  ///< its name: another one for each
  std::uint32_t points{0};
  SE3 T_flange_tcp{SE3::Identity()};
  double mass_kg{0};  ///< of tool and all; 0: as the controller has it
  Vec3 centre_flange_mm{Vec3::Zero()};
  std::int32_t output{-1};  ///< of the tool; -1: none
};
struct PathPoint {
  enum class Move : std::uint8_t { Joint = 0, Line = 1 };
  std::uint32_t path{0};
  std::uint32_t index{0};  ///< from 0
  Move move{Move::Line};
  bool tool_on{false};  ///< on the way to this point; where it changes the arm stands
  SE3 T_base_tcp{SE3::Identity()};
  Joints q_rad{Joints::Zero()};
  double speed{0};         ///< mm/s; Joint: rad/s
  double acceleration{0};  ///< mm/s^2; Joint: rad/s^2
  double blend_mm{0};      ///< rounded by so much; 0: the arm stops there
};
struct PathEnd {
  std::uint32_t path{0};
};
struct Go {
  std::uint32_t path{0};
  std::uint32_t sum{0};  ///< as the controller told it
};
struct Stop {};
struct Beat {};

// From the controller.
struct Robot {
  std::string make, model, serial;  ///< 24 letters at most
  std::uint32_t joints{0};
};
enum class Phase : std::uint8_t {
  Idle,     ///< stands, no path
  Loading,  ///< a path is coming in
  Ready,    ///< it is whole, and its sum told
  Running,  ///< on its way
  Stopped,  ///< ended before its end; `fault` says why
};
enum class Fault : std::uint16_t { None, Host, DeadMan, PeerGone, Safety, Motion };
struct State {
  std::uint64_t stamp_us{0};  ///< by the controller's clock
  SE3 T_base_tcp{SE3::Identity()};
  SE3 T_flange_tcp{SE3::Identity()};
  Joints q_rad{Joints::Zero()};
  Phase phase{Phase::Idle};
  bool powered{false};
  bool safe{false};          ///< no protective, safeguard or emergency stop
  std::uint8_t outputs{0};   ///< bits
  std::uint32_t path{0};     ///< 0: none
  std::uint16_t index{0};    ///< of the point that it came nearest to last
  Fault fault{Fault::None};  ///< of the path before, until the next one begins
  double speed_ratio{0};     ///< of the programmed speed
};
struct PathSum {
  std::uint32_t path{0};
  std::uint32_t points{0};
  std::uint32_t sum{0};  ///< of all bodies from PathBegin to the last point (Sum)
};
enum class Reason : std::uint16_t {
  None,
  Busy,         ///< a path runs, or another host is connected
  Order,        ///< a message that has no place now
  Points,       ///< a point is missing, twice, or too many
  WrongPath,    ///< another path's name or sum
  Stale,        ///< the path is too old
  NotReady,     ///< no power, or a safety stop
  Unreachable,  ///< the controller cannot do a move
};
struct Refusal {
  std::uint8_t of{0};  ///< the refused message's kind
  Reason reason{Reason::None};
};

using Body =
    std::variant<Hello, PathBegin, PathPoint, PathEnd, Go, Stop, Beat, Robot, State, PathSum, Refusal>;
struct Received {
  std::uint32_t number{0};  ///< the sender's count
  Body body;
};

[[nodiscard]] std::uint8_t kind_of(const Body& body);
[[nodiscard]] const char* name_of(Fault fault);
[[nodiscard]] const char* name_of(Reason reason);

/// Adler-32 (RFC 1950): adds and remainders only, which every controller's language has.
class Sum {
 public:
  void add(std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::uint32_t value() const { return high_ << 16U | low_; }

 private:
  std::uint32_t low_{1}, high_{0};
};
/// The part of a message that a path's sum is made of.
[[nodiscard]] std::span<const std::uint8_t> body_bytes(const Message& message);

[[nodiscard]] Message encode(std::uint32_t number, const Body& body);

/// Errc::ProtocolError: no such message, a version that is not ours, a sum that does not fit;
/// Errc::BadValue: numbers that nobody can mean.
[[nodiscard]] Result<Received> decode(const Message& message);

/// Cuts a stream into messages, and sees that their numbers go on by one.
class Reader {
 public:
  void add(std::span<const std::uint8_t> bytes) {
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  }
  /// The next whole message; nothing: none yet.  After an Error the stream is worth nothing any more.
  [[nodiscard]] Result<std::optional<Received>> next();
  /// The bytes of the last one.
  [[nodiscard]] const Message& last() const { return last_; }

 private:
  std::vector<std::uint8_t> waiting_;
  Message last_{};
  std::optional<std::uint32_t> number_;
};

}  // namespace biteline::arm_link
