// SPDX-License-Identifier: MIT
#include "host/records/recording/import.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "common/config/sensor_yaml.hpp"
#include "common/mcap/reader.hpp"
#include "common/recording/layout.hpp"
#include "common/recording/picture.hpp"
#include "common/recording/rows.hpp"
#include "common/session/session.hpp"
#include "common/wire/scan_file.hpp"

namespace biteline::recording {
namespace {

namespace fs = std::filesystem;

std::string_view text_of(mcap::View bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A file that grows.
class Output {
 public:
  static Result<Output> create(const fs::path& file) {
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    std::FILE* const out = error ? nullptr : std::fopen(file.c_str(), "wbx");
    if (out == nullptr)
      return fail_errno(Errc::WriteFailed, error ? error.value() : errno, "%s", file.c_str());
    return Output{file, out};
  }
  Result<void> add(std::string_view bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size()) return {};
    return failed();
  }
  Result<void> close() { return std::fclose(file_.release()) == 0 ? Result<void>{} : failed(); }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  Output(fs::path name, std::FILE* file) : name_{std::move(name)}, file_{file} {}
  [[nodiscard]] Result<void> failed() const {
    return fail_errno(errno == ENOSPC ? Errc::DiskFull : Errc::WriteFailed, errno, "%s", name_.c_str());
  }
  fs::path name_;
  std::unique_ptr<std::FILE, Closer> file_;
};

Result<void> write_whole(const fs::path& file, std::string_view bytes) {
  BITELINE_ASSIGN(Output out, Output::create(file));
  BITELINE_TRY(out.add(bytes));
  return out.close();
}

class Import {
 public:
  explicit Import(fs::path folder) : folder_{std::move(folder)} {}

  Result<Imported> run(const fs::path& file) {
    BITELINE_ASSIGN(
        const mcap::FileEnd end,
        mcap::read_messages(
            file,
            {.on_message = [this](const mcap::Channel& channel, const mcap::Schema*,
                                  const mcap::Message& message) { return take(channel.topic, message.data); },
             .on_attachment = [this](const mcap::Attachment& attachment) { return take_file(attachment); },
             .on_metadata = {}}));
    imported_.lacks = end.damage.empty() ? "" : "byte " + std::to_string(end.good_bytes) + ": " + end.damage;
    if (imported_.pictures + imported_.messages == 0) {
      return fail(Errc::BadFormat, "%s: no pictures on %s and no scan on %s%s%.80s", file.c_str(),
                  topic::k_picture, topic::k_scan, imported_.lacks.empty() ? "" : "; ",
                  imported_.lacks.c_str());
    }
    if (poses_) BITELINE_TRY(poses_->close());
    if (counts_) BITELINE_TRY(counts_->close());
    if (scan_) BITELINE_TRY(scan_->close());
    if (imported_.pictures > 0) BITELINE_TRY(write_frames());
    if (!imported_.lacks.empty()) BITELINE_TRY(mark_incomplete());
    return std::move(imported_);
  }

 private:
  Result<void> take(const std::string& on, mcap::View data) {
    if (on == topic::k_pose) return take_pose(data);
    if (on == topic::k_scan) return take_scan(data);
    if (on == topic::k_picture) return take_picture(data);
    if (on == topic::k_frame) {
      BITELINE_ASSIGN(row_, frame_row_of(data));
      return {};
    }
    if (on != topic::k_event && on != topic::k_ros_pose && on != topic::k_ros_points) ++imported_.strange;
    return {};
  }

  Result<void> take_pose(mcap::View data) {
    BITELINE_ASSIGN(const PoseRow row, pose_row_of(data));
    if (!poses_) {
      BITELINE_ASSIGN(poses_, Output::create(folder_ / "pose0/data.csv"));
      BITELINE_TRY(poses_->add(session::k_pose_table_head));
    }
    last_pose_ns_ = imported_.poses++ == 0 ? row.stamp_ns : std::max(last_pose_ns_, row.stamp_ns);
    if (row.encoder_ticks) {
      if (!counts_) {
        BITELINE_ASSIGN(counts_, Output::create(folder_ / "pose0/encoder.csv"));
        BITELINE_TRY(counts_->add(session::k_encoder_table_head));
      }
      BITELINE_TRY(
          counts_->add(std::to_string(row.stamp_ns) + ',' + std::to_string(*row.encoder_ticks) + '\n'));
    }
    return poses_->add(table_row(row));
  }

  Result<void> take_scan(mcap::View data) {
    if (!scan_) {
      BITELINE_ASSIGN(scan_, Output::create(folder_ / "scan.btln"));
      BITELINE_TRY(scan_->add(wire::k_scan_file_magic));
    }
    if (data.size() > wire::k_max_message_bytes)
      return fail(Errc::BadValue, "a message that no sensor sends");
    ++imported_.messages;
    wire::make_scan_record(data, record_);
    return scan_->add(text_of(record_));
  }

  Result<void> take_picture(mcap::View data) {
    if (!row_) return fail(Errc::BadFormat, "a picture without its row on %s", topic::k_frame);
    BITELINE_ASSIGN(const mcap::View file, picture_file_of(data));
    BITELINE_TRY(write_whole(folder_ / "cam0/data" / row_->file, text_of(file)));
    frames_.push_back(std::move(*row_));
    row_.reset();
    ++imported_.pictures;
    return {};
  }

  Result<void> take_file(const mcap::Attachment& attachment) {
    const auto kept = std::ranges::find(k_kept_files, attachment.name, &KeptFile::name);
    if (kept == k_kept_files.end()) {
      ++imported_.strange;
      return {};
    }
    // A live recording's facts come at its begin, and again at its end.
    const fs::path file = folder_ / kept->name;
    std::error_code ignored;
    if (!fs::remove(file, ignored)) ++imported_.files;
    return write_whole(file, text_of(attachment.data));
  }

  Result<void> write_frames() {
    // Of a cut file the last pictures may lack the pose behind them.
    if (!imported_.lacks.empty() && imported_.poses > 0) {
      BITELINE_ASSIGN(const geometry::SensorModel sensor,
                      config::read_sensor_yaml(folder_ / "cam0/sensor.yaml"));
      const std::int64_t last_ns = last_pose_ns_ - sensor.pose_clock_offset.count();
      while (!frames_.empty() && frames_.back().stamp_ns > last_ns) {
        std::error_code ignored;
        fs::remove(folder_ / "cam0/data" / frames_.back().file, ignored);
        frames_.pop_back();
        --imported_.pictures;
        ++imported_.pictures_without_pose;
      }
    }
    std::string names = session::k_frame_table_head, facts = session::k_frame_facts_head;
    const bool with_facts =
        std::ranges::any_of(frames_, [](const FrameRow& row) { return row.facts.has_value(); });
    for (const FrameRow& row : frames_) {
      const std::string stamp = std::to_string(row.stamp_ns);
      names.append(stamp).append(",").append(row.file).append("\n");
      const FrameRow::Facts f = row.facts.value_or(FrameRow::Facts{});
      facts.append(stamp);
      for (const std::uint64_t value :
           {f.sequence, std::uint64_t{f.flags}, static_cast<std::uint64_t>(f.first_row_px),
            static_cast<std::uint64_t>(f.rows_px)})
        facts.append(",").append(std::to_string(value));
      facts.append("\n");
    }
    BITELINE_TRY(write_whole(folder_ / "cam0/data.csv", names));
    return with_facts ? write_whole(folder_ / "cam0/frames.csv", facts) : Result<void>{};
  }

  Result<void> mark_incomplete() {
    const fs::path file = folder_ / "recording.yaml";
    std::error_code error;
    if (!fs::exists(file, error)) return {};
    BITELINE_ASSIGN(session::RecordingFacts facts, session::read_recording_facts(file));
    facts.complete = false;
    facts.pictures = imported_.pictures;
    facts.poses = imported_.poses;
    facts.messages = imported_.messages;
    facts.fault = "its MCAP file is cut or damaged: " + imported_.lacks;
    fs::remove(file, error);
    return write_whole(file, session::recording_facts_text(facts));
  }

  fs::path folder_;
  Imported imported_;
  std::optional<Output> poses_, counts_, scan_;
  std::int64_t last_pose_ns_{0};
  std::optional<FrameRow> row_;
  std::vector<FrameRow> frames_;
  wire::Bytes record_;
};

}  // namespace

Result<Imported> import_mcap(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error)) {
    return fail(Errc::WriteFailed, "%s exists; nothing is overwritten", folder.c_str());
  }
  const fs::path beside = folder.string() + ".new";
  fs::remove_all(beside, error);
  fs::create_directories(beside, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", beside.c_str());
  Result<Imported> imported = Import{beside}.run(file);
  if (imported) {
    fs::rename(beside, folder, error);
    if (!error) return imported;
    imported = fail_errno(Errc::WriteFailed, error.value(), "%s", folder.c_str());
  }
  fs::remove_all(beside, error);
  return imported;
}

bool is_mcap(const fs::path& file) {
  std::error_code ignored;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in{
      fs::is_regular_file(file, ignored) ? std::fopen(file.c_str(), "rb") : nullptr, &std::fclose};
  std::array<std::uint8_t, mcap::k_magic.size()> magic{};
  return in && std::fread(magic.data(), 1, magic.size(), in.get()) == magic.size() && magic == mcap::k_magic;
}

}  // namespace biteline::recording
