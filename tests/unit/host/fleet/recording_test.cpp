// SPDX-License-Identifier: MIT
// A cell's side and the centre's, without a network between them.
#include <CppUTest/TestHarness.h>

#include <fstream>
#include <functional>

#include "host/fleet/recording_giver.hpp"
#include "host/fleet/recording_taker.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::fleet {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

std::string bytes_of(const fs::path& file) {
  std::ifstream in{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{in}, {}};
}

FetchRow asked_for(std::int64_t number) {
  FetchRow row;
  row.number = number;
  row.cell = "cell-1";
  row.book = "b0";
  row.scan = "scan-0007";
  row.online = true;
  return row;
}

}  // namespace

TEST_GROUP(Recording) {
  test::TemporaryFolder folder;
  fs::path results{folder.path() / "results"};
  RecordingGiver giver{results};
  RecordingTaker taker{folder.path() / "centre"};
  RecordingTaker::Clock::time_point now{seconds{100}};
  FetchRow row{asked_for(1)};
  int asks{0}, pieces{0};
  /// What happens to a piece on its way; false: it is lost.
  std::function<bool(Piece&)> on_way = [](Piece&) { return true; };

  void setup() override {
    std::string noise;
    for (unsigned i = 0; noise.size() < 1'000'000; ++i) noise += std::to_string(i * 2654435761U);
    folder.write("results/scan-0007/scan.btln", noise);
    folder.write("results/scan-0007/line.csv", "1,2,3\n");
  }
  /// Until it has ended or so many rounds are over.
  void run(int rounds = 300) {
    for (; rounds > 0 && row.state != FetchState::Whole && row.state != FetchState::Refused; --rounds) {
      now += seconds{1};
      if (const auto ask = taker.look(row, now)) {
        ++asks;
        giver.hear(*ask);
      }
      while (giver.asked()) {
        std::optional<Piece> piece = giver.step("b0");
        if (!piece || !on_way(*piece)) continue;
        ++pieces;
        if (const auto changed = taker.hear("cell-1", *piece, now)) row = *changed;
      }
      for (const FetchRow& changed : taker.work(now)) row = changed;
    }
  }
  void check_whole() {
    STRCMP_EQUAL("whole", to_text(row.state));
    const fs::path out = folder.path() / "out";
    fs::create_directories(out);
    LONGS_EQUAL(0, std::system(("tar -xf " + taker.file_of(row).string() + " -C " + out.string()).c_str()));
    CHECK(bytes_of(out / "scan-0007/scan.btln") == bytes_of(results / "scan-0007/scan.btln"));
    STRCMP_EQUAL("1,2,3\n", bytes_of(out / "scan-0007/line.csv").c_str());
    CHECK(!fs::exists(taker.file_of(row).string() + ".part"));
  }
};

TEST(Recording, ComesInBoundedPieces) {
  run();
  check_whole();
  LONGS_EQUAL(
      (row.total + static_cast<std::int64_t>(k_piece_bytes) - 1) / static_cast<std::int64_t>(k_piece_bytes),
      pieces);
  LONGS_EQUAL((pieces + k_pieces_an_ask - 1) / k_pieces_an_ask, asks);
}

TEST(Recording, LostPiecesAreAskedForAgain) {
  int number = 0;
  on_way = [&number](Piece&) { return ++number % 3 != 0; };
  run();
  check_whole();
}

TEST(Recording, GoesOnWhereAKilledCentreStood) {
  run(2);
  CHECK(row.have > 0 && row.have < row.total);
  const int before = pieces;
  taker = RecordingTaker{folder.path() / "centre"};
  giver = RecordingGiver{results};  // and a killed uplink
  run();
  check_whole();
  // All but the round that was lost with it came once.
  const std::int64_t all =
      (row.total + static_cast<std::int64_t>(k_piece_bytes) - 1) / static_cast<std::int64_t>(k_piece_bytes);
  CHECK(before > 0);
  LONGS_EQUAL(all, pieces);
}

TEST(Recording, WhatIsWholeIsNotFetchedAgainWhereTheCentreWasKilledBeforeItsWord) {
  run(2);
  const FetchRow coming = row;  // as the database still has it
  run();
  const int before = pieces;
  taker = RecordingTaker{folder.path() / "centre"};
  row = coming;
  fs::remove_all(results / "scan-0007/line.csv");
  run();
  STRCMP_EQUAL("whole", to_text(row.state));
  LONGS_EQUAL(before, pieces);
  CHECK(fs::exists(taker.file_of(row)));
}

TEST(Recording, FlippedByteIsFetchedAnewAndAtLastRefused) {
  int flips = 1;
  on_way = [&flips](Piece& piece) {
    if (piece.at == 0 && flips-- > 0) piece.bytes[600] = static_cast<char>(piece.bytes[600] ^ 1);
    return true;
  };
  run();
  check_whole();
  LONGS_EQUAL(1, row.tries);
  row = asked_for(2);
  flips = 100;
  run();
  STRCMP_EQUAL("refused", to_text(row.state));
  STRCMP_CONTAINS("SHA-256", row.words.c_str());
  CHECK(!fs::exists(taker.file_of(row).string() + ".part"));
}

TEST(Recording, FolderThatChangesIsReadAnew) {
  run(2);
  CHECK(row.have > 0 && row.have < row.total);
  folder.write("results/scan-0007/line.csv", "other\n");
  giver = RecordingGiver{results};
  run();
  STRCMP_EQUAL("whole", to_text(row.state));
  CHECK(bytes_of(taker.file_of(row)).find("other\n") != std::string::npos);
  LONGS_EQUAL(1, row.tries);
}

TEST(Recording, FolderThatShrankWhileTheUplinkWasDownIsReadAnew) {
  run(2);
  CHECK(row.have > 0 && row.have < row.total);
  folder.write("results/scan-0007/scan.btln", "short");
  giver = RecordingGiver{results};
  run();
  check_whole();
  LONGS_EQUAL(1, row.tries);
  CHECK(row.total < 100'000);
}

TEST(Recording, WhatIsGoneIsRefusedByName) {
  fs::remove_all(results / "scan-0007");
  run();
  STRCMP_EQUAL("refused", to_text(row.state));
  STRCMP_CONTAINS("scan-0007 is gone", row.words.c_str());
}

TEST(Recording, AnotherMemorysScanIsRefused) {
  giver.hear({.number = 1, .book = "old", .scan = "scan-0007", .at = 0});
  const std::optional<Piece> piece = giver.step("b0");
  CHECK(piece.has_value());
  STRCMP_CONTAINS("new memory", piece->refused.c_str());
  CHECK(!giver.asked());
}

TEST(Recording, NobodysPieceIsTaken) {
  const Piece piece{
      .number = 1, .at = 0, .total = 4, .sha256 = std::string(64, 'a'), .refused = {}, .bytes = "abcd"};
  CHECK(!taker.hear("cell-1", piece, now));  // nothing was asked for
  CHECK(taker.look(row, now).has_value());
  CHECK(!taker.hear("cell-2", piece, now));
  CHECK(!fs::exists(folder.path() / "centre"));
}

TEST(Recording, CellThatIsAwayIsNotAsked) {
  row.online = false;
  CHECK(!taker.look(row, now));
  row.online = true;
  CHECK(taker.look(row, now).has_value());
}

TEST(Recording, CellWorksWhileItsNewestScanHasNoReport) {
  CHECK(cell_works(results));
  folder.write("results/scan-0007/report.json", "{}");
  CHECK(!cell_works(results));
  folder.write("results/scan-10000/scan.btln", "");
  CHECK(cell_works(results));
  fs::last_write_time(results / "scan-10000", fs::file_time_type::clock::now() - std::chrono::minutes{11});
  CHECK(!cell_works(results));
  CHECK(!cell_works(folder.path() / "nowhere"));
}

}  // namespace biteline::fleet
