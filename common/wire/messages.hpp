// SPDX-License-Identifier: MIT
#pragma once
/// \file The messages between sensor and host as plain structs, and their bytes (PROTOCOL.md).

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/profile/counts.hpp"
#include "common/profile/profile.hpp"

namespace biteline::wire {

/// Raised, with the reason in PROTOCOL.md, whenever an old peer would misread a message.
inline constexpr std::uint16_t k_protocol = 1;
/// Raised, with the reason in PROTOCOL.md, when something is added that an old peer may do without.
inline constexpr std::uint16_t k_protocol_minor = 6;

/// No message is longer; sockets drop what is.  A full profile (5184 points) packs to at most 222 KB.
inline constexpr std::size_t k_max_message_bytes = 512 * 1024;

/// A settings file is never longer.
inline constexpr std::size_t k_max_settings_bytes = 8 * 1024;

using Bytes = std::vector<std::uint8_t>;

/// Host to sensor, first on every connection and again whenever the host doubts it.
struct HostHello {
  std::string name;
  bool resume{false};               ///< false: from the oldest message still held
  std::uint64_t resume_scan_id{0};  ///< the scan that the host holds the beginning of
  std::uint64_t next_sequence{0};   ///< first message it lacks: sent from there on
  std::uint64_t safe_sequence{0};   ///< everything below is safe with it, as in Ack
};

/// The sensor's answer.
struct SensorHello {
  std::string name;
  std::string version;
  std::string scan_name;
  std::uint64_t frames_expected{0};  ///< 0: not known
  bool lossless{false};              ///< the source waits for the host
  bool simulated{false};
  bool scanning{false};        ///< the scan goes on; false: it has ended, or there was none yet (scan 0)
  std::uint64_t held_from{0};  ///< oldest message still held
  std::uint64_t held_to{0};    ///< one past the newest
  geometry::SensorModel model;
  std::uint16_t protocol_minor{k_protocol_minor};  ///< 0: a sensor that knows no observers
  bool test_pattern{false};                        ///< the scan shows made pictures: it is nobody's shoe
  geometry::CameraState camera_state{};            ///< as the camera told it when the scan began
};

struct StageTime {
  std::string name;
  std::uint64_t count{0};
  Nanoseconds min{0}, mean{0}, max{0};
};

using Counters = profile::ScanCounts;

/// How another device's clock lies on the sensor's.
struct ClockState {
  std::string name;
  bool known{false};
  Nanoseconds offset{0};  ///< sensor clock minus the other
  Nanoseconds uncertainty{0};
  double drift_ppm{0};
  std::uint64_t steps{0};
};

using TriggerState = profile::TriggerCounts;

/// Of a camera whose exposure or rows change while it runs.
struct CaptureState {
  Nanoseconds exposure{0};
  std::uint64_t exposure_changes{0};
  int first_row_px{0};  ///< of the head's region
  int rows_px{0};
  std::uint64_t row_changes{0};
  double rate_max_hz{0};  ///< that these rows' read-out allows; 0: rows are not followed
  bool searching{false};  ///< stripe lost, all rows shown
};

/// The state of what hangs on the sensor, beyond the scan's counts.
struct Devices : profile::DeviceCounts {
  std::vector<ClockState> clocks;
  std::optional<TriggerState> trigger;  ///< nothing: no strobe echo ties frames to edges
  bool trigger_by_software{false};
  bool camera_connected{false};
  std::optional<float> temperature_degc;
  bool poses_flow{false};
  bool realtime{false};                 ///< the thread table was enforced
  std::optional<CaptureState> capture;  ///< nothing: the head's own settings stand
};

enum class LaserState : std::uint8_t { Off, On, Fault };

/// What the sensor runs with now.
struct SettingsState {
  std::string text;          ///< a whole settings file, as `--settings` takes it
  double rate_max_hz{0};     ///< that region and exposure allow; 0: the camera does not tell
  std::uint32_t changes{0};  ///< sets of hosts taken since the sensor started
};

/// What the unit has been through since it was first started, this start included.
struct UpkeepState {
  std::uint64_t starts{0};     ///< of the sensor program
  std::uint64_t boots{0};      ///< of the machine
  double run_s{0};             ///< the program ran
  double laser_s{0};           ///< the laser was on
  std::uint64_t lightings{0};  ///< the laser went on
  std::uint64_t frames{0};
  std::optional<float> coldest_degc, hottest_degc;  ///< of the head; both or none
};

/// A few times a second; the newest replaces the older.
struct Health {
  Counters counters;
  std::vector<StageTime> stages;
  LaserState laser{LaserState::Off};
  std::string laser_reason;
  bool scanning{false};
  Devices devices;
  std::uint32_t observers{0};               ///< connected now
  std::uint64_t pictures{0};                ///< made for observers since the sensor started
  std::optional<SettingsState> settings{};  ///< nothing: a recording, or a sensor of 1.1
  std::optional<UpkeepState> upkeep{};      ///< nothing: not counted, or a sensor of 1.2
};

/// The scan's last message, in sequence with its profiles.
struct EndOfScan {
  std::uint16_t errc{0};  ///< 0: complete; otherwise the Errc that ended it
  std::string where;
  Counters counters;
  std::vector<StageTime> stages;
  Devices devices;
};

/// Host to sensor: everything below is safe with the host.
struct Ack {
  std::uint64_t safe_sequence{0};
};

/// KeepLast, KeepNext: the recording of the scan that waits, or of the one that ends next; a sensor of 1.2
/// does not answer them.
enum class Command : std::uint8_t { StartScan, StopScan, LaserOff, UseSettings, KeepLast, KeepNext };
/// Of KeepLast and KeepNext.
inline constexpr std::uint16_t k_least_minor_to_keep = 3;

struct Control {
  std::uint32_t id{0};
  Command command{Command::StopScan};
  std::string settings{};  ///< of UseSettings: a whole settings file
};

struct ControlReply {
  std::uint32_t id{0};
  std::uint16_t errc{0};  ///< 0: done
  std::string where;      ///< done: what was kept, of KeepLast and KeepNext
};

/// These messages are gone for good.
struct Gap {
  std::uint64_t first{0};
  std::uint64_t count{0};
};

enum class ByeReason : std::uint8_t { Stopping, VersionMismatch, Refused };

struct Bye {
  ByeReason reason{ByeReason::Stopping};
  std::string text;
  std::uint16_t protocol{k_protocol};  ///< the sender's
};

enum class PictureFormat : std::uint8_t { Jpeg, Raw };

/// More are not given, whatever is asked for.
inline constexpr double k_max_picture_rate_hz = 25;

/// What an observer wants to see of the camera.
struct PictureWish {
  double rate_hz{0};      ///< at most so many a second; 0: none
  int width_max_px{640};  ///< scaled down by a whole number until it is not wider
  PictureFormat format{PictureFormat::Jpeg};
  int quality{75};            ///< of JPEG, 1 to 100
  geometry::Region region{};  ///< pixels of the full sensor; empty: all that the camera shows

  [[nodiscard]] bool operator==(const PictureWish& other) const;
};

/// Observer to sensor: first on every connection, at least once a second, and after each profile or picture.
struct ObserverHello {
  std::string name;
  double profile_rate_hz{0};  ///< at most so many profiles a second, the newest; 0: none
  PictureWish picture;
  std::uint64_t received{0};  ///< profiles and pictures that it took since it began
};

/// One found peak, in pixels of the full sensor.
struct PicturePeak {
  std::uint16_t u_px{0};
  float v_px{0};           ///< sub-pixel row
  std::uint16_t flags{0};  ///< profile::PointFlag
};

/// A frame as the camera saw it, with the peaks that were found in it.
struct Picture {
  std::uint64_t frame_sequence{0};    ///< as in ProfileHeader
  std::uint64_t profile_sequence{0};  ///< the profile that this frame completed
  SensorClock::time_point exposure_mid;
  geometry::Region region;  ///< pixels of the full sensor that it shows
  int step{1};              ///< one picture pixel is the mean of step x step of them
  PictureFormat format{PictureFormat::Jpeg};
  std::vector<std::uint8_t> pixels;  ///< one JPEG file, or width_px() * height_px() bytes, row by row
  std::vector<PicturePeak> peaks;    ///< by column, then row; of the whole profile

  [[nodiscard]] int width_px() const { return region.width_px / step; }
  [[nodiscard]] int height_px() const { return region.height_px / step; }
  /// Where a pixel of the sensor lies in the picture; whole numbers are the centres of the picture's pixels.
  [[nodiscard]] double x_of(double u_px) const { return (u_px - region.offset_u_px + 0.5) / step - 0.5; }
  [[nodiscard]] double y_of(double v_px) const { return (v_px - region.offset_v_px + 0.5) / step - 0.5; }
};

using Body = std::variant<HostHello, SensorHello, profile::Profile, Health, EndOfScan, Ack, Control,
                          ControlReply, Gap, Bye, ObserverHello, Picture>;

struct Message {
  std::uint16_t protocol{k_protocol};
  std::uint64_t scan_id{0};
  std::uint64_t sequence{0};  ///< of profiles and EndOfScan only
  Body body;
};

/// Verified and checked: structure (FlatBuffers verifier), sizes, enumerators, finite numbers, rotations. The
/// bytes may come from anyone.  Errc::ProtocolError; a message of another protocol version is
/// Errc::NotSupported.
[[nodiscard]] Result<Message> decode(std::span<const std::uint8_t> bytes);

/// Replaces `out`.  Texts are cut at 500 bytes.  For a profile see also encode_profile().
void encode(const Message& message, Bytes& out);

struct ProfileAddress {
  std::uint64_t scan_id{0};
  std::uint64_t sequence{0};
};

/// As encode() without an intermediate copy of the points: the firmware's way.
void encode_profile(ProfileAddress address, const profile::ProfileHeader& header,
                    std::span<const profile::ProfilePoint> points, Bytes& out);

}  // namespace biteline::wire
