// SPDX-License-Identifier: MIT
#include "host/records/release/plan.hpp"

#include "common/system/file.hpp"
#include "host/records/release/key_lines.hpp"

namespace biteline::release {
namespace {

constexpr std::string_view k_first = "biteline-plan 2\n";
/// Of versions whose switches were not signed: the last two lines are missing.
constexpr std::string_view k_first_unsigned = "biteline-plan 1\n";

std::string_view or_dash(const std::string& hash) {
  return hash.empty() ? std::string_view{"-"} : std::string_view{hash};
}

}  // namespace

Plan Plan::settled(std::int64_t now_ms) const {
  Plan plan = *this;
  if (in_force(now_ms) == current) return plan;
  plan.before = current;
  plan.current = next;
  plan.next.clear();
  plan.at_ms = 0;
  plan.sure = false;
  return plan;
}

std::string to_text(const Plan& plan) {
  std::string text{k_first};
  text.append("current ").append(or_dash(plan.current));
  text.append("\nbefore ").append(or_dash(plan.before));
  text.append("\nnext ").append(or_dash(plan.next));
  text.append("\nat_ms ").append(std::to_string(plan.at_ms));
  text.append("\nsure ").append(plan.sure ? "1" : "0");
  text.append("\nnumber ").append(std::to_string(plan.number));
  text.append("\nnewest ").append(std::to_string(plan.newest));
  return text.append("\norder ").append(or_dash(plan.order)).append("\n");
}

Result<Plan> read_plan(std::string_view text) {
  const bool signed_orders = text.starts_with(k_first);
  if (!signed_orders && !text.starts_with(k_first_unsigned))
    return fail(Errc::BadFormat, "plan of releases: 'biteline-plan 2' expected in its first line");
  KeyLines lines{text.substr(k_first.size()), "plan of releases"};
  Plan plan;
  plan.current = lines.hash_if("current");
  plan.before = lines.hash_if("before");
  plan.next = lines.hash_if("next");
  plan.at_ms = lines.whole("at_ms");
  const std::int64_t sure = lines.whole("sure");
  plan.sure = sure == 1;
  plan.number = lines.whole("number");
  plan.newest = signed_orders ? lines.whole("newest") : plan.number;
  if (signed_orders) plan.order = lines.hash_if("order");
  if (sure > 1) lines.fault("sure");
  BITELINE_TRY(lines.finish());
  return plan;
}

Result<Plan> plan_of(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / k_plan_file;
  std::error_code error;
  if (std::filesystem::status(file, error).type() == std::filesystem::file_type::not_found) return Plan{};
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_settings_bytes));
  return read_plan(text);
}

}  // namespace biteline::release
