// SPDX-License-Identifier: MIT
// A door changes what the sensor runs with: the set in use with the changes, sent whole, answered by the
// sensor.
#include "common/settings/settings.hpp"

#include "host/apps/biteline-host/cockpit.hpp"

namespace biteline::service {
namespace {

/// Below a door's own patience (10 s): the reason is told and not only that there was no answer.
constexpr std::chrono::seconds k_patience{8};

}  // namespace

Result<void> Cockpit::change_settings(const std::vector<api::SettingChange>& changes,
                                      const std::string& who) {
  std::unique_lock lock{mutex_};
  if (!sensor_lost_.empty()) return fail(Errc::WrongState, "no sensor: %s", sensor_lost_.c_str());
  if (!health_ || !health_->settings)
    return fail(Errc::WrongState, "this sensor takes no settings over the network");
  if (ending_) return fail(Errc::WrongState, "the service ends");
  if (settings_asked_) return fail(Errc::WrongState, "another change is on its way; wait for it");
  BITELINE_ASSIGN(settings::SettingsSet set,
                  settings::parse_settings(health_->settings->text, "the settings in use"));
  for (const api::SettingChange& change : changes) {
    if (change.value) {
      set.set(change.key, *change.value);
    } else {
      set.clear(change.key);
    }
  }
  // Whole and checked together, as a file would be.
  const std::string text = settings::settings_text(set);
  BITELINE_TRY(settings::parse_settings(text, "settings"));
  const std::uint32_t question = ++settings_question_;
  settings_asked_ = true;
  settings_answer_.reset();
  settings_sent_ = text;
  Wish& wish = wishes_.emplace_back();
  wish.kind = Wish::Kind::Settings;
  wish.who = who;
  wish.settings = text;
  wish.question = question;
  const bool told =
      settings_answered_.wait_for(lock, k_patience, [this] { return settings_answer_.has_value(); });
  settings_asked_ = false;
  if (told) return *settings_answer_;
  // What was not even sent does not take effect any more.
  std::erase_if(wishes_, [question](const Wish& one) { return one.question == question; });
  return fail(Errc::WrongState,
              "the sensor has not said whether it takes the settings; see what it runs with");
}

void Cockpit::answer_settings(std::optional<std::uint32_t> question, const Result<void>& done) {
  {
    const std::lock_guard lock{mutex_};
    // An answer that comes too late is to nobody.
    if (!settings_asked_ || (question && *question != settings_question_)) return;
    settings_answer_ = done;
    // Until the sensor tells them itself: a change that comes first is to these, not to those of before.
    if (done && health_ && health_->settings) health_->settings->text = settings_sent_;
  }
  settings_answered_.notify_all();
}

}  // namespace biteline::service
