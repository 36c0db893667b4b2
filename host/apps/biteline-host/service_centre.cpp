// SPDX-License-Identifier: MIT
// What the factory's centre says of this cell's shoes.
#include <algorithm>
#include <cstdlib>

#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/records/centre_word/centre_word.hpp"

namespace biteline::service {
namespace {

constexpr Nanoseconds k_between_words = std::chrono::seconds{5};

/// For a lamp; empty: nothing is wrong.
std::string words_of(const centre_word::CentreWord& word) {
  if (!word.held.empty()) return word.held;
  if (word.letters.empty()) return {};
  const centre_word::DeadLetter& last = word.letters.back();
  return std::to_string(word.count) + (word.count == 1 ? " shoe" : " shoes") +
         " could not be read whole at the centre, last " + last.scan + ": " + last.why;
}

}  // namespace

void Service::look_at_centre() {
  if (centre_looked_ != HostClock::time_point{} && now() - centre_looked_ < k_between_words) return;
  centre_looked_ = now();
  std::error_code error;
  if (!std::filesystem::exists(options_.out / centre_word::k_file, error)) return;
  const Result<centre_word::CentreWord> word = centre_word::read(options_.out);
  if (!word) return operator_control_->show_centre(to_line(word.error()));
  operator_control_->show_centre(words_of(*word));
  if (centre_ && *centre_ == *word) return;
  centre_ = *word;
  // How many stand in the log: some may have come while no service ran.
  constexpr const char* k_told_key = "dead_letters_told";
  const auto told = operator_control_->memory().setting(k_told_key);
  if (!told) return log_error(told.error());
  const std::int64_t known = *told ? std::atoll((*told)->c_str()) : 0;
  const std::int64_t fresh = std::min<std::int64_t>(word->count - known, std::ssize(word->letters));
  if (fresh <= 0) return;
  for (auto letter = word->letters.end() - fresh; letter != word->letters.end(); ++letter) {
    log_step("%s: the centre could not read all of it: %s", letter->scan.c_str(), letter->why.c_str());
    const memory::LogRow row{.id = 0,
                             .time = memory::now_ms(),
                             .who = "service",
                             .door = {},
                             .action = "dead letter",
                             .subject = letter->scan,
                             .before = {},
                             .after = letter->why};
    const bool last = letter + 1 == word->letters.end();
    const Result<void> logged =
        last ? operator_control_->memory().put_setting(k_told_key, std::to_string(word->count), row)
             : operator_control_->memory().log(row);
    if (!logged) return log_error(logged.error());
  }
}

}  // namespace biteline::service
