// SPDX-License-Identifier: MIT
// What a model's shoes teach of the force: for the next path, and of the one that was followed.
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/records/force_book/force_book.hpp"

namespace biteline::service {

Result<std::optional<force_book::Subject>> Service::force_subject(const Chosen& chosen) const {
  if (chosen.model.empty() || !taken_of(chosen).process.force) return std::optional<force_book::Subject>{};
  BITELINE_ASSIGN(const path::Mounted taught, mounted(taken_of(chosen).process));
  return std::optional{force_book::Subject{.model = chosen.model,
                                           .foot = chosen.foot,
                                           .process = taken_of(chosen).process.name,
                                           .process_sha256 = taken_of(chosen).sha256,
                                           .tip = force_book::tip_text(taught.tip_flange)}};
}

path::Process Service::process_to_plan(const Chosen& chosen) const {
  path::Process process = process_of(chosen);
  const auto learned = [&]() -> Result<std::optional<path::ForceLearned>> {
    BITELINE_ASSIGN(const std::optional<force_book::Subject> of, force_subject(chosen));
    if (!of) return std::optional<path::ForceLearned>{};
    return force_book::learned(operator_control_->memory(), *of);
  }();
  // Without it the set force alone is asked for: that is no fault of the shoe.
  if (!learned) log_error(learned.error());
  if (learned) process.force_learned = *learned;
  if (!chosen.following.empty()) make_room_for(chosen.following.front().process, process);
  return process;
}

void Service::learn_force(const Chosen& chosen, const std::string& name, const path::Process& planned,
                          const path::ForceTold& told) const {
  const auto done = [&]() -> Result<void> {
    BITELINE_ASSIGN(const std::optional<force_book::Subject> of, force_subject(chosen));
    if (!of) return {};
    BITELINE_ASSIGN(const std::optional<path::ForceLearned> now,
                    force_book::learned(operator_control_->memory(), *of));
    const path::ForceLearned before = planned.force_learned.value_or(path::ForceLearned{}),
                             stands = now.value_or(path::ForceLearned{});
    // What was missing then is in it already, or was never there.
    if (before.shoes != stands.shoes || before.air_runs != stands.air_runs) {
      log_step("%s teaches nothing of the force: it was planned before what is learned now", name.c_str());
      return {};
    }
    BITELINE_ASSIGN(const force_book::Entry entry,
                    force_book::learn_shoe(operator_control_->memory(), *of, planned.force->set_newton, name,
                                           told, planned.tool.name));
    log_step("the force on %s is %s", of->model.c_str(), force_book::words_of(entry.learned).c_str());
    return {};
  }();
  if (!done) log_error(done.error());
}

}  // namespace biteline::service
