// SPDX-License-Identifier: MIT
#include "firmware/record/session_recorder.hpp"

#include <chrono>
#include <cstdio>
#include <string>
#include <utility>

#include "firmware/record/wanted.hpp"
#include "firmware/runtime/thread_table.hpp"

namespace biteline::record {
namespace {

namespace fs = std::filesystem;

/// Between two looks while nothing comes: half a frame at 100 Hz.
constexpr std::chrono::milliseconds k_look{5};

/// What a killed program may lose of an MCAP file.
constexpr std::chrono::seconds k_settle{1};

}  // namespace

Result<std::unique_ptr<SessionRecorder>> SessionRecorder::begin(Config config) {
  std::unique_ptr<SessionRecorder> recorder{new SessionRecorder{std::move(config)}};
  BITELINE_TRY(recorder->open_store());
  recorder->thread_ = std::thread{[self = recorder.get()] { self->run(); }};
  return recorder;
}

SessionRecorder::SessionRecorder(Config config)
    : config_{std::move(config)},
      tap_{std::make_shared<pipeline::RecordTap>(config_.model.region, config_.facts.pictures_every)} {}

SessionRecorder::~SessionRecorder() {
  wait();
}

Result<void> SessionRecorder::open_store() {
  const StoreConfig store{.path = config_.path, .model = config_.model, .settings = config_.settings};
  const auto open = is_mcap_name(config_.path) ? &open_mcap_file : &open_session_folder;
  BITELINE_ASSIGN(store_, open(store, config_.facts));
  return {};
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
  fs::remove_all(config_.path, ignored);
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
    settle();
    std::this_thread::sleep_for(k_look);
  }
  session::RecordingFacts& facts = config_.facts;
  facts.pictures_left_out = tap_->frames_left_out() + pictures_left_out_;
  facts.poses_left_out = tap_->poses_left_out() + poses_left_out_;
  facts.messages_left_out = messages_left_out_;
  facts.unrepeatable = unrepeatable_;
  facts.complete = whole_ && !failed_ && facts.unrepeatable == 0 &&
                   facts.pictures_left_out + facts.poses_left_out + facts.messages_left_out == 0;
  if (const Result<void> written = store_->finish(facts); !written && !failed_) end_for(written.error());
  if (!facts.complete) {
    std::fprintf(
        stderr,
        "biteline-sensor: %s: its pictures do not repeat the scan: left out %llu pictures, %llu poses, "
        "%llu messages; %llu profiles made otherwise%s\n",
        config_.path.c_str(), static_cast<unsigned long long>(facts.pictures_left_out),
        static_cast<unsigned long long>(facts.poses_left_out),
        static_cast<unsigned long long>(facts.messages_left_out),
        static_cast<unsigned long long>(facts.unrepeatable), whole_ ? "" : "; the scan has no end");
  }
  // A scan that never began, or has no end, is not the one that was asked for.
  if (config_.waits && whole_) {
    const std::shared_ptr<const SessionRecorder> before = config_.before.lock();
    while (before && !before->done()) std::this_thread::sleep_for(k_look);
    settle_wishes();
  }
  if (config_.keep_bytes != 0) {
    if (const std::size_t removed = make_room(config_.series, config_.keep_bytes); removed > 0) {
      std::fprintf(stderr, "biteline-sensor: %s: %zu older recordings made room\n", config_.series.c_str(),
                   removed);
    }
  }
  store_.reset();
  done_ = true;
}

void SessionRecorder::settle_wishes() {
  const Result<fs::path> kept = settle_wish(config_.path, config_.series);
  if (!kept) {
    std::fprintf(stderr, "biteline-sensor: the scan that was asked for waits on: %s\n",
                 to_line(kept.error()).c_str());
    return;
  }
  if (*kept != config_.path) std::fprintf(stderr, "biteline-sensor: %s: kept, as asked for\n", kept->c_str());
  // This one is held.
  make_room(waiting_name(config_.series), 0);
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
  poses_.clear();
  while (const std::optional<pipeline::RecordedPose> pose = tap_->rt_take_pose()) poses_.push_back(*pose);
  if (poses_.empty()) return false;
  BITELINE_TRY(store_->add_poses(poses_));
  config_.facts.poses += poses_.size();
  return true;
}

Result<bool> SessionRecorder::write_messages() {
  std::vector<wire::Bytes> messages;
  {
    const std::lock_guard lock{mutex_};
    messages.swap(waiting_);
    waiting_bytes_ = 0;
  }
  for (const wire::Bytes& message : messages) {
    BITELINE_TRY(store_->add_message(message));
    ++config_.facts.messages;
  }
  return !messages.empty();
}

Result<bool> SessionRecorder::write_picture() {
  const pipeline::RecordedFrame* frame = tap_->rt_take_frame();
  if (frame == nullptr) return false;
  // Tables have rising stamps; a frame that breaks this cannot be told from its neighbour.
  const bool in_order = frame->exposure_mid > last_picture_;
  Result<void> written;
  if (in_order) {
    const auto begin = std::chrono::steady_clock::now();
    const bool packed = pace_.packed(begin.time_since_epoch() - frame->exposure_mid.time_since_epoch());
    written = store_->add_picture(*frame, packed);
    pace_.note(packed, std::chrono::steady_clock::now() - begin);
  }
  last_picture_ = frame->exposure_mid;
  tap_->rt_give_back();
  if (in_order && written) {
    ++config_.facts.pictures;
  } else {
    ++pictures_left_out_;
  }
  if (!written) return tl::unexpected<Error>{written.error()};
  return true;
}

void SessionRecorder::settle() {
  const auto now = std::chrono::steady_clock::now();
  if (failed_ || now < settle_at_) return;
  settle_at_ = now + k_settle;
  if (const Result<void> settled = store_->settle(); !settled) end_for(settled.error());
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
