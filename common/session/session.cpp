// SPDX-License-Identifier: MIT
#include "common/session/session.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <limits>
#include <memory>

#include "common/config/sensor_yaml.hpp"
#include "common/csv/table.hpp"
#include "common/geometry/pose_track.hpp"

namespace biteline::session {
namespace {

namespace fs = std::filesystem;

// Printed with eight decimals a unit quaternion is off by 1e-8; 1e-3 catches a lost digit or a swapped field.
constexpr double k_unit_tolerance = 1e-3;

// 73 years either way: differences of two such stamps, and clock offsets on top, stay within 64 bits.
constexpr std::int64_t k_farthest_stamp_ns = std::int64_t{1} << 61;

Result<std::int64_t> read_stamp(const csv::Row& row, const fs::path& file) {
  BITELINE_ASSIGN(const std::int64_t stamp_ns, row.integer(0));
  if (stamp_ns < -k_farthest_stamp_ns || stamp_ns > k_farthest_stamp_ns) {
    return fail(Errc::BadValue, "%s row %d, field 1: a stamp within 73 years of the clock's zero expected",
                file.c_str(), row.number());
  }
  return stamp_ns;
}

Result<StampedPose> parse_pose(const csv::Row& row, const fs::path& file) {
  BITELINE_ASSIGN(const std::int64_t stamp_ns, read_stamp(row, file));
  double v[7];
  for (std::size_t i = 0; i < 7; ++i) {
    BITELINE_ASSIGN(v[i], row.number(i + 1));
  }
  const Eigen::Quaterniond rotation(v[3], v[4], v[5], v[6]);
  if (!(std::abs(rotation.norm() - 1) <= k_unit_tolerance)) {
    return fail(Errc::BadValue, "%s row %d, fields 5 to 8: a unit quaternion expected, found length %.4f",
                file.c_str(), row.number(), rotation.norm());
  }
  return StampedPose{.stamp = RobotClock::time_point{Nanoseconds{stamp_ns}},
                     .T_base_flange = geometry::make_se3(rotation, {v[0], v[1], v[2]})};
}

Result<std::vector<FrameEntry>> read_frame_table(const fs::path& file) {
  std::vector<FrameEntry> frames;
  const fs::path folder = file.parent_path() / "data";
  BITELINE_TRY(csv::read_table(file, 2, 2, [&](const csv::Row& row) -> Result<void> {
    BITELINE_ASSIGN(const std::int64_t stamp_ns, read_stamp(row, file));
    const FrameEntry frame{.exposure_mid = SensorClock::time_point{Nanoseconds{stamp_ns}},
                           .file = folder / row.text(1)};
    // A name with a folder in it could lead out of the session.
    if (fs::path{row.text(1)}.filename() != fs::path{row.text(1)} || row.text(1).empty()) {
      return fail(Errc::BadValue, "%s row %d, field 2: a plain file name expected", file.c_str(),
                  row.number());
    }
    if (!frames.empty() && frame.exposure_mid <= frames.back().exposure_mid) {
      return fail(Errc::BadValue, "%s row %d, field 1: rising stamps expected", file.c_str(), row.number());
    }
    std::error_code ignored;
    if (!fs::is_regular_file(frame.file, ignored)) {
      return fail(Errc::FileNotFound, "%s (named in %s row %d)", frame.file.c_str(), file.filename().c_str(),
                  row.number());
    }
    frames.push_back(frame);
    frames.back().sequence = frames.size() - 1;
    return {};
  }));
  if (frames.empty()) return fail(Errc::BadFormat, "%s: at least one frame expected", file.c_str());
  return frames;
}

/// Into the frames: what cam0/frames.csv tells of each.
Result<void> read_frame_facts(const fs::path& file, const geometry::Region& region,
                              std::vector<FrameEntry>& frames) {
  std::size_t index = 0;
  BITELINE_TRY(csv::read_table(file, 5, 5, [&](const csv::Row& row) -> Result<void> {
    // A recording that was cut may have a row more: it is written before the one of data.csv.
    if (index == frames.size()) return {};
    BITELINE_ASSIGN(const std::int64_t stamp_ns, read_stamp(row, file));
    if (frames[index].exposure_mid != SensorClock::time_point{Nanoseconds{stamp_ns}}) {
      return fail(Errc::BadValue, "%s row %d, field 1: the stamps of data.csv expected", file.c_str(),
                  row.number());
    }
    BITELINE_ASSIGN(const std::int64_t sequence, row.integer(1));
    BITELINE_ASSIGN(const std::int64_t flags, row.integer(2));
    BITELINE_ASSIGN(const std::int64_t first_row_px, row.integer(3));
    BITELINE_ASSIGN(const std::int64_t rows_px, row.integer(4));
    if (sequence < 0 || flags < 0 || flags > std::numeric_limits<std::uint32_t>::max()) {
      return fail(Errc::BadValue, "%s row %d, fields 2 and 3: numbers from 0 expected", file.c_str(),
                  row.number());
    }
    if (first_row_px < 0 || rows_px < 1 || first_row_px > region.height_px ||
        rows_px > region.height_px - first_row_px) {
      return fail(Errc::BadValue, "%s row %d, fields 4 and 5: rows of the %d of the region expected",
                  file.c_str(), row.number(), region.height_px);
    }
    FrameEntry& frame = frames[index++];
    frame.sequence = static_cast<std::uint64_t>(sequence);
    frame.flags = static_cast<std::uint32_t>(flags);
    frame.first_row_px = static_cast<int>(first_row_px);
    frame.rows_px = static_cast<int>(rows_px);
    return {};
  }));
  if (index == frames.size()) return {};
  return fail(Errc::Truncated, "%s: %zu rows expected, as in data.csv, found %zu", file.c_str(),
              frames.size(), index);
}

/// Into the poses: what pose0/encoder.csv tells of each.
Result<void> read_counts(const fs::path& file, std::vector<StampedPose>& poses) {
  std::vector<std::int64_t> stamps_ns;
  for (const StampedPose& pose : poses) stamps_ns.push_back(pose.stamp.time_since_epoch().count());
  BITELINE_ASSIGN(const auto counts, read_encoder_table(file, stamps_ns));
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].encoder_ticks = counts[i];
  return {};
}

Result<void> check_coverage(const Session& session) {
  const Nanoseconds offset = session.sensor.pose_clock_offset;
  const auto first_pose = to_sensor_clock(session.poses.front().stamp, offset);
  const auto last_pose = to_sensor_clock(session.poses.back().stamp, offset);
  int outside = 0;
  const FrameEntry* first_outside = nullptr;
  for (const FrameEntry& frame : session.frames) {
    if (frame.exposure_mid >= first_pose && frame.exposure_mid <= last_pose) continue;
    if (first_outside == nullptr) first_outside = &frame;
    ++outside;
  }
  if (outside == 0) return {};
  const auto early_ns = (first_pose - first_outside->exposure_mid).count();
  const auto late_ns = (first_outside->exposure_mid - last_pose).count();
  auto failure = fail(Errc::BadValue, "%s: poses do not cover frame %s (%.3f ms outside)",
                      (session.root / "pose0/data.csv").c_str(), first_outside->file.filename().c_str(),
                      static_cast<double>(std::max(early_ns, late_ns)) * 1e-6);
  failure.value().more_faults = outside - 1;
  return failure;
}

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

Result<void> write_rows(const fs::path& file, const std::string& text) {
  const std::unique_ptr<std::FILE, FileCloser> out{std::fopen(file.c_str(), "wb")};
  if (!out) return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  if (std::fwrite(text.data(), 1, text.size(), out.get()) != text.size() || std::fflush(out.get()) != 0) {
    return fail_errno(errno == ENOSPC ? Errc::DiskFull : Errc::WriteFailed, errno, "%s", file.c_str());
  }
  return {};
}

}  // namespace

Result<std::vector<StampedPose>> read_pose_table(const fs::path& file, RowOrder order) {
  std::vector<StampedPose> poses;
  BITELINE_TRY(csv::read_table(file, 8, 8, [&](const csv::Row& row) -> Result<void> {
    BITELINE_ASSIGN(const StampedPose pose, parse_pose(row, file));
    if (order == RowOrder::Rising && !poses.empty() && pose.stamp <= poses.back().stamp) {
      return fail(Errc::BadValue, "%s row %d, field 1: rising stamps expected", file.c_str(), row.number());
    }
    if (order == RowOrder::Any && std::any_of(poses.begin(), poses.end(),
                                              [&](const StampedPose& p) { return p.stamp == pose.stamp; })) {
      return fail(Errc::BadValue, "%s row %d, field 1: a number not yet used expected", file.c_str(),
                  row.number());
    }
    poses.push_back(pose);
    return {};
  }));
  if (poses.empty()) return fail(Errc::BadFormat, "%s: at least one pose expected", file.c_str());
  return poses;
}

Result<std::vector<std::optional<std::int64_t>>> read_encoder_table(
    const fs::path& file, std::span<const std::int64_t> pose_stamps_ns) {
  std::vector<std::optional<std::int64_t>> counts(pose_stamps_ns.size());
  std::size_t next = 0;
  BITELINE_TRY(csv::read_table(file, 2, 2, [&](const csv::Row& row) -> Result<void> {
    BITELINE_ASSIGN(const std::int64_t stamp_ns, read_stamp(row, file));
    BITELINE_ASSIGN(const std::int64_t ticks, row.integer(1));
    if (ticks < -geometry::k_most_ticks || ticks > geometry::k_most_ticks) {
      return fail(Errc::BadValue, "%s row %d, field 2: a count between -2^53 and 2^53 expected", file.c_str(),
                  row.number());
    }
    while (next < counts.size() && pose_stamps_ns[next] < stamp_ns) ++next;
    if (next == counts.size()) return {};
    if (pose_stamps_ns[next] != stamp_ns) {
      return fail(Errc::BadValue, "%s row %d, field 1: rising stamps of the poses of data.csv expected",
                  file.c_str(), row.number());
    }
    counts[next++] = ticks;
    return {};
  }));
  return counts;
}

Result<Session> read_session(const fs::path& root) {
  std::error_code ignored;
  if (!fs::is_directory(root, ignored))
    return fail(Errc::FileNotFound, "%s: a session folder expected", root.c_str());
  Session session{.root = root, .sensor = {}, .frames = {}, .poses = {}};
  BITELINE_ASSIGN(session.sensor, config::read_sensor_yaml(root / "cam0/sensor.yaml"));
  BITELINE_ASSIGN(session.frames, read_frame_table(root / "cam0/data.csv"));
  BITELINE_ASSIGN(session.poses, read_pose_table(root / "pose0/data.csv"));
  const fs::path facts = root / "recording.yaml", frame_facts = root / "cam0/frames.csv",
                 counts = root / "pose0/encoder.csv";
  if (fs::exists(counts, ignored)) {
    BITELINE_TRY(read_counts(counts, session.poses));
  }
  if (fs::exists(frame_facts, ignored)) {
    BITELINE_TRY(read_frame_facts(frame_facts, session.sensor.region, session.frames));
  }
  if (fs::exists(facts, ignored)) {
    BITELINE_ASSIGN(session.recorded, read_recording_facts(facts));
    return session;
  }
  BITELINE_TRY(check_coverage(session));
  return session;
}

Result<void> write_pose_table(const fs::path& file, const std::vector<StampedPose>& poses) {
  std::string text = k_pose_table_head;
  char line[256];
  for (const StampedPose& pose : poses) {
    const Vec3 p = pose.T_base_flange.translation();
    const Eigen::Quaterniond q(pose.T_base_flange.linear());
    std::snprintf(line, sizeof line, "%lld,%.6f,%.6f,%.6f,%.10f,%.10f,%.10f,%.10f\n",
                  static_cast<long long>(pose.stamp.time_since_epoch().count()), p.x(), p.y(), p.z(), q.w(),
                  q.x(), q.y(), q.z());
    text += line;
  }
  return write_rows(file, text);
}

std::string exact_pose_row(SensorClock::time_point stamp, Nanoseconds pose_clock_offset,
                           const Eigen::Quaterniond& rotation, const Vec3& translation_mm) {
  char line[320];
  std::snprintf(line, sizeof line, "%lld,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n",
                static_cast<long long>((stamp.time_since_epoch() + pose_clock_offset).count()),
                translation_mm.x(), translation_mm.y(), translation_mm.z(), rotation.w(), rotation.x(),
                rotation.y(), rotation.z());
  return line;
}

Result<void> write_frame_table(const fs::path& file, const std::vector<FrameEntry>& frames) {
  std::string text = k_frame_table_head;
  for (const FrameEntry& frame : frames) {
    text += std::to_string(frame.exposure_mid.time_since_epoch().count()) + "," +
            frame.file.filename().string() + "\n";
  }
  return write_rows(file, text);
}

}  // namespace biteline::session
