// SPDX-License-Identifier: MIT
// The service before an arm: what it must never send, and what must never end it.
#include <CppUTest/TestHarness.h>

#include <csignal>
#include <numbers>
#include <sstream>

#include "host/cloud/closed_line.hpp"
#include "host/cloud/ply.hpp"
#include "host/records/memory/factory_day.hpp"
#include "host/records/memory/memory.hpp"
#include "host/transfer/library.hpp"
#include "tests/integration/robot/service_with_arm.hpp"

namespace biteline {

TEST_GROUP_BASE(ServiceAndRobot, ServiceWithArm){};

TEST(ServiceAndRobot, OldRecordingIsWorkedOutAndNeverSent) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = start(sending(k_no_sensor), {"--once"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), status);
  STRCMP_CONTAINS("--confirm scan-0001", said.c_str());
  CHECK(fs::exists(scan / "line.csv"));
  CHECK(fs::exists(scan / "path/path.csv"));
  CHECK(controller.script().empty());
  STRCMP_CONTAINS("scan_not_seen", reasons_of(scan).c_str());
  CHECK(fs::exists(scan / "scan.btln"));  // a person may still say so
}

/// A word is for a scan that lies there, by its plain name: never for one that is still to come.
TEST(ServiceAndRobot, AWordForAScanThatIsNotThereEndsTheStartAndSaysSo) {
  const fs::path scan = leave_scan("scan-0001");
  fs::create_directory_symlink(scan, results() / "scan-0003");
  fs::create_directories(results() / "scan-0004");
  for (const char* name : {"scan-0002", "scan-0003", "scan-0004", "Scan-0001", "scan-0001/", "./scan-0001",
                           "../results/scan-0001", "scan-1", " scan-0001"}) {
    ChildProcess host = start(sending(k_no_sensor), {"--once", "--confirm", name});
    const auto [status, said] = end_of(host);
    LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::BadInput), status, name);
    STRCMP_CONTAINS("--confirm", host.last_words().c_str());
  }
  CHECK(!fs::exists(scan / "report.json"));
  CHECK(controller.script().empty());
}

/// A service that comes back with the same command vouches for nothing that came in meanwhile under that
/// name.
TEST(ServiceAndRobot, AWordIsForOneScanByItsNumberAndNotForAnotherOfItsName) {
  const fs::path scan = leave_scan("scan-0001");
  {
    ChildProcess first =
        start(sending(k_no_sensor), {"--once", "--confirm", "scan-0001", "--keep-recording"});
    static_cast<void>(end_of(first));
  }
  const std::string sent = controller.script();
  CHECK(!sent.empty());
  // The folder is gone, and with it what stood beside the scan: the memory still knows the number.
  fs::remove_all(scan);
  leave_scan("scan-0001");
  leave_scan("scan-0002");
  for (const char* name : {"scan-0001", "scan-0002"}) {
    ChildProcess again = start(sending(k_no_sensor), {"--once", "--confirm", name});
    LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::BadInput), end_of(again).first, name);
    STRCMP_CONTAINS("used up", again.last_words().c_str());
  }
  CHECK_EQUAL(sent, controller.script());
}

TEST(ServiceAndRobot, OldRecordingIsSentWhenAPersonSaysItsName) {
  leave_scan("scan-0001");
  ChildProcess other = start(sending(k_no_sensor), {"--once"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), end_of(other).first);
  CHECK(controller.script().empty());
  // It has a report by now; the name brings it up again.
  ChildProcess named = start(sending(k_no_sensor), {"--once", "--confirm", "scan-0001"});
  static_cast<void>(end_of(named));  // this controller never begins the program
  STRCMP_CONTAINS("def biteline_path():", controller.script().c_str());
  const nlohmann::json gate = gate_of(results() / "scan-0001");
  CHECK(gate.value("permitted", false));
  CHECK(!gate["inputs"]["scan"]["confirmed"].value("by", "").empty());
  CHECK(!gate["inputs"]["scan"]["confirmed"].value("at", "").empty());
}

TEST(ServiceAndRobot, WordCountsForOneSending) {
  leave_scan("scan-0001");
  ChildProcess first = start(sending(k_no_sensor), {"--once", "--confirm", "scan-0001", "--keep-recording"});
  static_cast<void>(end_of(first));
  const std::string sent = controller.script();
  CHECK(!sent.empty());
  for (int again = 0; again < 2; ++again) {
    // With a new memory, too: what was decided stands beside the scan.
    if (again == 1) fs::remove(results() / "memory.sqlite");
    ChildProcess second =
        start(sending(k_no_sensor), {"--once", "--confirm", "scan-0001", "--keep-recording"});
    LONGS_EQUAL(static_cast<int>(ExitStatus::BadInput), end_of(second).first);
    STRCMP_CONTAINS("used up", second.last_words().c_str());
  }
  CHECK_EQUAL(sent, controller.script());
}

/// Of path.csv, its first row.
double first_base_rad(const fs::path& path) {
  std::ifstream stream{path};
  std::string row;
  while (std::getline(stream, row) && (row.empty() || row[0] == '#')) {
  }
  std::istringstream cells{row};
  std::string cell;
  for (int i = 0; i <= 10; ++i) std::getline(cells, cell, ',');
  return std::stod(cell);
}

TEST(ServiceAndRobot, PathBeginsAtTheTurnOfTheBaseWhereTheArmStood) {
  std::vector<double> begun_rad;
  for (const double base_rad : {-5.0, 5.0}) {
    FakeController turned{[=](robot::test::PlayedState& state) { state.q[0] = base_rad; }, 0.002};
    const fs::path scan = leave_scan(base_rad < 0 ? "scan-0001" : "scan-0002");
    std::vector<std::string> all = sending(k_no_sensor);
    *(std::ranges::find(all, "--rtde") + 1) = "127.0.0.1:" + std::to_string(turned.rtde_port());
    ChildProcess host = start(all, {"--once"});
    static_cast<void>(end_of(host));
    begun_rad.push_back(first_base_rad(scan / "path/path.csv"));
  }
  DOUBLES_EQUAL(2 * std::numbers::pi, begun_rad[1] - begun_rad[0], 1e-6);
}

TEST(ServiceAndRobot, LineThatLiesOffTheModelsMendedOneIsTold) {
  const fs::path sample = leave_scan("scan-0001");
  ChildProcess first = start(sending(k_no_sensor), {"--once"});
  static_cast<void>(end_of(first));
  // A model whose line a person has put 3 mm higher over 60 points: on no crease that the scan shows.
  auto line = cloud::read_line(sample / "line.csv");
  SUCCEEDS(line);
  for (std::size_t i = 100; i < 160; ++i) {
    line->points[i].position.z() += 3;
    line->points[i].source = cloud::PointSource::Mended;
    line->points[i].u95_mm = 0.5;
  }
  SUCCEEDS(cloud::write_line(sample / "line.csv", *line));
  SUCCEEDS(transfer::Library{folder.path() / "models"}.save("boot", sample));

  const fs::path scan = leave_scan("scan-0002");
  ChildProcess second =
      start(sending(k_no_sensor), {"--once", "--models", "--library", (folder.path() / "models").string()});
  STRCMP_CONTAINS("off the mended line of boot", end_of(second).second.c_str());
  const nlohmann::json prior = report_of(scan)["prior"];
  STRCMP_EQUAL("line_off_mended", prior.value("reason_code", "").c_str());
  LONGS_EQUAL(1, prior.value("candidate", 0));
  DOUBLES_EQUAL(3, prior.value("most_mm", 0.0), 0.8);
  CHECK(prior.value("beyond_mm", 0.0) > 10);
  // Told, and the line stays as the scan shows it.
  const auto found = cloud::read_line(scan / "line.csv");
  SUCCEEDS(found);
  for (const cloud::LinePoint& point : found->points) CHECK(point.source != cloud::PointSource::Mended);
}

/// What a left shoe of one size less would have left: the scan's result, mirrored and two thirds of a
/// centimetre shorter.  As wide as long, since nobody knows here how it stood.
transfer::SampleFiles smaller_left_of(const fs::path& scan) {
  auto sample = transfer::read_sample(scan);
  SUCCEEDS(sample);
  double length_mm = 0;
  for (const cloud::LinePoint& p : sample->line.points)
    for (const cloud::LinePoint& q : sample->line.points)
      length_mm = std::max(length_mm, (p.position - q.position).head<2>().norm());
  const double change = 20.0 / 3 / length_mm;
  const Vec3 factors{1 / (1 + change), -1 / (1 + change), 1 / (1 + change / 2)};
  for (Eigen::Vector3f& p : sample->cloud.points) p = p.cwiseProduct(factors.cast<float>());
  for (cloud::LinePoint& p : sample->line.points) {
    p.position = p.position.cwiseProduct(factors);
    p.normal = p.normal.cwiseQuotient(factors).normalized();
    p.tangent = -p.tangent.cwiseProduct(factors).normalized();
  }
  std::ranges::reverse(sample->line.points);
  return *sample;
}

TEST(ServiceAndRobot, AShoeOfTheOtherFootAndAnotherSizeIsKnown) {
  const fs::path first_scan = leave_scan("scan-0001");
  ChildProcess first = start(sending(k_no_sensor), {"--once"});
  static_cast<void>(end_of(first));
  const transfer::SampleFiles sample = smaller_left_of(first_scan);
  const fs::path left = folder.path() / "left";
  fs::create_directories(left);
  SUCCEEDS(cloud::write_cloud(left / "cloud.ply", sample.cloud));
  SUCCEEDS(cloud::write_line(left / "line.csv", sample.line));
  transfer::SaveOptions told;
  told.made.foot = "left";
  told.made.size = "EU 41";
  told.made.of = "boot";
  SUCCEEDS(transfer::Library{folder.path() / "models"}.save("boot-41", left, told));

  const fs::path scan = leave_scan("scan-0002");
  ChildProcess second =
      start(sending(k_no_sensor), {"--once", "--models", "--library", (folder.path() / "models").string()});
  STRCMP_CONTAINS("looks like boot, right, EU 42", end_of(second).second.c_str());
  STRCMP_EQUAL("right", report_of(scan).value("foot", "").c_str());
  STRCMP_EQUAL("EU 42", report_of(scan).value("size", "").c_str());
  const auto memory = memory::Memory::open(results() / memory::k_memory_file);
  SUCCEEDS(memory);
  const auto row = memory->scan("scan-0002");
  SUCCEEDS(row);
  STRCMP_EQUAL("boot", (*row)->model.c_str());
  STRCMP_EQUAL("right", (*row)->foot.c_str());
  STRCMP_EQUAL("EU 42", (*row)->size.c_str());
}

TEST(ServiceAndRobot, ArmInLocalControlOrAnotherArmIsSentNothing) {
  leave_scan("scan-0001");
  controller.answers["is in remote control"] = "false";
  controller.answers["get robot model"] = "UR10";
  ChildProcess host =
      start(sending(k_no_sensor), {"--once", "--confirm", "scan-0001", "--serial", "20215500002"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), status);
  const std::string reasons = reasons_of(results() / "scan-0001");
  for (const char* reason : {"not_remote", "other_arm", "other_serial"})
    STRCMP_CONTAINS(reason, reasons.c_str());
  CHECK(reasons.find("scan_") == std::string::npos);
  CHECK(controller.script().empty());
}

TEST(ServiceAndRobot, ScanOfARecordingIsNotSent) {
  const auto sensor = recorded().sensor_of_it();
  ChildProcess host = start(sending(sensor.endpoint().text()), {"--once"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), status);
  STRCMP_CONTAINS("of a recording", said.c_str());
  CHECK(controller.script().empty());
}

TEST(ServiceAndRobot, ScanThatKilledTheServiceIsSetAsideAndTheNextOneGoesOn) {
  const fs::path deadly = leave_scan("scan-0001"), next = leave_scan("scan-0002");
  {
    ChildProcess host = start(arguments(k_no_sensor), {});
    while (host.running() && !fs::exists(deadly / "scan.attempt")) std::this_thread::yield();
    ::kill(host.pid(), SIGSEGV);
    SUCCEEDS(host.wait(k_patience));
  }
  CHECK(!fs::exists(deadly / "report.json"));
  ChildProcess successor = start(arguments(k_no_sensor), {"--once"});
  const auto [status, said] = end_of(successor);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Done), status);
  STRCMP_CONTAINS("scan-0001 is set aside", said.c_str());
  // Each shoe has its row before the next one is begun: in the order in which they came.
  const auto memory = memory::Memory::open_to_read(results() / memory::k_memory_file);
  SUCCEEDS(memory);
  const auto rows = memory->scans({});
  SUCCEEDS(rows);
  LONGS_EQUAL(2, rows->scans.size());
  STRCMP_EQUAL("scan-0001", rows->scans.back().name.c_str());
  STRCMP_EQUAL("scan_set_aside", rows->scans.back().reason_code.c_str());
  STRCMP_EQUAL("", rows->scans.back().process.c_str());
  STRCMP_EQUAL("scan_set_aside", report_of(deadly).value("reason_code", "").c_str());
  CHECK(fs::exists(deadly / "scan.btln"));
  CHECK(fs::exists(next / "line.csv"));
}

TEST(ServiceAndRobot, AJournalThatNobodyCanReadIsSetAsideWithItsRowAndTheNextOneGoesOn) {
  const fs::path broken = results() / "scan-0001";
  fs::create_directories(broken);
  std::ofstream{broken / "scan.btln"} << "no journal of ours, but some bytes";
  const fs::path next = leave_scan("scan-0002");
  ChildProcess host = start(arguments(k_no_sensor), {"--once"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Done), end_of(host).first);
  STRCMP_EQUAL("scan_set_aside", report_of(broken).value("reason_code", "").c_str());
  const auto memory = memory::Memory::open_to_read(results() / memory::k_memory_file);
  SUCCEEDS(memory);
  const auto row = memory->scan("scan-0001");
  CHECK(row && *row);
  STRCMP_EQUAL("refused", (*row)->verdict.c_str());
  CHECK(fs::exists(next / "line.csv"));
}

/// As it is left by a stop on the way: the sensor ended it, and so it looks like a scan that came to its end.
TEST(ServiceAndRobot, AScanThatAPersonStoppedIsJudgedAsNoShoe) {
  const fs::path scan = leave_scan("scan-0001");
  std::ofstream{scan / "scan.stopped"} << "ada\n";
  ChildProcess host = start(sending(k_no_sensor), {"--once"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), end_of(host).first);
  const nlohmann::json report = report_of(scan);
  STRCMP_EQUAL("stopped_by_a_person", report.value("reason_code", "").c_str());
  STRCMP_CONTAINS("stopped by ada after", report.value("reason", "").c_str());
  CHECK(fs::exists(scan / "cloud.ply"));
  CHECK(!fs::exists(scan / "line.csv"));
  const auto memory = memory::Memory::open_to_read(results() / memory::k_memory_file);
  SUCCEEDS(memory);
  const auto trends = memory->trends({}, memory::FactoryDay{}, memory::Span::Day);
  SUCCEEDS(trends);
  CHECK(trends->buckets.empty());
  CHECK(trends->reasons.empty());
  CHECK(controller.script().empty());
  // The maintainer's question is mostly about such scans.
  const fs::path biteline = host_program().parent_path() / "biteline";
  auto explain = ChildProcess::start({.program = biteline, .arguments = {"explain", scan.string()}});
  SUCCEEDS(explain);
  const auto [explained, words] = end_of(*explain);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), explained);
  STRCMP_CONTAINS("stopped by ada", words.c_str());
  STRCMP_CONTAINS("next: start, when the cell is clear", words.c_str());
}

TEST(ServiceAndRobot, ExplainFailsNoRowThatWasNotLookedAt) {
  const fs::path scan = leave_scan("scan-0001");
  ChildProcess host = start(sending(k_no_sensor), {"--once"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), end_of(host).first);
  const fs::path biteline = host_program().parent_path() / "biteline";
  auto explain = ChildProcess::start({.program = biteline, .arguments = {"explain", scan.string()}});
  SUCCEEDS(explain);
  const auto [explained, words] = end_of(*explain);
  LONGS_EQUAL(static_cast<int>(ExitStatus::Refused), explained);
  STRCMP_CONTAINS("FAILED         scan seen coming in", words.c_str());
  for (const char* row : {"remote control", "path's checks", "arm since the check"})
    STRCMP_CONTAINS((std::string{"not looked at  "} + row).c_str(), words.c_str());
  CHECK(words.find("pendant") == std::string::npos);
}

TEST(ServiceAndRobot, ScanThatIsSetAsideIsNotTouchedAgain) {
  const fs::path scan = leave_scan("scan-0001");
  std::ofstream{scan / "scan.attempt"} << "process 1\n";
  const auto sensor = recorded().sensor_of_it();
  for (int restart = 0; restart < 2; ++restart) {
    ChildProcess host = start(arguments(sensor.endpoint().text()), {"--once"});
    LONGS_EQUAL(static_cast<int>(ExitStatus::Done), end_of(host).first);
  }
  STRCMP_EQUAL("scan_set_aside", report_of(scan).value("reason_code", "").c_str());
  CHECK(!fs::exists(scan / "line.csv"));
  CHECK(fs::exists(results() / "scan-0003/line.csv"));
}

TEST(ServiceAndRobot, FolderThatCannotTakeTheResultCostsOneScanAndNotTheService) {
  const fs::path broken = leave_scan("scan-0001"), next = leave_scan("scan-0002");
  fs::create_directories(broken / "line.csv/in-the-way");  // no file can be written over it
  ChildProcess host = start(arguments(k_no_sensor), {});
  for (int i = 0; i < 6000 && !fs::exists(next / "line.csv"); ++i) std::this_thread::sleep_for(10ms);
  CHECK(fs::exists(next / "line.csv"));
  CHECK(host.running());
}

TEST(ServiceAndRobot, SecondServiceOnAFolderIsRefusedByTheFirstOnesName) {
  const auto sensor = recorded().sensor_of_it();
  ChildProcess first = start(arguments(sensor.endpoint().text()), {});
  SUCCEEDS(first.next_line(k_patience));
  ChildProcess second = start(arguments(sensor.endpoint().text()), {"--once"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Connection), end_of(second).first);
  STRCMP_CONTAINS(("held by biteline-host " + std::to_string(first.pid())).c_str(),
                  second.last_words().c_str());
}

TEST(ServiceAndRobot, SecondServiceOnAnArmIsRefusedByTheFirstOnesName) {
  const auto sensor = recorded().sensor_of_it();
  ChildProcess first = start(sending(sensor.endpoint().text()), {});
  SUCCEEDS(first.next_line(k_patience));
  std::vector<std::string> elsewhere = sending(sensor.endpoint().text());
  elsewhere[3] = (folder.path() / "other-results").string();
  ChildProcess second = start(elsewhere, {"--once"});
  LONGS_EQUAL(static_cast<int>(ExitStatus::Connection), end_of(second).first);
  STRCMP_CONTAINS(("held by biteline-host " + std::to_string(first.pid())).c_str(),
                  second.last_words().c_str());
}

}  // namespace biteline
