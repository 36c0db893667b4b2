// SPDX-License-Identifier: MIT
// The memory with 100 000 shoes: list, trends and places beside one plain SELECT over the same rows.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>

#include "host/records/memory/factory_day.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::bench {
namespace {

namespace fs = std::filesystem;

constexpr int k_rounds = 5;
constexpr int k_scans = 100'000;
constexpr double k_target_s = 0.1;

void row(const char* what, double ours_s, double peer_s) {
  std::printf(
      "{\"bench\":\"memory\",\"what\":\"%s\",\"ours\":%.4g,\"unit\":\"s\",\"peer\":\"one SELECT over the "
      "index\",\"peer_value\":%.4g,\"ratio\":%.4g,\"target\":%g}\n",
      what, ours_s, peer_s, ours_s / peer_s, k_target_s);
}

template <class Work>
double seconds(Work&& work) {
  double best = 1e9;
  for (int round = 0; round < k_rounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

/// A year of one cell: 12 models, one in 20 refused for one of 7 reasons, texts as long as real ones.
constexpr const char* k_fill = R"sql(
BEGIN;
WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < %d)
INSERT INTO scans (id, name, time, model, model_probability, verdict, reason_code, length_mm, confidence, u95_mm,
  weak_stretches, scan_s, line_s, cycle_s, operator, process, decision, decided_by, sent, followed,
  line_version)
SELECT i, printf('scan-%%06d', i), 1700000000000 + i * 300000, 'model-' || (i %% 12), 0.98,
  CASE WHEN i %% 20 THEN 'ok' ELSE 'refused' END, CASE WHEN i %% 20 THEN '' ELSE 'reason_' || (i %% 7) END,
  600 + i %% 50, 0.99, 0.3, i %% 3, 8.5, 0.05, 20, 'ana', 'grind', 'automatic', '', 1, 1, 0 FROM n;
INSERT INTO scan_texts SELECT id, 'a reason in words', '', '', '{"host":"0.1.0"}', printf('%%.1500c', 'd') FROM scans;
INSERT INTO scan_places SELECT id, 'model-0', time, zeroblob(144) FROM scans;
COMMIT;
ANALYZE;
)sql";

int run() {
  std::string pattern = (fs::temp_directory_path() / "biteline-bench-XXXXXX").string();
  const fs::path folder = ::mkdtemp(pattern.data());
  const fs::path file = folder / memory::k_memory_file;
  auto memory = memory::Memory::open(file);
  auto database = memory::Database::open(file, memory::Database::Access::ReadWrite);
  char fill[4096];
  std::snprintf(fill, sizeof fill, k_fill, k_scans);
  if (!memory || !database || !database->execute(fill)) {
    std::fprintf(stderr, "bench_memory: %s cannot be filled\n", file.c_str());
    return 1;
  }
  const auto plain = [&](const char* sql) {
    return seconds([&] {
      auto statement = database->prepare(sql);
      while (statement && *statement->step()) {
      }
    });
  };
  bool good = true;
  const double ids_s = plain("SELECT id FROM scans ORDER BY id DESC LIMIT 100");
  const double count_s = plain("SELECT count(*), avg(length_mm) FROM scans WHERE time > 0");
  memory::ScanFilter filter;
  row("list, newest 100 of 100 000", seconds([&] { good = good && memory->scans(filter).has_value(); }),
      ids_s);
  filter.model = "model-3";
  filter.verdict = "refused";
  row("list, newest 100 of a model refused",
      seconds([&] { good = good && memory->scans(filter).has_value(); }), ids_s);
  row("trends of all", seconds([&] {
        good = good && memory->trends({}, memory::FactoryDay{}, memory::Span::Day).has_value();
      }),
      count_s);
  row("trends of a model", seconds([&] {
        memory::ScanFilter of_model;
        of_model.model = "model-3";
        good = good && memory->trends(of_model, memory::FactoryDay{}, memory::Span::Day).has_value();
      }),
      count_s);
  row("places (Pp, Ppk) of 100 000",
      seconds([&] { good = good && memory->place_sums("model-0", {}, {}).has_value(); }), count_s);
  fs::remove_all(folder);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace biteline::bench

int main() {
  return biteline::bench::run();
}
