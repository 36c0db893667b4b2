// SPDX-License-Identifier: MIT
#pragma once
/// \file The API over a fake cell, with one person of each role.
#include <CppUTest/TestHarness.h>

#include "host/cloud/ply.hpp"
#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "tests/support/api_answers.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::api {

inline constexpr const char* k_password = "a long password";

struct FakeCell final : Cell {
  std::vector<std::string> did;
  std::filesystem::path results{};  ///< of the scan that is worked out again
  Result<void> next{};
  std::uint64_t stops{99};  ///< of the last order
  Job job{};                ///< of the last start
  std::string held{};       ///< the scan that waits, where the state is to tell of one
  std::string process_by{};

  Json state() override {
    Json lamps;
    for (const char* name : {"laser", "camera", "robot", "poses", "clock"})
      lamps[name] = {{"level", "ok"}, {"words", "as it should be"}};
    Json state{{"version", "1.2.3"},      {"phase", "waiting"},  {"now", "waits"},
               {"next", "the next scan"}, {"progress", nullptr}, {"lamps", std::move(lamps)}};
    if (held.empty()) return state;
    state["held"] = {{"scan", held}, {"waits_for", "word"}, {"fresh_s", nullptr}, {"sendable", true}};
    state["process_by"] = or_null(process_by);
    return state;
  }
  Json robots() override { return Json::array(); }
  Json sensors() override { return Json::array(); }
  void stop(const std::string& who) override { did.push_back("stop " + who); }
  void laser_off(const std::string& who) override { did.push_back("laser off " + who); }
  Result<void> start(const Job& job, const Speaker& who) override {
    stops = who.stops;
    did.push_back("start " + who.name + " " + job.process + (job.hold ? " held" : ""));
    this->job = job;
    return next;
  }
  Result<void> rescan(const Rescan& order) override {
    stops = order.stops;
    did.push_back("rescan " + order.who + (order.hold ? " held" : ""));
    return next;
  }
  Result<void> begin_mend(const std::string& scan) override {
    did.push_back("begin mend " + scan);
    return next;
  }
  void end_mend(const std::string& scan, bool mended, const Speaker& who) override {
    stops = who.stops;
    did.push_back("end mend " + scan + (mended ? " yes " : " no ") + who.name);
  }
  Result<void> change_settings(const std::vector<SettingChange>& changes, const std::string& who) override {
    for (const SettingChange& change : changes)
      did.push_back("set " + settings::path_of(change.key) + " " +
                    (change.value ? settings::value_text(change.key, *change.value) : "none") + " " + who);
    return next;
  }
  Result<std::string> keep_recording(bool following, const std::string& who) override {
    did.push_back(std::string{"keep "} + (following ? "next " : "last ") + who);
    if (!next) return tl::unexpected<Error>{next.error()};
    return std::string{following ? "the scan that ends next" : "/data/scan-2"};
  }
  bool on_demand() override { return jobs; }
  line_control::LineState line_state() override {
    line_control::LineState state;
    state.job = chosen;
    state.next_part = next_part;
    return state;
  }
  std::optional<Job> job_of(int number) override {
    if (number < 1 || number > 3) return std::nullopt;
    return Job{.model = number == 3 ? "not-there" : "", .process = number == 2 ? "not-there" : ""};
  }
  line_control::Refusal choose_job(int number, bool control_held) override {
    if (control_held) return line_control::Refusal::ControlHeld;
    chosen = number;
    return line_control::Refusal::None;
  }
  LineStart start_for_line(int request, bool control_held, std::uint64_t heard) override {
    stops = heard;
    did.push_back("line start " + std::to_string(request) + (control_held ? " held" : ""));
    return {.refusal = line_control::Refusal::None, .fresh = true};
  }
  line_control::Refusal choose_part(const std::string& part, bool control_held) override {
    if (control_held) return line_control::Refusal::ControlHeld;
    next_part = part;
    return line_control::Refusal::None;
  }
  bool jobs{true};
  int chosen{0};
  std::string next_part{};

  Result<void> choose_model(const std::string& scan, const std::string& model, const Speaker& who) override {
    stops = who.stops;
    did.push_back("model " + scan + " " + model + " " + who.name);
    return next;
  }
  Result<void> choose_process(const std::string& scan, const std::string& process,
                              const Speaker& who) override {
    stops = who.stops;
    did.push_back("process " + scan + " " + process + " " + who.name);
    return next;
  }
  Result<void> run_in_air(const std::string& scan, const Speaker& who) override {
    stops = who.stops;
    did.push_back("air " + scan + " " + who.name);
    return next;
  }
  Result<void> look_again(const std::string& scan, const Speaker& who) override {
    stops = who.stops;
    did.push_back("look " + scan + " " + who.name);
    return next;
  }
  void model_saved(const std::string& process_sha256, const std::string& who) override {
    did.push_back("saved " + process_sha256.substr(0, 8) + " " + who);
  }
  void tool_mounted() override { did.push_back("tool mounted"); }
  Result<int> rerun(const RerunOrder& order) override {
    did.push_back("rerun " + order.scan + " " + order.who + " " + test::text_of(settings_json(order)));
    if (!next) return tl::unexpected<Error>{next.error()};
    return keep_order(results, order);
  }
  Result<TriedPath> try_process(const std::string& scan, const path::Process& process) override {
    did.push_back("try " + scan + " " + process.name);
    if (!next) return tl::unexpected<Error>{next.error()};
    return tried;
  }
  TriedPath tried{};
  Result<robot::ur::ArmLook> look_at_arm() override {
    if (!next) return tl::unexpected<Error>{next.error()};
    return look;
  }
  robot::ur::ArmLook look{};
  bool rerun_open(const std::string&, int number) override { return number > 1; }
  Result<void> decide(const Decision& decision) override {
    stops = decision.stops;
    did.push_back("decide " + decision.scan + " " + decision.who + " " + decision.door + " " + decision.why);
    return next;
  }
};

struct ApiWorld : Utest {
  test::TemporaryFolder folder;
  Result<memory::Memory> memory{memory::Memory::open(folder.path() / memory::k_memory_file)};
  accounts::Accounts accounts{*memory};
  FakeCell cell;
  std::vector<std::string> events;
  Api sut{Rooms{.memory = *memory,
                .accounts = accounts,
                .cell = cell,
                .results = folder.path(),
                .processes = ProcessStore{BITELINE_PROCESSES, folder.path() / "processes"},
                .models = transfer::Library{folder.path() / "models"},
                .exchange = Exchange{folder.path() / ".exchange"},
                .version = "1.2.3",
                .publish = [this](const std::string& name, const Json&) { events.push_back(name); },
                .last_seq = [] { return std::uint64_t{7}; },
                .catalogue = [this] { return catalogue; }}};
  /// What scans are worked with: at first the cell's own.
  Result<Catalogue> catalogue{
      Catalogue{.release = {},
                .models = transfer::Library{folder.path() / "models"},
                .processes = ProcessStore{BITELINE_PROCESSES, folder.path() / "processes"}}};
  std::string token;
  bool local{false};
  std::uint64_t heard{0};

  void setup() override {
    SUCCEEDS(accounts.add("ada", accounts::Role::Administrator, k_password, "ada", "web"));
    for (const auto& [name, role] :
         {std::pair{"vic", accounts::Role::Viewer}, std::pair{"ana", accounts::Role::Operator},
          std::pair{"eng", accounts::Role::Engineer}})
      SUCCEEDS(accounts.add(name, role, k_password, "ada", "web"));
  }
  /// Report, cloud and line of three points: enough for a model to be kept.
  void write_sample(const std::string& where) {
    folder.write(where + "/report.json", R"({"status":"ok"})");
    cloud::PointCloud cloud;
    for (int i = 0; i < 9; ++i) cloud.points.emplace_back(static_cast<float>(i), 0.0F, 1.0F);
    SUCCEEDS(cloud::write_cloud(folder.path() / where / "cloud.ply", cloud));
    cloud::ClosedLine line;
    for (const Vec3& position : {Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{0, 4, 0}})
      line.points.push_back(
          {.position = position, .normal = Vec3::UnitZ(), .tangent = Vec3::UnitX(), .confidence = 1});
    SUCCEEDS(cloud::write_line(folder.path() / where / "line.csv", line));
  }
  control::Answer ask(const std::string& method, const std::string& path, Json body = {},
                      std::map<std::string, std::string> query = {}) {
    control::Request request;
    request.token = token;
    request.local = local;
    request.stops = heard;
    request.door = "web";
    request.method = method;
    request.path = "/api/v1" + path;
    request.body = std::move(body);
    request.query = std::move(query);
    control::Answer answer = sut.ordinary(request);
    // What only passes between programs is not described.
    if (!path.starts_with("/exchange/"))
      test::note_answer(method, path, answer.status, answer.type, answer.body);
    return answer;
  }
  void log_in(const std::string& name) {
    const control::Answer answer = ask("POST", "/sessions", {{"name", name}, {"password", k_password}});
    LONGS_EQUAL(201, answer.status);
    token = answer.body["token"].get<std::string>();
  }
  static std::string code_of(const control::Answer& answer) {
    return answer.body["error"]["code"].get<std::string>();
  }
  void put(const std::string& name, const std::string& verdict) {
    memory::Scan scan;
    scan.name = name;
    scan.time = 1'000'000;
    scan.verdict = verdict;
    memory::LogRow event;
    event.who = "service";
    SUCCEEDS(memory->put_scan(scan, event));
  }
};

}  // namespace biteline::api
