// SPDX-License-Identifier: MIT
#pragma once
/// \file What `biteline replay` says of a session.

#include <CppUTest/TestHarness.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"

namespace biteline::test {

/// Ends before anybody looks; its exit status.
inline int run_to_end(const std::string& program, const std::vector<std::string>& arguments) {
  auto child = intake::ChildProcess::start({.program = program, .arguments = arguments});
  SUCCEEDS(child);
  const auto status = child->wait(std::chrono::seconds{900});
  SUCCEEDS(status);
  return *status;
}

struct Replayed {
  int exit{0};
  nlohmann::json report{};  ///< null: none was written

  [[nodiscard]] std::string pictures(const char* key) const {
    const auto check =
        report.is_object() ? report.value("picture_check", nlohmann::json{}) : nlohmann::json{};
    if (!check.is_object() || !check.contains(key)) return "-";
    return check[key].is_string() ? check[key].get<std::string>() : check[key].dump();
  }
  [[nodiscard]] std::string reason_code() const {
    return report.is_object() ? report.value("reason_code", "") : std::string{};
  }
};

inline Replayed replayed(const std::filesystem::path& session, const std::filesystem::path& out) {
  Replayed result;
  result.exit = run_to_end(BITELINE_TOOL, {"replay", session.string(), "--out", out.string(), "--quiet"});
  std::ifstream file{out / "report.json"};
  if (file) result.report = nlohmann::json::parse(file, nullptr, false);
  return result;
}

}  // namespace biteline::test
