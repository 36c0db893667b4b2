// SPDX-License-Identifier: MIT
// What a door asks of the sensor, which answers it: the set in use with changes, sent whole; a recording to
// be kept.
#include "common/settings/settings.hpp"

#include "host/apps/biteline-host/operator_control.hpp"

namespace biteline::service {
namespace {

/// Below a door's own patience (10 s): the reason is told and not only that there was no answer.
constexpr std::chrono::seconds k_patience{8};

}  // namespace

Result<void> OperatorControl::change_settings(const std::vector<api::SettingChange>& changes,
                                              const std::string& who) {
  std::unique_lock lock{mutex_};
  if (!sensor_lost_.empty()) return fail(Errc::WrongState, "no sensor: %s", sensor_lost_.c_str());
  if (!health_ || !health_->settings)
    return fail(Errc::WrongState, "this sensor takes no settings over the network");
  if (ending_) return fail(Errc::WrongState, "the service ends");
  if (sensor_asked_) return fail(Errc::WrongState, "another change is on its way; wait for it");
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
  settings_sent_ = text;
  const Result<std::string> taken =
      ask_sensor(lock, {.kind = OperatorCommand::Kind::Settings, .who = who, .settings = text},
                 "the sensor has not said whether it takes the settings; see what it runs with");
  if (!taken) return tl::unexpected<Error>{taken.error()};
  return {};
}

Result<std::string> OperatorControl::keep_recording(bool next, const std::string& who) {
  std::unique_lock lock{mutex_};
  if (!sensor_lost_.empty() || !hello_)
    return fail(Errc::WrongState, "no sensor: %s",
                sensor_lost_.empty() ? "not told yet" : sensor_lost_.c_str());
  if (hello_->protocol_minor < wire::k_least_minor_to_keep) {
    return fail(Errc::WrongState,
                "%s keeps no recording over the network: it is older than protocol 1.3; on the unit: "
                "biteline-sensor --record NAME --keep last",
                hello_->name.c_str());
  }
  if (ending_) return fail(Errc::WrongState, "the service ends");
  if (sensor_asked_)
    return fail(Errc::WrongState, "another question to the sensor is on its way; wait for it");
  settings_sent_.clear();
  return ask_sensor(lock,
                    {.kind = OperatorCommand::Kind::Keep,
                     .who = who,
                     .command = next ? wire::Command::KeepNext : wire::Command::KeepLast},
                    "the sensor has not said whether it keeps the recording; ask again");
}

Result<std::string> OperatorControl::ask_sensor(std::unique_lock<std::mutex>& lock, OperatorCommand command,
                                                const char* silent) {
  const std::uint32_t question = ++sensor_question_;
  sensor_asked_ = true;
  sensor_answer_.reset();
  command.question = question;
  commands_.push_back(std::move(command));
  const bool told =
      sensor_answered_.wait_for(lock, k_patience, [this] { return sensor_answer_.has_value(); });
  sensor_asked_ = false;
  if (told) return *sensor_answer_;
  // What was not even sent does not take effect any more.
  std::erase_if(commands_, [question](const OperatorCommand& one) { return one.question == question; });
  return fail(Errc::WrongState, "%s", silent);
}

void OperatorControl::answer_sensor(std::optional<std::uint32_t> question, const Result<std::string>& done) {
  {
    const std::lock_guard lock{mutex_};
    // An answer that comes too late is to nobody.
    if (!sensor_asked_ || (question && *question != sensor_question_)) return;
    sensor_answer_ = done;
    // Until the sensor tells them itself: a change that comes first is to these, not to those of before.
    if (done && !settings_sent_.empty() && health_ && health_->settings)
      health_->settings->text = settings_sent_;
  }
  sensor_answered_.notify_all();
}

}  // namespace biteline::service
