// SPDX-License-Identifier: MIT
// collect_benchmarks FOLDER OUT.json: runs every bench_* program in FOLDER, one after the other, shows their
// rows as one table and writes them to OUT.json.  A row is a line of JSON on a program's stdout:
//   {"bench":"stripe.extract","what":"...","ours":1.0,"peer":"OpenCV","peer_value":2.0,"unit":"s",
//    "ratio":0.5,"target":0.1}
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string cell(const Json& row, const char* key) {
  if (!row.contains(key) || row[key].is_null()) return "";
  if (row[key].is_string()) return row[key];
  if (row[key].is_number()) {
    std::array<char, 32> text;
    std::snprintf(text.data(), text.size(), "%.4g", row[key].get<double>());
    return text.data();
  }
  return row[key].dump();
}

/// Adds the program's rows; false when it failed.
bool run(const fs::path& program, std::vector<Json>& rows) {
  std::fprintf(stderr, "bench: %s\n", program.filename().c_str());
  std::string command{"'"};
  command.append(program.string()).append("'");
  std::FILE* output = ::popen(command.c_str(), "r");
  if (output == nullptr) return false;
  std::string line;
  for (int c = std::fgetc(output); c != EOF; c = std::fgetc(output)) {
    if (c != '\n') {
      line += static_cast<char>(c);
      continue;
    }
    Json row = Json::parse(line, nullptr, false);
    if (row.is_object() && row.contains("bench")) {
      rows.push_back(std::move(row));
    } else if (!line.empty()) {
      std::fprintf(stderr, "  %s\n", line.c_str());
    }
    line.clear();
  }
  const int status = ::pclose(output);
  return WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 77);
}

void print_table(const std::vector<Json>& rows) {
  const std::array columns{"bench", "what", "ours", "unit", "peer", "peer_value", "ratio", "target"};
  std::vector<std::vector<std::string>> table{{columns.begin(), columns.end()}};
  for (const Json& row : rows) {
    std::vector<std::string> cells;
    for (const char* column : columns) cells.push_back(cell(row, column));
    table.push_back(std::move(cells));
  }
  std::array<std::size_t, columns.size()> width{};
  for (const auto& cells : table) {
    for (std::size_t i = 0; i < columns.size(); ++i) width[i] = std::max(width[i], cells[i].size());
  }
  for (const auto& cells : table) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      std::printf("%-*s  ", static_cast<int>(width[i]), cells[i].c_str());
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: collect_benchmarks FOLDER OUT.json\n");
    return 2;
  }
  std::vector<fs::path> programs;
  for (const auto& entry : fs::directory_iterator(argv[1])) {
    if (entry.is_regular_file() && entry.path().filename().string().starts_with("bench_"))
      programs.push_back(entry.path());
  }
  std::sort(programs.begin(), programs.end());
  std::vector<Json> rows;
  int failed = 0;
  for (const fs::path& program : programs) {
    if (!run(program, rows)) {
      std::fprintf(stderr, "bench: %s failed\n", program.filename().c_str());
      ++failed;
    }
  }
  print_table(rows);
  std::ofstream out(argv[2]);
  out << Json(rows).dump(1) << '\n';
  if (!out.flush()) {
    std::fprintf(stderr, "bench: %s cannot be written\n", argv[2]);
    return 2;
  }
  return failed == 0 ? 0 : 1;
}
