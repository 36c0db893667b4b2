// SPDX-License-Identifier: MIT
#include "host/records/release/order.hpp"

#include <algorithm>
#include <limits>

#include "host/records/release/key_lines.hpp"

namespace biteline::release {
namespace {

constexpr std::string_view k_first = "biteline-switch 1\n";
constexpr std::int64_t k_most_number = std::numeric_limits<std::int32_t>::max();

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  while (true) {
    const std::size_t end = text.find(' ');
    words.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return words;
    text.remove_prefix(end + 1);
  }
}

/// Without a switch that is open; `number` is of the one in force, if that is known.
Plan at_rest(const Plan& settled) {
  Plan plan = settled;
  if (!settled.next.empty()) plan.number = 0;
  plan.next.clear();
  plan.at_ms = 0;
  plan.sure = false;
  return plan;
}

tl::unexpected<Error> refused(const Order& order, const char* why, std::int64_t known) {
  return fail(Errc::WrongState, "order of switch %lld: %s (switch %lld): none is made",
              static_cast<long long>(order.number), why, static_cast<long long>(known));
}

}  // namespace

bool Order::is_for(std::string_view cell) const {
  return std::ranges::find(cells, cell) != cells.end();
}

std::string to_text(const Order& order) {
  std::string text{k_first};
  text.append("number ").append(std::to_string(order.number));
  text.append("\nsha256 ").append(order.sha256);
  text.append("\nat_ms ").append(std::to_string(order.at_ms)).append("\ncells");
  for (const std::string& cell : order.cells) text.append(" ").append(cell);
  return text.append("\n");
}

Result<Order> read_order(std::string_view text) {
  if (text.size() > k_most_order_bytes || !text.starts_with(k_first))
    return fail(Errc::BadFormat, "order of a switch: 'biteline-switch 1' expected in its first line");
  KeyLines lines{text.substr(k_first.size()), "order of a switch"};
  Order order;
  order.number = lines.whole("number");
  order.sha256 = lines.value("sha256");
  order.at_ms = lines.whole("at_ms");
  order.cells = words_of(lines.value("cells"));
  if (order.number < 1 || order.number > k_most_number) lines.fault("number");
  if (!is_sha256(order.sha256)) lines.fault("sha256");
  if (!std::ranges::all_of(order.cells, is_release_name)) lines.fault("cells");
  BITELINE_TRY(lines.finish());
  return order;
}

Result<Plan> follow(const Plan& stands, const HeardOrder* heard, bool has, std::int64_t now_ms) {
  const Plan settled = stands.settled(now_ms);
  const Plan rest = at_rest(settled);
  const bool sure_one = !settled.next.empty() && settled.sure;
  if (heard == nullptr) return sure_one ? settled : rest;
  const Order& order = heard->order;
  const bool in_force = order.sha256 == rest.current;
  const bool same = order.number == settled.newest && heard->digest == settled.order;
  if (!same && order.number <= settled.newest) {
    // What is told after a switch was withdrawn: the one in force.
    if (!in_force) return refused(order, "a newer or another one is known here", settled.newest);
    Plan plan = sure_one ? settled : rest;
    if (!sure_one) plan.number = order.number;
    return plan;
  }
  if (sure_one) {
    if (same) return settled;
    return refused(order, "another one is sure and comes first", settled.number);
  }
  const bool open = same && settled.next == order.sha256;
  const bool past = order.at_ms <= now_ms;
  if (same && in_force && settled.next.empty()) {
    Plan plan = rest;
    plan.number = order.number;
    return plan;
  }
  // Every cell knew it before it was sure; only one that has nothing in force may hear of it first now.
  if (heard->sure && past && !open && !rest.current.empty())
    return refused(order, "first heard after its time", settled.number);
  if (!has) return rest;
  Plan plan = rest;
  plan.number = order.number;
  plan.newest = order.number;
  plan.order = heard->digest;
  if (!heard->sure || !past) {
    plan.next = order.sha256;
    plan.at_ms = order.at_ms;
    plan.sure = heard->sure;
  } else if (!in_force) {
    plan.before = plan.current;
    plan.current = order.sha256;
  }
  return plan;
}

}  // namespace biteline::release
