// SPDX-License-Identifier: MIT
#pragma once
/// \file What a board has and where: boards/<board>/board.yaml as a struct.  Data only; nothing is opened
/// here.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/clocks.hpp"
#include "hal/api/gpio_line.hpp"

namespace biteline::hal {

/// "sim:NAME" in place of a line's chip, a timer's chip or a CAN interface: the simulated cell's wires of
/// that name.
inline constexpr std::string_view k_simulated_wires{"sim:"};

struct BoardCamera {
  enum class Kind { V4l2, GigE } kind{Kind::V4l2};
  // V4l2
  std::string device;
  std::string control_device;  ///< the sensor's sub-device; empty: the same as `device`
  std::optional<int> gain;
  std::optional<Nanoseconds> readout;  ///< end of exposure to the end of frame, from the data sheet
  // GigE
  std::string address;
  int packet_bytes{0};  ///< 0: what the camera has
  bool packet_socket{false};

  bool hardware_trigger{false};
  /// Strobe echo's edge to mid-exposure as the camera tells it, bounds; both 0: frames are not paired with
  /// edges.
  Nanoseconds edge_to_mid_min{0}, edge_to_mid_max{0};
};

/// A CANopen encoder (CiA 406).
struct BoardEncoder {
  std::string interface;
  std::uint8_t node{1};
  std::uint32_t range_ticks{0};  ///< object 6002h; 0: 32 bits
};

struct BoardTrigger {
  enum class Kind { None, HardwareTimer, Software, Encoder } kind{Kind::None};
  std::string chip;  ///< HardwareTimer
  int channel{0};
  GpioLineAddress line;  ///< Software, Encoder
  BoardEncoder encoder;  ///< Encoder: a pulse for each pitch
  std::int64_t pitch_ticks{0};
};

struct BoardLaser {
  GpioLineAddress enable;
  GpioLineAddress interlock;
  std::optional<GpioLineAddress> key;
  std::optional<GpioLineAddress>
      heartbeat;            ///< feeds the monostable before the laser; none: only its enable line's pull
  std::string temperature;  ///< a file of thousandths of a degree (thermal zone, hwmon); empty: none
  double temperature_max_degc{0};
  /// In place of all limits of the laser's guard, where no laser is: an emulated processor stands still for
  /// seconds.
  std::optional<Nanoseconds> patience;
};

struct BoardPoses {
  enum class Kind { Rtde, Can, Encoder, Egm, Rsi, ArmLink } kind{Kind::Rtde};
  std::string address;        ///< Rtde, Egm, Rsi, ArmLink: the controller's
  std::uint16_t port{30004};  ///< Rtde, ArmLink: the controller's; Egm, Rsi: ours, where it is heard
  double rate_hz{500};
  bool answers{true};     ///< Rsi: the controller waits for answers
  std::string interface;  ///< Can
  std::uint32_t base_id{0};
  BoardEncoder encoder;           ///< Encoder: the shoe moves, and its way is the pose
  Twist per_tick{Twist::Zero()};  ///< in base, [mm; rad]
};

struct BoardWatchdog {
  std::string device;  ///< empty: none
  bool systemd{true};
  Nanoseconds timeout{0};
};

struct Board {
  std::string name;
  bool simulated{false};  ///< what stands behind the devices is made: profiles say so
  BoardCamera camera;
  BoardTrigger trigger;
  std::optional<BoardLaser> laser;             ///< none: a board that drives no laser
  std::optional<GpioLineAddress> strobe_echo;  ///< the camera's "exposing" output
  std::optional<GpioLineAddress> scan_active;  ///< the robot's "on my way" output
  BoardPoses poses;
  std::string ptp;  ///< "/dev/ptp0"; empty: none
  BoardWatchdog watchdog;
};

/// Strict: every fault names file, key and line; an unknown key, also one of another kind's, is a fault.
[[nodiscard]] Result<Board> read_board_yaml(const std::filesystem::path& path);

}  // namespace biteline::hal
