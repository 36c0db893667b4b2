// SPDX-License-Identifier: MIT
#include "host/fleet/release_keeper.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "host/records/digest/digest.hpp"
#include "host/report/report.hpp"

namespace biteline::fleet {
namespace {

namespace fs = std::filesystem;

/// A part that does not come is asked for again.
constexpr std::chrono::seconds k_patience{3};
/// What was wrong is not fetched again at once.
constexpr std::chrono::seconds k_before_retry{10};
/// After so many times only once an hour: it is large, and whoever made it must mend it.
constexpr int k_most_tries = 3;
constexpr std::chrono::hours k_before_late_retry{1};

std::int64_t size_of(const fs::path& file) {
  std::error_code error;
  const auto bytes = fs::file_size(file, error);
  return error ? 0 : static_cast<std::int64_t>(bytes);
}

Result<void> add_bytes(const fs::path& file, const std::string& bytes) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (fd < 0) return fail_errno(Errc::WriteFailed, errno, "%.200s", file.c_str());
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t now = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) break;
    done += static_cast<std::size_t>(now);
  }
  const int write_errno = done == bytes.size() ? 0 : errno;
  ::close(fd);
  if (write_errno == 0) return {};
  return fail_errno(write_errno == ENOSPC ? Errc::DiskFull : Errc::WriteFailed, write_errno, "%.200s",
                    file.c_str());
}

/// Of whoever's order; 0: it cannot be read.
std::int64_t number_of(const std::string& order_text) {
  const Result<release::Order> order = release::read_order(order_text);
  return order ? order->number : 0;
}

}  // namespace

ReleaseKeeper::ReleaseKeeper(fs::path folder, fs::path key, std::string cell, Ask ask)
    : shelf_{std::move(folder)}, key_{std::move(key)}, cell_{std::move(cell)}, ask_{std::move(ask)} {}

Result<void> ReleaseKeeper::begin() const {
  return report::prepare_folder(shelf_.folder());
}

Result<void> ReleaseKeeper::hear(const ReleasePlan& plan, Clock::time_point now, std::int64_t now_ms) {
  BITELINE_TRY(begin());
  const Result<void> wanted = want(plan, now);
  if (!wanted) fault_ = to_line(wanted.error());
  const Result<void> planned = plan_switch(plan, now_ms);
  order_fault_ = planned ? "" : to_line(planned.error());
  refused_ = planned || !plan.turn ? 0 : number_of(plan.turn->order);
  BITELINE_TRY(planned);
  return wanted;
}

Result<void> ReleaseKeeper::want(const ReleasePlan& plan, Clock::time_point now) {
  if (plan.manifest.empty()) {
    wanted_.reset();
    wanted_text_.clear();
    fault_.clear();
    return {};
  }
  if (plan.manifest == wanted_text_ && (wanted_ || now < not_before_)) return {};
  // What is being unpacked comes to its end first.
  if (busy()) return {};
  if (plan.manifest != wanted_text_) tries_ = 0;
  wanted_.reset();
  wanted_text_ = plan.manifest;
  not_before_ = now + k_before_retry;
  // Before anything is asked for: nothing that is not vouched for comes to this disk.
  BITELINE_TRY(release::check_signature(key_, plan.manifest, plan.signature, "the release"));
  BITELINE_ASSIGN(wanted_, release::read_manifest(plan.manifest));
  not_before_ = now;
  fault_.clear();
  coming_ = 0;
  // Goes on behind the last whole part.
  const fs::path part = shelf_.part_of(wanted_->sha256);
  have_ = size_of(part);
  if (have_ == static_cast<std::int64_t>(wanted_->bytes)) return {};
  have_ -= have_ % static_cast<std::int64_t>(k_part_bytes);
  std::error_code error;
  if (fs::exists(part, error)) fs::resize_file(part, static_cast<std::uintmax_t>(have_), error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", part.c_str());
  return {};
}

Result<release::HeardOrder> ReleaseKeeper::vouched(const ReleasePlan::Switch& turn) const {
  BITELINE_TRY(release::check_signature(key_, turn.order, turn.signature, "the order of a switch"));
  release::HeardOrder heard{.order = {}, .digest = Digest{}.add(turn.order).hex(), .sure = turn.sure};
  BITELINE_ASSIGN(heard.order, release::read_order(turn.order));
  if (!heard.order.is_for(cell_))
    return fail(Errc::WrongState, "the order of switch %lld is not for %s: none is made",
                static_cast<long long>(heard.order.number), cell_.c_str());
  return heard;
}

/// What is wrong changes nothing: neither what is in force nor a switch that is open.
Result<void> ReleaseKeeper::plan_switch(const ReleasePlan& plan, std::int64_t now_ms) {
  BITELINE_ASSIGN(const release::Plan stands, release::plan_of(shelf_.folder()));
  std::optional<release::HeardOrder> heard;
  if (plan.turn) {
    BITELINE_ASSIGN(heard, vouched(*plan.turn));
  }
  BITELINE_ASSIGN(
      const release::Plan next,
      release::follow(stands, heard ? &*heard : nullptr, heard && shelf_.has(heard->order.sha256), now_ms));
  if (next == stands) return {};
  BITELINE_TRY(shelf_.write(next));
  return shelf_.tidy(next, wanted_ ? wanted_->sha256 : "");
}

Result<bool> ReleaseKeeper::hear(const Part& part, Clock::time_point now) {
  if (!wanted_ || busy() || part.sha256 != wanted_->sha256 || part.at != have_ || shelf_.has(part.sha256))
    return false;
  Result<bool> whole = append(part);
  if (!whole) return tl::unexpected<Error>{give_up(whole.error(), now).error()};
  asked_ = now;
  if (--coming_ <= 0 && !*whole) ask(now);
  return whole;
}

Result<bool> ReleaseKeeper::append(const Part& part) {
  const auto bytes = static_cast<std::int64_t>(wanted_->bytes);
  if (part.bytes.empty() || have_ + static_cast<std::int64_t>(part.bytes.size()) > bytes)
    return fail(Errc::SizeMismatch, "release %.60s: more came than %lld bytes", wanted_->name.c_str(),
                static_cast<long long>(bytes));
  BITELINE_TRY(add_bytes(shelf_.part_of(part.sha256), part.bytes));
  have_ += static_cast<std::int64_t>(part.bytes.size());
  if (have_ < bytes) return false;
  take_in();
  return true;
}

void ReleaseKeeper::take_in() {
  // A gigabyte is hashed and unpacked for seconds: results do not wait for it.
  taking_ = std::async(std::launch::async,
                       [shelf = shelf_, manifest = *wanted_] { return shelf.take_in(manifest); });
}

Result<void> ReleaseKeeper::taken(Clock::time_point now) {
  const Result<void> done = taking_.get();
  if (!done) return give_up(done.error(), now);
  tries_ = 0;
  BITELINE_ASSIGN(const release::Plan plan, release::plan_of(shelf_.folder()));
  return shelf_.tidy(plan, wanted_ ? wanted_->sha256 : "");
}

/// What is wrong with it is looked at anew, from the first byte.
Result<void> ReleaseKeeper::give_up(const Error& error, Clock::time_point now) {
  ++tries_;
  fault_ = to_line(error);
  if (tries_ >= k_most_tries)
    fault_.append("; it came ").append(std::to_string(tries_)).append(" times and is tried once an hour");
  wanted_.reset();
  have_ = 0;
  not_before_ =
      now + (tries_ < k_most_tries ? Clock::duration{k_before_retry} : Clock::duration{k_before_late_retry});
  return tl::unexpected<Error>{error};
}

void ReleaseKeeper::ask(Clock::time_point now) {
  asked_ = now;
  coming_ = k_parts_at_once;
  ask_({.sha256 = wanted_->sha256, .at = have_});
}

Result<bool> ReleaseKeeper::look(Clock::time_point now, std::int64_t now_ms) {
  bool news = false;
  if (busy()) {
    if (taking_.wait_for(std::chrono::seconds{0}) != std::future_status::ready) return false;
    BITELINE_TRY(taken(now));
    news = true;
  } else if (wanted_ && !shelf_.has(wanted_->sha256)) {
    if (have_ >= static_cast<std::int64_t>(wanted_->bytes)) {
      take_in();  // killed between the last byte and the check
    } else if (coming_ <= 0 || now - asked_ > k_patience) {
      ask(now);
    }
  }
  BITELINE_ASSIGN(const release::Plan stands, release::plan_of(shelf_.folder()));
  const release::Plan settled = stands.settled(now_ms);
  if (settled == stands) return news;
  BITELINE_TRY(shelf_.write(settled));
  BITELINE_TRY(shelf_.tidy(settled, wanted_ ? wanted_->sha256 : ""));
  return true;
}

ReleaseWord ReleaseKeeper::word(std::int64_t now_ms) const {
  ReleaseWord word{.has = shelf_.hashes(),
                   .current = {},
                   .refused = refused_,
                   .fault = order_fault_ + (order_fault_.empty() || fault_.empty() ? "" : "; ") + fault_,
                   .clock_ms = now_ms};
  if (word.has.size() > 16) word.has.resize(16);
  if (const Result<release::Plan> plan = release::plan_of(shelf_.folder())) {
    word.current = plan->in_force(now_ms);
    word.number = plan->number;
    word.newest = plan->newest;
  } else {
    word.fault = to_line(plan.error());
  }
  return word;
}

}  // namespace biteline::fleet
