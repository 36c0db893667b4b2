// SPDX-License-Identifier: MIT
// What the next shoe is worked with, and whose word that is: one answer for page, row, path and arm.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/apps/biteline-host/part.hpp"
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"
#include "host/transfer/models.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* k_order_key = "next_scans";
/// Files and releases may change while nothing is in work.
constexpr Nanoseconds k_between_orders{2'000'000'000};

std::string field_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string{};
}

bool says_nothing(const api::Job& job) {
  return job.model.empty() && job.process.empty() && job.foot.empty() && job.size.empty() && job.part.empty();
}

/// "the process grind, the model boot", as far as they were said.
std::string words_of(const api::Job& job) {
  std::string words;
  for (const auto& [what, text] :
       {std::pair{"the process ", &job.process}, std::pair{"the model ", &job.model},
        std::pair{"the foot ", &job.foot}, std::pair{"the size ", &job.size},
        std::pair{"the part number ", &job.part}})
    if (!text->empty()) words += (words.empty() ? "" : ", ") + (what + *text);
  return words;
}

}  // namespace

Service::Ordered Service::ordered() const {
  const std::lock_guard lock{*job_mutex_};
  return ordered_;
}

void Service::order(Ordered ordered) {
  const std::string process = ordered.job.process, who = ordered.who;
  const bool nothing = says_nothing(ordered.job);
  const Json json{{"model", ordered.job.model},
                  {"process", ordered.job.process},
                  {"foot", ordered.job.foot},
                  {"size", ordered.job.size},
                  {"part", ordered.job.part},
                  {"part_said", ordered.part_said},
                  {"who", ordered.who},
                  {"taught", ordered.taught},
                  {"taught_model", ordered.model},
                  {"sha256", ordered.sha256},
                  {"beside", robot_ ? robot_->process.sha256 : ""}};
  Ordered before;
  {
    const std::lock_guard lock{*job_mutex_};
    before = std::exchange(ordered_, std::move(ordered));
    next_shown_ = {};
  }
  const std::string text = report::to_text(json);
  const Result<std::optional<std::string>> kept = operator_control_->memory().setting(k_order_key);
  if (kept && (*kept ? **kept == text : nothing)) return;
  const Result<void> put = operator_control_->memory().put_setting(k_order_key, text,
                                                                   {.id = 0,
                                                                    .time = memory::now_ms(),
                                                                    .who = who.empty() ? "service" : who,
                                                                    .door = {},
                                                                    .action = "next scans",
                                                                    .subject = "cell",
                                                                    .before = before.job.process,
                                                                    .after = process});
  if (!put) log_error(put.error());
}

void Service::order_by(const OperatorCommand& start) {
  Ordered next = ordered();
  if (start.job.keep_process && !next.job.process.empty()) {
    next.job.model = start.job.model;
    next.job.foot = start.job.foot;
    next.job.size = start.job.size;
    next.job.part = start.job.part;
  } else {
    next = {.job = start.job, .who = start.who};
  }
  next.part_mark = start.mark;
  next.part_said = next.job.part.empty() ? 0 : memory::now_ms();
  shoe_ = {.part = next.job.part, .mark = start.mark};
  order(std::move(next));
}

void Service::order_part_again(const OperatorCommand& rescan) {
  // After a stop nobody knows which shoe stands there.
  if (shoe_.part.empty() || shoe_.mark.stopped()) return;
  Ordered next = ordered();
  next.job.part = shoe_.part;
  next.part_mark = rescan.mark;
  next.part_said = memory::now_ms();
  order(std::move(next));
}

void Service::take_part() {
  Ordered now;
  {
    // In the memory it stands on with the time when it was said: whoever writes there may wait, and the
    // sensor must hear this thread.
    const std::lock_guard lock{*job_mutex_};
    now = ordered_;
    // One that a stop has ended is forgotten when nothing is in work, also in the memory.
    if (now.part_mark.stopped()) {
      now.job.part.clear();
    } else {
      ordered_.job.part.clear();
    }
  }
  Chosen& chosen = scan_->chosen;
  chosen.part = now.job.part;
  chosen.foot = now.job.foot;
  chosen.size = now.job.size;
  shoe_ = {.part = chosen.part, .mark = scan_->mark};
  operator_control_->show_shoe({.part = chosen.part, .foot = chosen.foot, .size = chosen.size});
  if (chosen.part.empty()) return;
  if (const Result<void> marked = mark_part(scan_->folder, chosen.part); !marked) log_error(marked.error());
}

void Service::order_taught(const std::string& process, const Chosen& chosen) {
  order({.job = {.model = {}, .process = process, .foot = {}, .size = {}, .part = {}},
         .who = chosen.process_by,
         .taught = true,
         .model = chosen.model,
         .sha256 = taken_of(chosen).sha256});
}

void Service::order_is_saved(const OperatorCommand& saved) {
  const Ordered now = ordered();
  // Where no model is recognised it would be worked with the service's own process instead.
  if (now.taught && options_.models && now.sha256 == saved.why) order({});
}

void Service::take_up_order() {
  if (!robot_) return;
  const Result<std::optional<std::string>> kept = operator_control_->memory().setting(k_order_key);
  if (!kept) return log_error(kept.error());
  if (!*kept) return;
  const Json json = Json::parse(**kept, nullptr, false);
  if (!json.is_object()) return;
  Ordered before{.job = {.model = field_of(json, "model"),
                         .process = field_of(json, "process"),
                         .foot = field_of(json, "foot"),
                         .size = field_of(json, "size"),
                         .part = field_of(json, "part")},
                 .who = field_of(json, "who"),
                 .taught = json.value("taught", Json(false)) == true,
                 .model = field_of(json, "taught_model"),
                 .sha256 = field_of(json, "sha256"),
                 .part_mark = operator_control_->going(),
                 .part_said = json.contains("part_said") && json["part_said"].is_number_integer()
                                  ? json["part_said"].get<memory::UnixMs>()
                                  : 0};
  if (is_used_up(operator_control_->memory(), before.job.part, before.part_said)) before.job.part.clear();
  if (says_nothing(before.job)) return;
  // Another --process than then is the newer word.
  if (field_of(json, "beside") != robot_->process.sha256) {
    log_step("the process of the last start (%s, by %s) ends here: --process is another one",
             before.job.process.c_str(), before.who.c_str());
    return order({});
  }
  log_step("goes on with %s, as %s said: a start that names another ends it", words_of(before.job).c_str(),
           before.who.c_str());
  const std::lock_guard lock{*job_mutex_};
  ordered_ = std::move(before);
}

void Service::forget_used_part() {
  const std::string part = ordered().job.part;
  const auto is_its = [&part](const fs::path& folder) { return marked_part(folder) == part; };
  if (part.empty() || std::ranges::none_of(unfinished_, is_its)) return;
  const std::lock_guard lock{*job_mutex_};
  ordered_.job.part.clear();
}

void Service::show_next_process() {
  {
    const std::lock_guard lock{*job_mutex_};
    if (next_shown_ != HostClock::time_point{} && now() - next_shown_ < k_between_orders) return;
    next_shown_ = now();
  }
  Ordered next = ordered();
  if (!next.job.part.empty() && next.part_mark.stopped()) {
    next.job.part.clear();
    order(next);
  }
  // Of the scan that comes in it was said when that began.
  if (!scan_)
    operator_control_->show_shoe({.part = next.job.part, .foot = next.job.foot, .size = next.job.size});
  if (!robot_) return;
  Chosen chosen;
  chosen.model = carrier_ ? std::string{} : next.job.model;
  chosen.process_name = carrier_ ? std::string{} : next.job.process;
  // Nobody knows before the shoe is seen.
  const bool by_model = !carrier_ && options_.models && chosen.model.empty() && chosen.process_name.empty();
  if (by_model) return operator_control_->show_next({});
  // One that cannot be read is told by the scan that would be worked with it.
  if (const Result<void> release = choose_release(chosen); release) static_cast<void>(choose_process(chosen));
  operator_control_->show_next({chosen.process_name, next.job.process.empty() || carrier_ ? "" : next.who});
}

void Service::look_at_other_process(Chosen& chosen) const {
  if (!robot_ || !chosen.taught || !chosen.process || chosen.model.empty()) return;
  if (chosen.model == chosen.taught_model) return;
  const fs::path own = transfer::process_of(catalogue_for(chosen).models, chosen.model, chosen.sample);
  std::string name = robot_->process.process.name, sha256 = robot_->process.sha256;
  if (!own.empty()) {
    const Result<TakenProcess> taken = take_process(own);
    name = taken ? taken->process.name : "one that cannot be read";
    sha256 = taken ? taken->sha256 : "";
  }
  if (sha256 == chosen.process->sha256) return;
  chosen.other_process = "the process of " + chosen.model + " is " + name + ", and " + chosen.process_by +
                         " took " + chosen.process_name + " for the shoe before";
}

void Service::look_at_part(Chosen& chosen, const fs::path& folder) const {
  chosen.told_twice = worked_before(operator_control_->memory(), folder.filename().string(), chosen.part);
}

Result<void> Service::keep_process(const fs::path& folder, const Chosen& chosen) const {
  return report::write_file_atomically(folder / transfer::k_process_file, taken_of(chosen).text);
}

}  // namespace biteline::service
