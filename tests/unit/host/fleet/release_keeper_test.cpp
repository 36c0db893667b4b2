// SPDX-License-Identifier: MIT
#include "host/fleet/release_keeper.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <thread>

#include "common/system/file.hpp"
#include "host/records/archive/archive.hpp"
#include "host/records/digest/digest.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/records/release/signer.hpp"

namespace biteline::fleet {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

}  // namespace

TEST_GROUP(ReleaseKeeper) {
  test::TemporaryFolder folder;
  fs::path shelf{folder.path() / "releases"}, key{folder.path() / "key.pem"};
  test::Signer signer{key};
  std::vector<PartAsk> asks;
  ReleaseKeeper sut{shelf, key, "cell-1", [this](const PartAsk& ask) { asks.push_back(ask); }};
  ReleaseKeeper::Clock::time_point now{seconds{100}};
  std::string bytes;
  release::Manifest manifest;

  void make(const std::string& words) {
    const fs::path file = folder.path() / "release.tar";
    const std::vector<archive::Entry> entries{
        {.name = "processes/grind.yaml", .file = folder.write("grind.yaml", words)}};
    SUCCEEDS(archive::write(file, {.kind = release::k_archive_kind, .program = {}, .time = {}}, entries));
    manifest = {.name = "x", .sha256 = *digest_of_file(file), .bytes = fs::file_size(file)};
    std::ifstream in{file, std::ios::binary};
    bytes.assign(std::istreambuf_iterator<char>{in}, {});
  }
  ReleasePlan plan_of_it() const {
    const std::string text = release::to_text(manifest);
    return {.manifest = text, .signature = signer.sign(text)};
  }
  ReleasePlan plan_with(std::int64_t number, std::int64_t at_ms, bool sure,
                        const std::vector<std::string>& cells = {"cell-0", "cell-1"}) const {
    const std::string order = release::to_text(
        release::Order{.number = number, .sha256 = manifest.sha256, .at_ms = at_ms, .cells = cells});
    ReleasePlan plan = plan_of_it();
    plan.turn = ReleasePlan::Switch{.order = order, .signature = signer.sign(order), .sure = sure};
    return plan;
  }
  std::string plan_file() const {
    return read_regular_file(shelf / release::k_plan_file, 4096).value();
  }
  /// As the centre answers an ask, part by part.
  Result<bool> answer(const PartAsk& ask) {
    Result<bool> whole{false};
    auto at = static_cast<std::size_t>(ask.at);
    for (int i = 0; i < k_parts_at_once && at < bytes.size(); ++i, at += k_part_bytes)
      whole = sut.hear(Part{.sha256 = manifest.sha256,
                            .at = static_cast<std::int64_t>(at),
                            .bytes = bytes.substr(at, k_part_bytes)},
                       now);
    return whole;
  }
  /// Once what is whole is checked and unpacked.
  Result<bool> settle() {
    Result<bool> looked{false};
    while (looked && !*looked) {
      looked = sut.look(now, 0);
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    return looked;
  }
  void fetch() {
    SUCCEEDS(sut.hear(plan_of_it(), now, 0));
    SUCCEEDS(sut.look(now, 0));
    for (std::size_t i = 0; i < asks.size(); ++i) SUCCEEDS(answer(asks[i]));
    SUCCEEDS(settle());
    CHECK_EQUAL(1U, sut.word(0).has.size());
  }
};

TEST(ReleaseKeeper, FetchesInRoundsAndIsReady) {
  make(std::string(1'000'000, 'x'));
  fetch();
  LONGS_EQUAL((bytes.size() + k_part_bytes * k_parts_at_once - 1) / (k_part_bytes * k_parts_at_once),
              asks.size());
  STRCMP_EQUAL(manifest.sha256.c_str(), sut.word(5).has.front().c_str());
  STRCMP_EQUAL("", sut.word(5).current.c_str());
  LONGS_EQUAL(5, sut.word(5).clock_ms);
}

TEST(ReleaseKeeper, AsksForNothingThatIsNotSigned) {
  make("one");
  ReleasePlan plan = plan_of_it();
  plan.signature[3] = static_cast<char>(plan.signature[3] ^ 1);
  FAILS_NAMING(Errc::AuthenticationFailed, "not signed by", sut.hear(plan, now, 0));
  SUCCEEDS(sut.look(now + seconds{60}, 0));
  CHECK(asks.empty());
  STRCMP_CONTAINS("not signed by", sut.word(0).fault.c_str());
  // And takes nothing that it did not ask for.
  CHECK(!sut.hear(Part{.sha256 = manifest.sha256, .at = 0, .bytes = bytes}, now).value());
  CHECK(sut.word(0).has.empty());
}

TEST(ReleaseKeeper, FlippedByteIsFetchedAnewLater) {
  make(std::string(60'000, 'x'));
  SUCCEEDS(sut.hear(plan_of_it(), now, 0));
  SUCCEEDS(sut.look(now, 0));
  const std::string sound = bytes;
  bytes[700] = static_cast<char>(bytes[700] ^ 1);
  CHECK(answer(asks.back()).value());
  FAILS_NAMING(Errc::BadValue, "not the file that was signed", settle());
  STRCMP_CONTAINS("SHA-256", sut.word(0).fault.c_str());
  SUCCEEDS(sut.hear(plan_of_it(), now + seconds{1}, 0));
  SUCCEEDS(sut.look(now + seconds{1}, 0));
  LONGS_EQUAL(1, asks.size());
  bytes = sound;
  now += seconds{60};
  SUCCEEDS(sut.hear(plan_of_it(), now, 0));
  SUCCEEDS(sut.look(now, 0));
  LONGS_EQUAL(0, asks.back().at);
  CHECK(answer(asks.back()).value());
  SUCCEEDS(settle());
  STRCMP_EQUAL("", sut.word(0).fault.c_str());
}

TEST(ReleaseKeeper, WhatCannotBeUsedIsFetchedThreeTimesThenOnceAnHour) {
  make(std::string(60'000, 'x'));
  bytes[700] = static_cast<char>(bytes[700] ^ 1);
  for (int minute = 0; minute < 30; ++minute) {
    now += seconds{60};
    SUCCEEDS(sut.hear(plan_of_it(), now, 0));
    const std::size_t before = asks.size();
    SUCCEEDS(sut.look(now, 0));
    if (asks.size() == before) continue;
    CHECK(answer(asks.back()).value());
    CHECK(!settle());
  }
  LONGS_EQUAL(3, asks.size());
  STRCMP_CONTAINS("it came 3 times and is tried once an hour", sut.word(0).fault.c_str());
  now += std::chrono::hours{1};
  SUCCEEDS(sut.hear(plan_of_it(), now, 0));
  SUCCEEDS(sut.look(now, 0));
  LONGS_EQUAL(4, asks.size());
}

TEST(ReleaseKeeper, CentreThatKnowsOfNoSwitchBringsNoOlderOneBack) {
  make("one");
  fetch();
  SUCCEEDS(sut.hear(plan_with(4, 1000, true), now, 2000));
  SUCCEEDS(sut.hear(plan_of_it(), now, 3000));
  LONGS_EQUAL(4, sut.word(3000).number);
}

TEST(ReleaseKeeper, OldOrderIsRefusedHoweverWellItIsSigned) {
  make("one");
  fetch();
  const ReleasePlan old = plan_with(4, 1000, true);
  SUCCEEDS(sut.hear(old, now, 2000));
  const std::string first = manifest.sha256;
  make("two");
  SUCCEEDS(sut.hear(plan_of_it(), now, 2000));
  asks.clear();
  SUCCEEDS(sut.look(now, 2000));
  CHECK(answer(asks.back()).value());
  SUCCEEDS(settle());
  SUCCEEDS(sut.hear(plan_with(5, 3000, false), now, 2500));
  SUCCEEDS(sut.hear(plan_with(5, 3000, true), now, 2500));
  SUCCEEDS(sut.look(now, 3000));
  STRCMP_EQUAL(manifest.sha256.c_str(), sut.word(3000).current.c_str());
  const std::string stands = plan_file();
  // Recorded on its way and told again.
  FAILS_NAMING(Errc::WrongState, "switch 4: a newer or another one is known here (switch 5)",
               sut.hear(old, now, 4000));
  STRCMP_EQUAL(stands.c_str(), plan_file().c_str());
  STRCMP_CONTAINS("switch 4", sut.word(4000).fault.c_str());
  SUCCEEDS(sut.hear(plan_with(5, 3000, true), now, 4000));
  STRCMP_EQUAL("", sut.word(4000).fault.c_str());
  CHECK(sut.word(4000).current != first);
}

TEST(ReleaseKeeper, ForgedOrCutOrderChangesNothing) {
  make("one");
  fetch();
  SUCCEEDS(sut.hear(plan_with(4, 1000, false), now, 500));
  const std::string stands = plan_file();
  const ReleasePlan sound = plan_with(5, 1000, true);
  ReleasePlan plan = sound;
  const test::Signer stranger{folder.path() / "stranger.pem"};
  plan.turn->signature = stranger.sign(plan.turn->order);
  FAILS_NAMING(Errc::AuthenticationFailed, "order of a switch is not signed by", sut.hear(plan, now, 600));
  // So that the centre need not wait for its time.
  LONGS_EQUAL(5, sut.word(600).refused);
  // The same order for an earlier time.
  plan = sound;
  plan.turn->order.replace(plan.turn->order.find("at_ms 1000"), 10, "at_ms 0700");
  FAILS_NAMING(Errc::AuthenticationFailed, "not signed by", sut.hear(plan, now, 600));
  for (std::size_t size = 0; size < sound.turn->order.size(); ++size) {
    plan = sound;
    plan.turn->order.resize(size);
    CHECK_TEXT(!sut.hear(plan, now, 600), "an order cut on its way");
    plan.turn->signature = signer.sign(plan.turn->order);
    CHECK_TEXT(!sut.hear(plan, now, 600), "an order that was cut and then signed");
  }
  plan = sound;
  plan.turn->signature.resize(63);
  CHECK(!sut.hear(plan, now, 600));
  FAILS_NAMING(Errc::WrongState, "not for cell-1", sut.hear(plan_with(5, 1000, true, {"cell-11"}), now, 600));
  STRCMP_EQUAL(stands.c_str(), plan_file().c_str());
  LONGS_EQUAL(4, sut.word(600).number);
  LONGS_EQUAL(5, sut.word(600).refused);
  SUCCEEDS(sut.hear(plan_of_it(), now, 600));
  LONGS_EQUAL(0, sut.word(600).refused);
  SUCCEEDS(sut.hear(plan_with(4, 1000, false), now, 600));
  SUCCEEDS(sut.hear(sound, now, 600));
  LONGS_EQUAL(0, sut.word(600).refused);
  LONGS_EQUAL(5, sut.word(600).number);
}

TEST(ReleaseKeeper, GoesOnBehindTheLastWholePart) {
  make(std::string(200'000, 'x'));
  fs::create_directories(shelf);
  // A predecessor was killed within its second part.
  std::ofstream(shelf / (manifest.sha256 + ".part"), std::ios::binary) << bytes.substr(0, k_part_bytes + 17);
  SUCCEEDS(sut.hear(plan_of_it(), now, 0));
  SUCCEEDS(sut.look(now, 0));
  LONGS_EQUAL(k_part_bytes, asks.back().at);
  // Twice, late or of another place: passed over.
  CHECK(!sut.hear(Part{.sha256 = manifest.sha256, .at = 0, .bytes = bytes.substr(0, k_part_bytes)}, now)
             .value());
  CHECK(answer(asks.back()).value());
}

TEST(ReleaseKeeper, AsksAgainForWhatDoesNotCome) {
  make("one");
  SUCCEEDS(sut.hear(plan_of_it(), now, 0));
  SUCCEEDS(sut.look(now, 0));
  SUCCEEDS(sut.look(now + seconds{1}, 0));
  LONGS_EQUAL(1, asks.size());
  SUCCEEDS(sut.look(now + seconds{10}, 0));
  LONGS_EQUAL(2, asks.size());
}

TEST(ReleaseKeeper, KeepsNoReleaseThatNobodyWantsAnyMore) {
  make("one");
  fetch();
  make("two");
  SUCCEEDS(sut.hear(plan_of_it(), now, 0));
  SUCCEEDS(sut.look(now, 0));
  CHECK(answer(asks.back()).value());
  SUCCEEDS(settle());
  LONGS_EQUAL(1, sut.word(0).has.size());
  STRCMP_EQUAL(manifest.sha256.c_str(), sut.word(0).has.front().c_str());
}

TEST(ReleaseKeeper, SwitchesAtItsTimeOnceSure) {
  make("one");
  fetch();
  SUCCEEDS(sut.hear(plan_with(4, 1000, false), now, 500));
  LONGS_EQUAL(4, sut.word(500).number);
  STRCMP_EQUAL("", sut.word(2000).current.c_str());
  SUCCEEDS(sut.hear(plan_with(4, 1000, true), now, 600));
  STRCMP_EQUAL("", sut.word(999).current.c_str());
  STRCMP_EQUAL(manifest.sha256.c_str(), sut.word(1000).current.c_str());
  SUCCEEDS(sut.look(now, 1000));
  CHECK(release::plan_of(shelf)->next.empty());
  STRCMP_EQUAL(manifest.sha256.c_str(), release::plan_of(shelf)->current.c_str());
}

TEST(ReleaseKeeper, WithdrawnSwitchIsForgotten) {
  make("one");
  fetch();
  SUCCEEDS(sut.hear(plan_with(4, 1000, false), now, 500));
  SUCCEEDS(sut.hear(plan_of_it(), now, 990));
  STRCMP_EQUAL("", sut.word(5000).current.c_str());
  LONGS_EQUAL(0, sut.word(5000).number);
  LONGS_EQUAL(4, sut.word(5000).newest);
}

TEST(ReleaseKeeper, WhoWasAwaySwitchesWhenItIsBack) {
  make("one");
  fetch();
  SUCCEEDS(sut.hear(plan_with(4, 1000, true), now, 7000));
  STRCMP_EQUAL(manifest.sha256.c_str(), sut.word(7000).current.c_str());
}

TEST(ReleaseKeeper, DoesNotSwitchToWhatItDoesNotHave) {
  make("one");
  SUCCEEDS(sut.hear(plan_with(4, 1000, true), now, 500));
  STRCMP_EQUAL("", sut.word(2000).current.c_str());
  LONGS_EQUAL(0, sut.word(2000).number);
}

}  // namespace biteline::fleet
