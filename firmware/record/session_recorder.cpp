// SPDX-License-Identifier: MIT
#include "firmware/record/session_recorder.hpp"

#include <chrono>
#include <cstdio>
#include <string>
#include <utility>

#include "common/config/sensor_yaml.hpp"
#include "common/session/session.hpp"
#include "common/wire/scan_file.hpp"
#include "firmware/runtime/thread_table.hpp"

namespace biteline::record {
namespace {

namespace fs = std::filesystem;

/// Between two looks while nothing comes: half a frame at 100 Hz.
constexpr std::chrono::milliseconds k_look{5};

std::string stamp_text(SensorClock::time_point stamp) {
  return std::to_string(stamp.time_since_epoch().count());
}

Result<void> make_folders(const fs::path& folder) {
  std::error_code error;
  const fs::path parent = folder.parent_path();
  if (!parent.empty()) fs::create_directories(parent, error);
  if (error || !fs::create_directory(folder, error)) {
    return fail_errno(Errc::WriteFailed, error ? error.value() : EEXIST, "%s", folder.c_str());
  }
  fs::create_directories(folder / "cam0/data", error);
  if (!error) fs::create_directory(folder / "pose0", error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", folder.c_str());
  return {};
}

Result<AppendFile> create_with(const fs::path& file, std::string_view head) {
  BITELINE_ASSIGN(AppendFile created, AppendFile::create(file));
  BITELINE_TRY(created.append(head));
  return created;
}

}  // namespace

fs::path free_session_folder(const fs::path& wanted) {
  std::error_code ignored;
  fs::path folder = wanted;
  for (int number = 2; fs::exists(folder, ignored); ++number) {
    folder = wanted.string() + "-" + std::to_string(number);
  }
  return folder;
}

Result<std::unique_ptr<SessionRecorder>> SessionRecorder::begin(Config config) {
  std::unique_ptr<SessionRecorder> recorder{new SessionRecorder{std::move(config)}};
  BITELINE_TRY(recorder->open_files());
  recorder->thread_ = std::thread{[self = recorder.get()] { self->run(); }};
  return recorder;
}

SessionRecorder::SessionRecorder(Config config)
    : config_{std::move(config)},
      tap_{std::make_shared<pipeline::RecordTap>(config_.model.region, config_.facts.pictures_every)} {}

SessionRecorder::~SessionRecorder() {
  wait();
}

Result<void> SessionRecorder::open_files() {
  const fs::path& folder = config_.folder;
  BITELINE_TRY(make_folders(folder));
  BITELINE_ASSIGN(held_, HeldFolder::hold(folder));
  BITELINE_ASSIGN([[maybe_unused]] const AppendFile head,
                  create_with(folder / "cam0/sensor.yaml",
                              config::sensor_yaml_text(config_.model, "as it scanned live")));
  if (!config_.settings.empty()) {
    BITELINE_ASSIGN([[maybe_unused]] const AppendFile settings,
                    create_with(folder / "settings.yaml", config_.settings));
  }
  BITELINE_ASSIGN(frames_, create_with(folder / "cam0/data.csv", session::k_frame_table_head));
  BITELINE_ASSIGN(frame_facts_, create_with(folder / "cam0/frames.csv", session::k_frame_facts_head));
  BITELINE_ASSIGN(poses_, create_with(folder / "pose0/data.csv", session::k_pose_table_head));
  BITELINE_ASSIGN(scan_, create_with(folder / "scan.btln", wire::k_scan_file_magic));
  return write_facts();
}

void SessionRecorder::keep_message(std::span<const std::uint8_t> message) {
  handing_over_.emplace_back(message.begin(), message.end());
  const std::unique_lock lock{mutex_, std::try_to_lock};
  if (!lock) return;
  for (wire::Bytes& one : handing_over_) {
    if (waiting_bytes_ + one.size() > k_most_waiting_bytes) {
      messages_left_out_.fetch_add(1);
      continue;
    }
    waiting_bytes_ += one.size();
    waiting_.push_back(std::move(one));
  }
  handing_over_.clear();
}

void SessionRecorder::request_finish(std::uint64_t unrepeatable) {
  unrepeatable_ = unrepeatable;
  end(true);
}

void SessionRecorder::discard() {
  wait();
  std::error_code ignored;
  fs::remove_all(config_.folder, ignored);
}

void SessionRecorder::end(bool whole) {
  if (finishing_) return;
  {
    const std::lock_guard lock{mutex_};
    for (wire::Bytes& one : handing_over_) waiting_.push_back(std::move(one));
    handing_over_.clear();
  }
  whole_ = whole;
  finishing_ = true;
}

void SessionRecorder::wait() {
  end(false);
  if (thread_.joinable()) thread_.join();
}

void SessionRecorder::run() {
  if (const Result<void> entered = runtime::enter_thread(runtime::threads::k_record, config_.realtime);
      !entered) {
    end_for(entered.error());
  }
  for (;;) {
    // In this order: what was handed over before finishing_ was set is seen below.
    const bool last = finishing_;
    while (write_waiting()) {
    }
    if (last) break;
    std::this_thread::sleep_for(k_look);
  }
  session::RecordingFacts& facts = config_.facts;
  facts.pictures_left_out = tap_->frames_left_out() + pictures_left_out_;
  facts.poses_left_out = tap_->poses_left_out() + poses_left_out_;
  facts.messages_left_out = messages_left_out_;
  facts.unrepeatable = unrepeatable_;
  facts.complete = whole_ && !failed_ && facts.unrepeatable == 0 &&
                   facts.pictures_left_out + facts.poses_left_out + facts.messages_left_out == 0;
  if (const Result<void> written = write_facts(); !written && !failed_) end_for(written.error());
  if (!facts.complete) {
    std::fprintf(
        stderr,
        "biteline-sensor: %s: its pictures do not repeat the scan: left out %llu pictures, %llu poses, "
        "%llu messages; %llu profiles made otherwise%s\n",
        config_.folder.c_str(), static_cast<unsigned long long>(facts.pictures_left_out),
        static_cast<unsigned long long>(facts.poses_left_out),
        static_cast<unsigned long long>(facts.messages_left_out),
        static_cast<unsigned long long>(facts.unrepeatable), whole_ ? "" : "; the scan has no end");
  }
  if (config_.keep_bytes != 0) {
    if (const std::size_t removed = make_room(config_.series, config_.keep_bytes); removed > 0) {
      std::fprintf(stderr, "biteline-sensor: %s: %zu older recordings made room\n", config_.series.c_str(),
                   removed);
    }
  }
  held_.reset();
  done_ = true;
}

bool SessionRecorder::write_waiting() {
  if (failed_) {
    drop_waiting();
    return false;
  }
  // Small things before pictures: a disk that is too slow costs pictures only.
  bool worked = false;
  for (const auto write :
       {&SessionRecorder::write_poses, &SessionRecorder::write_messages, &SessionRecorder::write_picture}) {
    const Result<bool> wrote = (this->*write)();
    if (!wrote) {
      end_for(wrote.error());
      return false;
    }
    worked = worked || *wrote;
  }
  return worked;
}

Result<bool> SessionRecorder::write_poses() {
  std::string rows;
  std::uint64_t count = 0;
  while (const std::optional<pipeline::RecordedPose> pose = tap_->rt_take_pose()) {
    rows += session::exact_pose_row(pose->stamp, config_.model.pose_clock_offset, pose->rotation,
                                    pose->translation_mm);
    ++count;
  }
  if (count == 0) return false;
  BITELINE_TRY(poses_->append(rows));
  config_.facts.poses += count;
  return true;
}

Result<bool> SessionRecorder::write_messages() {
  std::vector<wire::Bytes> messages;
  {
    const std::lock_guard lock{mutex_};
    messages.swap(waiting_);
    waiting_bytes_ = 0;
  }
  wire::Bytes record;
  for (const wire::Bytes& message : messages) {
    wire::make_scan_record(message, record);
    BITELINE_TRY(scan_->append(record));
    ++config_.facts.messages;
  }
  return !messages.empty();
}

Result<bool> SessionRecorder::write_picture() {
  const pipeline::RecordedFrame* frame = tap_->rt_take_frame();
  if (frame == nullptr) return false;
  const std::string stamp = stamp_text(frame->exposure_mid);
  const fs::path file = config_.folder / "cam0/data" / (stamp + ".png");
  const auto size = static_cast<std::ptrdiff_t>(frame->width_px) * frame->height_px;
  Result<void> written;
  // Tables have rising stamps; a frame that breaks this cannot be told from its neighbour.
  const bool in_order = frame->exposure_mid > last_picture_;
  if (in_order) {
    picture_.width_px = frame->width_px;
    picture_.height_px = frame->height_px;
    picture_.pixels.assign(frame->pixels.begin(), frame->pixels.begin() + size);
    written = image::write_png(file, picture_);
  }
  // The facts first: a cut between the two leaves a row too many, which a reader passes over.
  if (in_order && written) {
    written = frame_facts_->append(stamp + ',' + std::to_string(frame->sequence) + ',' +
                                   std::to_string(frame->flags) + ',' + std::to_string(frame->first_row_px) +
                                   ',' + std::to_string(frame->height_px) + '\n');
  }
  if (in_order && written) written = frames_->append(stamp + ',' + stamp + ".png\n");
  last_picture_ = frame->exposure_mid;
  tap_->rt_give_back();
  if (!written) {
    ++pictures_left_out_;
    std::error_code ignored;
    fs::remove(file, ignored);
    return tl::unexpected<Error>{written.error()};
  }
  if (in_order) {
    ++config_.facts.pictures;
  } else {
    ++pictures_left_out_;
  }
  return true;
}

Result<void> SessionRecorder::write_facts() {
  const fs::path file = config_.folder / "recording.yaml", beside = config_.folder / "recording.yaml.new";
  std::error_code error;
  fs::remove(beside, error);
  {
    BITELINE_ASSIGN([[maybe_unused]] const AppendFile facts,
                    create_with(beside, session::recording_facts_text(config_.facts)));
  }
  fs::rename(beside, file, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", file.c_str());
  return {};
}

void SessionRecorder::end_for(const Error& fault) {
  failed_ = true;
  tap_->close();
  config_.facts.fault = to_line(fault);
  std::fprintf(stderr, "biteline-sensor: the recording ends, the scan goes on: %s\n",
               config_.facts.fault.c_str());
}

void SessionRecorder::drop_waiting() {
  while (tap_->rt_take_frame() != nullptr) {
    tap_->rt_give_back();
    ++pictures_left_out_;
  }
  while (tap_->rt_take_pose()) ++poses_left_out_;
  const std::lock_guard lock{mutex_};
  messages_left_out_.fetch_add(waiting_.size());
  waiting_.clear();
  waiting_bytes_ = 0;
}

}  // namespace biteline::record
