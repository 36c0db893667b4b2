// SPDX-License-Identifier: MIT
#include "host/fleet/sparkplug/line.hpp"

#include <charconv>

#include "common/system/file.hpp"
#include "host/report/report.hpp"

namespace biteline::fleet::sparkplug {
namespace {

constexpr std::chrono::milliseconds k_between_lines{1000};
constexpr std::size_t k_most_count_bytes = 16;

}  // namespace

Line::~Line() {
  if (broker_ && born_) broker_->publish(node_.topic("NDEATH"), node_.death(), Broker::Delivery::AtMostOnce);
}

std::uint8_t Line::last_line(const std::filesystem::path& count) {
  constexpr std::uint8_t k_none = 255;
  const Result<std::string> text = read_regular_file(count, k_most_count_bytes);
  std::uint8_t number = k_none;
  if (!text) return k_none;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), number);
  return error == std::errc{} ? number : k_none;
}

Result<void> Line::open() {
  tried_ = std::chrono::steady_clock::now();
  node_.begin_line();
  // Before the line begins: one that is killed meanwhile has used its number up.  Where it cannot be kept,
  // the line is worth more than its number.
  static_cast<void>(report::write_file_atomically(count_, std::to_string(int{node_.line()}) + "\n"));
  config_.subscriptions = {node_.topic("NCMD")};
  config_.will_topic = node_.topic("NDEATH");
  config_.will = node_.death();
  config_.will_kept = false;
  BITELINE_ASSIGN(broker_, Broker::open(
                               config_,
                               [this](std::string_view, std::string_view payload) {
                                 if (Node::asks_rebirth(payload)) be_born();
                               },
                               [this] { be_born(); }));
  return {};
}

void Line::be_born() {
  born_ = broker_->publish(node_.topic("NBIRTH"), node_.birth(state_, memory::now_ms()),
                           Broker::Delivery::AtMostOnce);
}

Result<void> Line::turn(std::chrono::milliseconds timeout) {
  if (!broker_) {
    if (std::chrono::steady_clock::now() - tried_ < k_between_lines) return {};
    BITELINE_TRY(open());
  }
  Result<void> turned = broker_->turn(timeout);
  if (!turned) {
    // Another line has another number, and so another will.
    broker_.reset();
    born_ = false;
  }
  return turned;
}

void Line::show(const CellState& state) {
  state_ = state;
  if (!born_ || !broker_ || !broker_->ready()) return;
  if (const std::optional<std::string> data = node_.data(state_, memory::now_ms()))
    broker_->publish(node_.topic("NDATA"), *data, Broker::Delivery::AtMostOnce);
}

}  // namespace biteline::fleet::sparkplug
