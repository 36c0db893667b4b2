// SPDX-License-Identifier: MIT
#include "host/apps/biteline-demo/live_cell.hpp"

#include <chrono>
#include <cstdio>

#include "common/system/file.hpp"
#include "host/apps/biteline-demo/stand.hpp"
#include "host/report/report.hpp"

namespace biteline::demo {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::string_view k_web_says = "biteline-web: ";
constexpr std::string_view k_web_ended = "biteline-web has ended: ";
/// Old folders go beyond it: the cell scans until somebody ends it.
constexpr const char* k_keep_gb = "2";
constexpr std::size_t k_token_bytes = 200;

/// For one viewer, who needs no account; the file goes once it is read.
Result<std::string> read_token(const fs::path& file) {
  BITELINE_ASSIGN(std::string token, read_regular_file(file, k_token_bytes));
  std::error_code ignored;
  fs::remove(file, ignored);
  while (!token.empty() && token.back() == '\n') token.pop_back();
  return token;
}

Result<void> tell_address(const std::string& address, const fs::path& token_file) {
  BITELINE_ASSIGN(const std::string token, read_token(token_file));
  std::printf("open %s/#token=%s\n", address.c_str(), token.c_str());
  std::printf("The token lets one viewer look on, once. Ctrl-C ends the demo.\n");
  std::fflush(stdout);
  return {};
}

}  // namespace

Result<ExitStatus> run_live(const LiveOptions& options, const std::atomic<bool>& stop) {
  const fs::path folder = options.cell.out / "live", token_file = folder / "guest-token";
  const fs::path page = intake::program_folder().parent_path() / "share/biteline/web/index.html";
  if (!fs::exists(page))
    return fail(Errc::FileNotFound, "the page, %s: run ./run build, which needs esbuild and npm",
                page.c_str());
  BITELINE_TRY(report::prepare_folder(folder));
  BITELINE_ASSIGN(const Stand stand, start_stand(options.cell, {.name = "live"}, folder));
  std::vector<std::string> arguments = host_arguments(options.cell, stand, folder);
  // What is taught in a demo is no model of the user's.
  arguments.insert(arguments.end(), {"--library", (folder / "models").string(), "--guest-token",
                                     token_file.string(), "--keep-gb", k_keep_gb, "--web"});
  if (!options.address.empty()) arguments.push_back(options.address);
  BITELINE_ASSIGN(intake::ChildProcess host,
                  intake::ChildProcess::start({.program = intake::program_folder() / "biteline-host",
                                               .arguments = std::move(arguments),
                                               .pass_stderr = true}));
  bool told = false;
  while (!stop) {
    const Result<std::string> line = host.next_line(100ms);
    if (!line && line.error().code == Errc::Timeout) continue;
    if (!line) return tl::unexpected<Error>{line.error()};
    if (!told && line->starts_with(k_web_ended)) {
      return fail(Errc::ProcessDied, "%s; where another program has its port, say --web ADDRESS:PORT",
                  line->c_str());
    }
    if (!told && line->starts_with(k_web_says)) {
      BITELINE_TRY(tell_address(line->substr(k_web_says.size()), token_file));
      told = true;
    } else if (!options.cell.quiet) {
      std::printf("  host: %s\n", line->c_str());
      std::fflush(stdout);
    }
  }
  // The service first: it lets the arm come to rest and the light go off.
  host.stop(30s);
  return ExitStatus::Done;
}

}  // namespace biteline::demo
