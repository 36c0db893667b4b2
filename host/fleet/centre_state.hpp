// SPDX-License-Identifier: MIT
#pragma once
/// \file The one place where libpqxx and its exceptions are met; of centre.cpp, recordings.cpp and
/// releases.cpp alone.

#include <pqxx/pqxx>
#include <utility>

#include "common/core/text.hpp"
#include "host/fleet/centre.hpp"

namespace biteline::fleet {

/// PostgreSQL takes no NUL and only UTF-8.
inline std::string text_of(const std::string& text) {
  return clean_text(text);
}

struct Centre::State {
  explicit State(const std::string& database) : connection{database} {}
  pqxx::connection connection;
};

template <class Value>
Result<Value> Centre::work(const std::function<Result<Value>(State&)>& on) {
  try {
    return on(*state_);
  } catch (const pqxx::broken_connection& error) {
    return fail(Errc::ConnectionLost, "database: %.200s", clean_text(error.what()).c_str());
  } catch (const std::exception& error) {
    return fail(Errc::DeviceError, "database: %.200s", clean_text(error.what()).c_str());
  }
}

}  // namespace biteline::fleet
