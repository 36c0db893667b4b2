// SPDX-License-Identifier: MIT
#include "tests/soak/books.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>

#include "tests/support/json.hpp"

namespace biteline::soak {
namespace {

namespace fs = std::filesystem;

nlohmann::json read_json(const fs::path& file) {
  std::ifstream stream{file};
  nlohmann::json json = test::read_json(stream);
  return json.is_object() ? json : nlohmann::json::object();
}

std::string reason_of(const nlohmann::json& json) {
  return json.value("reason_code", "") + ": " + json.value("reason", "");
}

std::string failed_rows(const nlohmann::json& gate) {
  std::string reasons;
  for (const auto& row : gate.value("rows", nlohmann::json::array())) {
    const std::string code = row.value("reason_code", "");
    if (!code.empty()) reasons += (reasons.empty() ? "" : ", ") + code;
  }
  return reasons;
}

double median(std::span<const double> values) {
  std::vector<double> sorted{values.begin(), values.end()};
  std::ranges::sort(sorted);
  return sorted[sorted.size() / 2];
}

double early_mb(const std::vector<double>& mb) {
  return median(std::span{mb}.subspan(mb.size() / 5, mb.size() / 5));
}

double late_mb(const std::vector<double>& mb) {
  return median(std::span{mb}.last(mb.size() / 5));
}

/// A process fills its pools over its first scans: a service of ten scans grew from 118 to 144 MB, and stayed
/// there.
constexpr std::size_t k_least_notes = 20;

}  // namespace

ScanAccount read_account(const fs::path& scan) {
  ScanAccount account;
  std::ifstream script{scan / "path/path.script"};
  account.script.assign(std::istreambuf_iterator<char>{script}, {});
  if (!fs::exists(scan / "report.json")) return account;
  const nlohmann::json line = read_json(scan / "report.json"), path = read_json(scan / "path/report.json"),
                       gate = read_json(scan / "gate.json"), followed = read_json(scan / "followed.json");
  account.permitted = gate.value("permitted", false);
  account.own_arm = path.value("calibrated", false);
  account.profiles = line.value("/scan/profiles"_json_pointer, 0);
  if (line.contains("reason")) {
    account.outcome = Outcome::Refused;
    account.reason = reason_of(line);
  } else if (path.contains("reason")) {
    account.outcome = Outcome::NoPath;
    account.reason = reason_of(path);
  } else if (!gate.empty() && !account.permitted) {
    account.outcome = Outcome::NotSent;
    account.reason = failed_rows(gate);
  } else if (followed.contains("stopped")) {
    account.outcome = Outcome::Halted;
    account.reason = reason_of(followed["stopped"]);
  } else if (followed.value("completed", false)) {
    account.outcome = Outcome::Followed;
  } else if (account.permitted && followed.empty()) {
    account.outcome = Outcome::Abandoned;
  }
  return account;
}

void MemoryBook::note(const std::string& process, int pid, double mb) {
  if (mb <= 0) return;  // it has just ended
  std::vector<Life>& lives = lives_[process];
  if (lives.empty() || lives.back().pid != pid) lives.push_back({.pid = pid, .mb = {}});
  lives.back().mb.push_back(mb);
}

std::vector<std::string> MemoryBook::growths() const {
  constexpr double k_most_mb = 10, k_most_share = 0.1;
  std::vector<std::string> found;
  for (const auto& [process, lives] : lives_) {
    for (const Life& life : lives) {
      if (life.mb.size() < k_least_notes) continue;
      const double early = early_mb(life.mb), late = late_mb(life.mb);
      if (late - early <= k_most_mb + k_most_share * early) continue;
      char text[160];
      std::snprintf(text, sizeof text, "memory of %s grew from %.0f to %.0f MB in %zu scans", process.c_str(),
                    early, late, life.mb.size());
      found.emplace_back(text);
    }
  }
  return found;
}

std::string MemoryBook::table() const {
  std::string table = "process      lives  longest (scans)  MB early  MB late  MB most\n";
  for (const auto& [process, lives] : lives_) {
    const Life& longest =
        *std::ranges::max_element(lives, {}, [](const Life& life) { return life.mb.size(); });
    double most = 0;
    for (const Life& life : lives) most = std::max(most, *std::ranges::max_element(life.mb));
    const bool told = longest.mb.size() >= k_least_notes;
    char row[160];
    std::snprintf(row, sizeof row, "%-12s %5zu  %15zu  %8.0f  %7.0f  %7.0f\n", process.c_str(), lives.size(),
                  longest.mb.size(), told ? early_mb(longest.mb) : longest.mb.front(),
                  told ? late_mb(longest.mb) : longest.mb.back(), most);
    table += row;
  }
  return table;
}

}  // namespace biteline::soak
