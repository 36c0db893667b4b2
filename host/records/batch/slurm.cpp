// SPDX-License-Identifier: MIT
#include "host/records/batch/slurm.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <thread>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "common/core/text.hpp"
#include "host/records/batch/json_fields.hpp"
#include "host/report/report.hpp"

namespace biteline::batch {
namespace {

namespace fs = std::filesystem;

/// Slurm's own limit of an array is 1001 tasks unless its settings say otherwise (MaxArraySize).
constexpr std::size_t k_most_tasks = 1000;

/// For a shell: within single quotes, whatever it holds.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string{"'\\''"} : std::string{c};
  return out + "'";
}

struct Said {
  int status{0};
  std::string text;  ///< of both its streams
};

Result<Said> run_command(const std::string& line) {
  std::FILE* const pipe = ::popen(("(" + line + ") 2>&1 </dev/null").c_str(), "re");
  if (pipe == nullptr) return fail_errno(Errc::DeviceError, errno, "%.120s", line.c_str());
  Said said;
  std::array<char, 4096> chunk{};
  std::size_t count = 0;
  while ((count = std::fread(chunk.data(), 1, chunk.size(), pipe)) > 0) said.text.append(chunk.data(), count);
  const int raw = ::pclose(pipe);
  said.status = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128;
  while (!said.text.empty() && std::isspace(static_cast<unsigned char>(said.text.back())) != 0)
    said.text.pop_back();
  return said;
}

Result<std::string> must(const char* command, const std::string& line) {
  BITELINE_ASSIGN(const Said said, run_command(line));
  if (said.status == 0) return said.text;
  const std::string words = clean_text(said.text, 150);
  if (said.status == 127)
    return fail(Errc::FileNotFound, "%s (package slurm-client): %s", command, words.c_str());
  return fail(Errc::PeerRefused, "%s: %s", command, words.c_str());
}

/// The script of every task: it reads its shard from the list, so that an array's numbers begin at 0.
Result<fs::path> write_script(const BatchRun& run, const fs::path& folder,
                              const std::vector<std::size_t>& shards, const std::string& name) {
  std::string list;
  for (const std::size_t shard : shards) list += std::to_string(shard) + "\n";
  const fs::path list_file = folder / (name + ".list");
  BITELINE_TRY(write_shared_file(list_file, list));
  const fs::path tool = fs::read_symlink("/proc/self/exe");
  std::string script = "#!/bin/sh\nset -e\nshard=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" " +
                       quoted(list_file.string()) + ")\nexec " + quoted(tool.string()) + " batch run " +
                       quoted(run.folder.string()) + " --shard \"$shard\" --quiet --program " +
                       quoted(run.build.program.string()) + " --cell " + quoted(run.build.cell.string());
  script +=
      FixedText<96>::format(" --time-s %.17g --memory-mb %.17g\n", run.limits.time_s, run.limits.memory_mb)
          .c_str();
  const fs::path file = folder / (name + ".sh");
  BITELINE_TRY(write_shared_file(file, script));
  return file;
}

Result<std::string> submit(const fs::path& script, std::size_t tasks, const SlurmOptions& options) {
  std::string line = "sbatch --parsable --requeue --job-name=biteline-batch --ntasks=1 --array=0-" +
                     std::to_string(tasks - 1);
  if (options.at_a_time > 0) line.append("%").append(std::to_string(options.at_a_time));
  if (!options.partition.empty()) line += " --partition=" + quoted(options.partition);
  line += " --output=" + quoted((script.parent_path() / "task-%A_%a.txt").string()) + " --open-mode=append " +
          quoted(script.string());
  BITELINE_ASSIGN(const std::string answer, must("sbatch", line));
  // "JOB" or "JOB;CLUSTER".
  std::string job = answer.substr(0, answer.find_first_of(";"));
  job.erase(std::ranges::find_if_not(job, [](unsigned char c) { return std::isdigit(c) != 0; }), job.end());
  if (job.empty()) return fail(Errc::ProtocolError, "sbatch said '%.100s'", clean_text(answer).c_str());
  return job;
}

/// Tasks of the job that wait, run or end.
Result<bool> in_queue(const std::string& job) {
  BITELINE_ASSIGN(const Said said, run_command("squeue --noheader --array --format=%T --jobs=" + job));
  // A job that is over and forgotten is "Invalid job id specified".
  if (said.status != 0 && said.text.find("Invalid job id") != std::string::npos) return false;
  if (said.status == 127) return fail(Errc::FileNotFound, "squeue (package slurm-client)");
  // A controller that is being started again says nothing for a while: the job is not lost.
  return said.status != 0 || !said.text.empty();
}

std::size_t recordings_in(const BatchRun& run, const std::vector<std::size_t>& shards) {
  std::size_t count = 0;
  for (const std::size_t shard : shards) count += run.plan.shards[shard].size();
  return count;
}

Result<void> wait_for(const std::string& job, const BatchRun& run, const std::vector<std::size_t>& shards,
                      const SlurmOptions& options, const BatchProgress& progress,
                      const volatile std::sig_atomic_t* stop) {
  using Clock = std::chrono::steady_clock;
  while (true) {
    const auto next = Clock::now() + std::chrono::duration<double>(options.look_every_s);
    while (Clock::now() < next) {
      if (stop != nullptr && *stop != 0) {
        BITELINE_TRY(must("scancel", "scancel " + job));
        return fail(Errc::ConnectionLost, "stopped; job %s is cancelled; the same command goes on",
                    job.c_str());
      }
      std::this_thread::sleep_for(std::chrono::milliseconds{50});
    }
    BITELINE_ASSIGN(const bool queued, in_queue(job));
    const std::vector<std::size_t> missing = missing_shards(run);
    if (progress) progress(run.plan.recordings.size() - recordings_in(run, missing));
    if (!queued) return {};
    if (std::ranges::any_of(shards,
                            [&](std::size_t shard) { return std::ranges::binary_search(missing, shard); }))
      continue;
    // All files are there: whatever still stands in the queue is a task that Slurm lost sight of.
    BITELINE_TRY(run_command("scancel " + job));
    return {};
  }
}

}  // namespace

Result<void> run_slurm(const BatchRun& run, const SlurmOptions& options, const BatchProgress& progress,
                       const volatile std::sig_atomic_t* stop) {
  const fs::path folder = run.run_folder() / "slurm";
  BITELINE_TRY(report::prepare_folder(folder));
  std::vector<std::size_t> missing = missing_shards(run);
  for (int attempt = 1; !missing.empty() && attempt <= options.attempts; ++attempt) {
    for (std::size_t begin = 0; begin < missing.size(); begin += k_most_tasks) {
      const std::size_t end = std::min(begin + k_most_tasks, missing.size());
      const std::vector<std::size_t> part(missing.begin() + static_cast<std::ptrdiff_t>(begin),
                                          missing.begin() + static_cast<std::ptrdiff_t>(end));
      const std::string name = "attempt-" + std::to_string(attempt) + "-" + std::to_string(begin);
      BITELINE_ASSIGN(const fs::path script, write_script(run, folder, part, name));
      BITELINE_ASSIGN(const std::string job, submit(script, part.size(), options));
      BITELINE_TRY(wait_for(job, run, part, options, progress, stop));
    }
    missing = missing_shards(run);
  }
  if (missing.empty()) return {};
  return fail(Errc::ProcessDied, "%zu shards left no result after %d attempts, the first is %zu; see %.140s",
              missing.size(), options.attempts, missing.front(), folder.c_str());
}

}  // namespace biteline::batch
