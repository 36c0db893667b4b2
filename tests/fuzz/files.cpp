// SPDX-License-Identifier: MIT
// fuzz_files FOLDER CASES SECONDS SEED: the real tool on files that were good once.
//
// A session is recorded by the cell, replayed, and its files spoiled one at a time; each case is one run of
// `biteline`. It must end by itself with 0, 2, 3 or 4, within 20 s of processor time and 1 GB, and say at
// most two lines.  Ends after CASES or SECONDS, whatever comes first; the folder of a case that breaks a rule
// stays.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <vector>

#include "host/robot/link/gate/gate_file.hpp"
#include "tests/fuzz/mutate.hpp"

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

namespace {

constexpr rlim_t k_cpu_s = 20;
constexpr long k_memory_kb = 1024 * 1024;
/// Wall time of a machine that does other things, too: a program that waits for ever is found by it.
constexpr unsigned k_wall_s = 300;

struct Ended {
  int status{0};
  bool by_itself{false};
  long memory_kb{0};
  double cpu_s{0};
  std::string said;
};

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void put(const fs::path& file, const std::string& bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

/// What makes the good files may take its time; what is judged may not.
enum class Limits { None, Judged };

Ended run(const std::string& program, const Arguments& arguments, const fs::path& errors, Limits limits) {
  const pid_t child = fork();
  if (child == 0) {
    const int nothing = open("/dev/null", O_RDWR),
              out = open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(nothing, 0);
    dup2(nothing, 1);
    dup2(out, 2);
    const rlimit core{.rlim_cur = 0, .rlim_max = 0};
    setrlimit(RLIMIT_CORE, &core);
    if (limits == Limits::Judged) {
      const rlimit cpu{.rlim_cur = k_cpu_s + 1, .rlim_max = k_cpu_s + 2};
      setrlimit(RLIMIT_CPU, &cpu);
      alarm(k_wall_s);
    }
    std::vector<char*> words{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    execv(program.c_str(), words.data());
    _exit(127);
  }
  Ended ended;
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child) return ended;
  ended.by_itself = WIFEXITED(status);
  ended.status = ended.by_itself ? WEXITSTATUS(status) : WTERMSIG(status);
  ended.memory_kb = usage.ru_maxrss;
  ended.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  ended.said = content(errors);
  return ended;
}

/// What was good once.  `work` is the case's own folder: the session and the results in it are whole but for
/// one file.
struct Kind {
  std::string name;
  fs::path good;     ///< the file that is spoiled
  fs::path spoiled;  ///< where it goes
  Arguments arguments;
  unsigned long long cases{0};
  double cpu_s{0};
};

struct Places {
  std::string tool;
  fs::path good, work, processes;
};

std::vector<Kind> kinds(const Places& places, bool with_calibration) {
  const fs::path session = places.good / "session", result = places.good / "result";
  const fs::path copy = places.work / "session", sample = places.work / "sample";
  const std::string out = places.work / "out", grind = places.processes / "grind.yaml";
  const std::string line = result / "line.csv", cloud = result / "cloud.ply";
  const fs::path one = places.work / "spoiled";
  const Arguments plan{"plan", line, "--robot", "UR5e", "--out", out};
  const auto with = [](Arguments first, const Arguments& more) {
    first.insert(first.end(), more.begin(), more.end());
    return first;
  };
  std::vector<Kind> all;
  for (const char* process : {"grind.yaml", "cement.yaml", "rough.yaml", "spray.yaml"})
    all.push_back({"plan, process", places.processes / process, one, with(plan, {"--process", one})});
  all.push_back(
      {"plan, line", line, one, {"plan", one, "--robot", "UR10e", "--process", grind, "--out", out}});
  all.push_back({"plan, cloud", cloud, one, with(plan, {"--process", grind, "--cloud", one})});
  all.push_back({"plan, scan", session / "cam0/sensor.yaml", one, with(plan, {"--scan", one})});
  all.push_back({"plan, touches", places.good / "touches.csv", one,
                 with(plan, {"--process", grind, "--touches", one})});
  all.push_back({"extract", cloud, one, {"extract", one, "--out", out}});
  for (const char* file : {"cam0/sensor.yaml", "cam0/data.csv", "pose0/data.csv"})
    all.push_back(
        {std::string{"replay, "} + file, session / file, copy / file, {"replay", copy, "--out", out}});
  const fs::path picture =
      fs::path{"cam0/data"} / fs::directory_iterator(session / "cam0/data")->path().filename();
  all.push_back({"replay, picture", session / picture, copy / picture, {"replay", copy, "--out", out}});
  const Arguments transfer{"transfer", "--sample", sample, "--upper", cloud, "--out", out};
  all.push_back({"transfer, sample's line", line, sample / "line.csv", transfer});
  all.push_back({"transfer, sample's cloud", cloud, sample / "cloud.ply", transfer});
  all.push_back(
      {"transfer, upper", cloud, one, {"transfer", "--sample", result, "--upper", one, "--out", out}});
  all.push_back(
      {"evaluate, line", line, one, {"evaluate", "--line", one, "--truth", session / "truth/groove.csv"}});
  all.push_back(
      {"evaluate, truth", session / "truth/groove.csv", one, {"evaluate", "--line", line, "--truth", one}});
  all.push_back({"evaluate, surface",
                 places.good / "mesh.ply",
                 one,
                 {"evaluate", "--cloud", places.good / "few.ply", "--surface", one}});
  all.push_back({"model",
                 places.good / "library/shoe/model.json",
                 places.work / "library/shoe/model.json",
                 {"transfer", "--sample", "shoe", "--library", places.work / "library", "--upper", cloud,
                  "--out", out}});
  all.push_back({"explain",
                 places.good / "scan/gate.json",
                 places.work / "scan/gate.json",
                 {"explain", places.work / "scan"}});
  const fs::path keys = places.work / "keys";
  all.push_back({"keys, allow's key",
                 places.good / "host/host.public",
                 one,
                 {"keys", "allow", "--keys", keys, "right", one}});
  all.push_back({"keys, hosts.allowed",
                 places.good / "keys/hosts.allowed",
                 keys / "hosts.allowed",
                 {"keys", "revoke", "--keys", keys, "left"}});
  all.push_back({"keys, secret",
                 places.good / "keys/sensor.secret",
                 keys / "sensor.secret",
                 {"keys", "rotate", "--sensor", "--keys", keys}});
  if (!with_calibration) return all;
  const fs::path head = places.good / "head", head_copy = places.work / "head";
  for (const char* file : {"laser/target.yaml", "laser/00_rings.png", "laser/00_laser.png",
                           "handeye/poses.csv", "handeye/01.png"}) {
    if (fs::exists(head / file))
      all.push_back({std::string{"calibrate, "} + file,
                     head / file,
                     head_copy / file,
                     {"calibrate", head_copy, "--out", out}});
  }
  return all;
}

std::string shown(const std::string& program, const Arguments& arguments) {
  std::string text = program;
  for (const std::string& argument : arguments) text += " " + argument;
  return text;
}

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "fuzz_files: %s\n", why.c_str());
  std::exit(2);
}

/// By the tree's own programs; each must do its work here.
void make_good(const Places& places, const std::string& cell, bool with_calibration) {
  const fs::path errors = places.good / "errors";
  const auto must = [&](const std::string& program, const Arguments& arguments) {
    const Ended ended = run(program, arguments, errors, Limits::None);
    if (!ended.by_itself || ended.status != 0) give_up(shown(program, arguments) + ": " + ended.said);
  };
  const std::string session = places.good / "session", result = places.good / "result";
  must(cell, {"record", "--seed", "5", "--rate-hz", "40", "--speed-mm-s", "200", "--out", session});
  must(places.tool, {"replay", session, "--out", result});
  must(places.tool, {"model", "save", "shoe", result, "--library", places.good / "library"});
  if (with_calibration) must(cell, {"record-calibration", "--out", places.good / "head"});
  must(places.tool, {"keys", "make", "--keys", places.good / "host"});
  must(places.tool, {"keys", "make", "--sensor", "--keys", places.good / "keys"});
  must(places.tool,
       {"keys", "allow", "--keys", places.good / "keys", "left", places.good / "host/host.public"});
  fs::create_directories(places.good / "scan");
  if (!biteline::robot::write_gate(places.good / "scan/gate.json", {})) give_up("no gate.json");
  std::string touches;
  for (int i = 0; i < 6; ++i)
    touches +=
        std::to_string(i) + "," + std::to_string(300 + i) + "," + std::to_string(10 * i) + ",200,1,0,0,0\n";
  put(places.good / "touches.csv", touches);
  put(places.good / "mesh.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n10 0 0\n0 10 0\n10 10 1\n3 0 1 2\n3 1 3 2\n");
  put(places.good / "few.ply",
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n"
      "1 2 0.1\n5 5 0.2\n");
  fs::copy(session, places.work / "session", fs::copy_options::recursive);
  fs::copy(result, places.work / "sample", fs::copy_options::recursive);
  fs::copy(places.good / "library", places.work / "library", fs::copy_options::recursive);
  for (const char* name : {"keys", "scan"})
    fs::copy(places.good / name, places.work / name, fs::copy_options::recursive);
  if (with_calibration) fs::copy(places.good / "head", places.work / "head", fs::copy_options::recursive);
}

/// Nothing: the case keeps the rules.
std::string broken(const Ended& ended) {
  if (!ended.by_itself) return "ended by signal " + std::to_string(ended.status);
  if (ended.status != 0 && (ended.status < 2 || ended.status > 4))
    return "exit " + std::to_string(ended.status);
  if (ended.cpu_s > k_cpu_s) return "took " + std::to_string(ended.cpu_s) + " s";
  if (ended.memory_kb > k_memory_kb) return "took " + std::to_string(ended.memory_kb / 1024) + " MB";
  if (std::ranges::count(ended.said, '\n') > 2) return "said more than two lines";
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) give_up("FOLDER CASES SECONDS SEED expected");
  constexpr unsigned long long k_with_calibration = 1000;  // its pictures take a minute to make
  const unsigned long long cases = std::strtoull(argv[2], nullptr, 10);
  const bool with_calibration = cases >= k_with_calibration;
  const auto until =
      std::chrono::steady_clock::now() + std::chrono::seconds{std::strtol(argv[3], nullptr, 10)};
  const fs::path folder = fs::absolute(argv[1]);
  const Places places{.tool = BITELINE_TOOL,
                      .good = folder / "good",
                      .work = folder / "work",
                      .processes = BITELINE_PROCESSES};
  fs::remove_all(folder);
  fs::create_directories(places.good);
  fs::create_directories(places.work);
  make_good(places, BITELINE_CELL, with_calibration);
  biteline::fuzz::Mutator mutator{std::strtoull(argv[4], nullptr, 10)};
  std::vector<Kind> all = kinds(places, with_calibration);
  std::map<int, unsigned long long> by_status;
  double most_s = 0;
  long most_kb = 0;
  unsigned long long done = 0;
  int bad = 0;
  for (; done < cases && std::chrono::steady_clock::now() < until; ++done) {
    // Each kind has its share of the time, so the quick ones make more cases.
    Kind& kind = done < all.size()
                     ? all[done]
                     : *std::ranges::min_element(all, {}, [](const Kind& each) { return each.cpu_s; });
    const std::string good = content(kind.good);
    put(kind.spoiled, mutator.mutated(good, good));
    const Ended ended = run(places.tool, kind.arguments, places.work / "errors", Limits::Judged);
    ++by_status[ended.by_itself ? ended.status : -ended.status];
    most_s = std::max(most_s, ended.cpu_s);
    most_kb = std::max(most_kb, ended.memory_kb);
    kind.cpu_s += ended.cpu_s;
    ++kind.cases;
    if (const std::string why = broken(ended); !why.empty()) {
      const fs::path kept = folder / ("case-" + std::to_string(done));
      fs::create_directories(kept);
      fs::copy_file(kind.spoiled, kept / kind.spoiled.filename(), fs::copy_options::overwrite_existing);
      std::printf("%s: %s; file in %s\n  %s\n  %.300s\n", kind.name.c_str(), why.c_str(), kept.c_str(),
                  shown(places.tool, kind.arguments).c_str(), ended.said.c_str());
      ++bad;
    }
    put(kind.spoiled, good);
    fs::remove_all(places.work / "out");
  }
  for (const Kind& kind : all)
    std::printf("%-28s %8llu files %8.1f s\n", kind.name.c_str(), kind.cases, kind.cpu_s);
  std::printf("%llu spoiled files of %zu kinds; %d broke a rule; at most %.1f s and %ld MB; by exit status:",
              done, all.size(), bad, most_s, most_kb / 1024);
  for (const auto& [status, count] : by_status) std::printf(" %d: %llu", status, count);
  std::printf("\n");
  return bad == 0 && done > 0 ? 0 : 1;
}
