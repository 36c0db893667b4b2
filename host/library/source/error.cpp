// SPDX-License-Identifier: MIT
#include "biteline/error.hpp"

#include "biteline/version.hpp"
#include "host/library/source/inside.hpp"

namespace biteline::sdk {

Error::Error(const std::string& what, std::string next_step)
    : std::runtime_error{what}, next_step_{std::move(next_step)} {}
Error::~Error() = default;

Refused::Refused(std::string reason_code, const std::string& reason, std::string next_step)
    : Error{reason, std::move(next_step)}, reason_code_{std::move(reason_code)} {}
Refused::~Refused() = default;

void throw_error(const biteline::Error& error) {
  const ErrorRow& row = error_row(error.code);
  if (row.exit_status == ExitStatus::Refused) throw Refused{"check_failed", to_line(error), row.action};
  throw Error{to_line(error), row.action};
}

void throw_refusal(report::ToldRefusal refusal) {
  throw Refused{std::move(refusal.reason_code), refusal.reason, std::move(refusal.next_step)};
}

const char* version() {
  return BITELINE_LIBRARY_VERSION;
}

}  // namespace biteline::sdk
