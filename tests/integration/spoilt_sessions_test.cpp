// SPDX-License-Identifier: MIT
// Whole sessions, shared and made, spoilt in every way: a table of what a replay makes of each, and that none
// of them is taken for sound where its scan can tell.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>

#include "tests/integration/replayed_session.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/spoilt_pictures.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {
namespace {

namespace fs = std::filesystem;
using test::Spoil;
using Kind = Spoil::Kind;

const std::vector<Spoil> k_spoils{{Kind::Mirrored}, {Kind::UpsideDown}, {Kind::Turned},
                                  {Kind::Halved},   {Kind::Small},      {Kind::Rows, 2},
                                  {Kind::Rows, 8},  {Kind::Rows, -8},   {Kind::Rows, 20},
                                  {Kind::Rows, 50}, {Kind::Rows, -50},  {Kind::Columns, 50}};

/// First three columns of a file of lines.
std::vector<Vec3> points_of(const fs::path& file) {
  std::vector<Vec3> points;
  std::ifstream in{file};
  for (std::string row; std::getline(in, row);) {
    if (row.starts_with("#")) continue;
    std::ranges::replace(row, ',', ' ');
    std::istringstream fields{row};
    Vec3 point;
    if (fields >> point.x() >> point.y() >> point.z()) points.push_back(point);
  }
  return points;
}

/// Mean distance of the line's points to the nearest true one, mm; negative: no line or no truth.
double error_mm(const fs::path& session, const fs::path& out) {
  const std::vector<Vec3> truth = points_of(session / "truth" / "groove.csv");
  const std::vector<Vec3> line = points_of(out / "line.csv");
  if (truth.empty() || line.empty()) return -1;
  double sum = 0;
  for (const Vec3& point : line) {
    double nearest = 1e9;
    for (const Vec3& there : truth) nearest = std::min(nearest, (there - point).norm());
    sum += nearest;
  }
  return sum / static_cast<double>(line.size());
}

bool gross(const Spoil& spoil) {
  return spoil.kind != Kind::Rows && spoil.kind != Kind::Columns;
}

/// Far enough beyond what the scan says that it tells.
bool told_by(const test::Replayed& sound, const Spoil& spoil) {
  if (gross(spoil)) return true;
  const char* key = spoil.kind == Kind::Rows ? "tells_rows" : "tells_columns";
  constexpr double k_sure = 2.5;
  return sound.pictures(key) != "-" && std::abs(spoil.amount) > k_sure * std::stod(sound.pictures(key));
}

}  // namespace

TEST_GROUP(SpoiltSessions) {
  test::TemporaryFolder folder;

  std::map<std::string, fs::path> sessions() const {
    std::map<std::string, fs::path> found;
    for (const char* name : {"ledge32", "airjordan1", "sport3"}) {
      if (const auto shared = test::shared_data(std::string("sessions/") + name)) found[name] = *shared;
    }
    const std::map<std::string, std::vector<std::string>> made{
        {"made lap", {"--seed", "4", "--head", "7", "--check-lap", "50"}},
        {"real lap",
         {"--seed", "3", "--head", "5", "--check-lap", "50", "--arm", "ur10e", "--world", "real",
          "--speed-mm-s", "250"}},
        {"real", {"--seed", "2", "--arm", "ur10e", "--world", "real", "--speed-mm-s", "250"}}};
    for (const auto& [name, options] : made) {
      std::vector<std::string> arguments{"record", "--out", (folder.path() / name).string()};
      arguments.insert(arguments.end(), options.begin(), options.end());
      LONGS_EQUAL(0, test::run_to_end(BITELINE_CELL, arguments));
      found[name] = folder.path() / name;
    }
    return found;
  }
};

TEST(SpoiltSessions, NoneIsTakenForSoundWhereItsScanCanTell) {
  std::printf("\n%-11s %-12s %4s %-11s %-8s %6s %9s %7s %8s  %s\n", "session", "pictures", "exit", "check",
              "vouched", "places", "statistic", "limit", "line mm", "reason");
  for (const auto& [name, session] : sessions()) {
    const auto look = [&](const Spoil& spoil) {
      const fs::path spoilt = folder.path() / "spoilt", out = folder.path() / "out";
      SUCCEEDS(test::write_spoilt_session(session, spoilt, spoil));
      const test::Replayed sut = test::replayed(spoilt, out);
      const double off_mm = sut.exit == 0 ? error_mm(session, out) : -1;
      std::printf("%-11s %-12s %4d %-11s %-8s %6s %9s %7s %8.3f  %s\n", name.c_str(), spoil.name().c_str(),
                  sut.exit, sut.pictures("status").c_str(), sut.pictures("vouched_by").c_str(),
                  sut.pictures("places").c_str(), sut.pictures("statistic").substr(0, 7).c_str(),
                  sut.pictures("limit").substr(0, 5).c_str(), off_mm, sut.reason_code().c_str());
      std::fflush(stdout);
      fs::remove_all(out);
      return sut;
    };
    const test::Replayed sound = look({});
    CHECK_EQUAL_TEXT(0, sound.exit, name.c_str());
    CHECK_TEXT(sound.pictures("status") != "contradict", name.c_str());
    const bool lap = sound.pictures("status") == "agree", tells = sound.pictures("tells_rows") != "-";
    for (const Spoil& spoil : k_spoils) {
      const test::Replayed sut = look(spoil);
      const std::string what = name + ", " + spoil.name();
      if (tells && gross(spoil)) CHECK_TEXT(sut.exit != 0, what.c_str());
      if (lap && told_by(sound, spoil)) CHECK_TEXT(sut.exit != 0, what.c_str());
      // What cannot be told, or can no more since the crossing places have left the picture, is vouched for
      // by nobody, and the report says so.
      if (sut.exit == 0 && (!lap || told_by(sound, spoil)))
        STRCMP_EQUAL_TEXT("nobody", sut.pictures("vouched_by").c_str(), what.c_str());
    }
  }
}

}  // namespace biteline
