// SPDX-License-Identifier: MIT
// biteline keys on the command line: pairs made where they belong, hosts let in and put out, keys changed.
#include <CppUTest/TestHarness.h>
#include <sys/stat.h>

#include "common/wire/keys.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/said.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

namespace fs = std::filesystem;

TEST_GROUP(KeysTool) {
  test::TemporaryFolder folder;
  std::string host{folder.path() / "host"}, sensor{folder.path() / "sensor"};

  static test::Said keys(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "keys");
    return test::said_by(BITELINE_TOOL, std::move(arguments));
  }
  static void works(const std::vector<std::string>& arguments) {
    const test::Said said = keys(arguments);
    LONGS_EQUAL_TEXT(0, said.status, said.last_error.c_str());
    LONGS_EQUAL(0, said.errors);
  }
  static void fails(const std::vector<std::string>& arguments, const char* words) {
    const test::Said said = keys(arguments);
    LONGS_EQUAL(2, said.status);
    LONGS_EQUAL(1, said.errors);
    STRCMP_CONTAINS(words, said.last_error.c_str());
  }
  static std::string content(const fs::path& file) {
    std::ifstream stream{file};
    return {std::istreambuf_iterator<char>{stream}, {}};
  }
  /// Both ends have their own pair and the other's public key.
  void exchange() const {
    works({"make", "--keys", host});
    works({"make", "--sensor", "--keys", sensor});
    fs::copy_file(fs::path{sensor} / "sensor.public", fs::path{host} / "sensor.public");
    works({"allow", "--keys", sensor, "left", (fs::path{host} / "host.public").string()});
  }
};

TEST(KeysTool, PairsAreMadeWhereTheyBelongAndSayWhatIsNext) {
  const test::Said made = keys({"make", "--keys", host});
  LONGS_EQUAL(0, made.status);
  STRCMP_CONTAINS("host.public to the sensor", made.out.c_str());
  struct stat secret {};
  LONGS_EQUAL(0, ::stat((fs::path{host} / "host.secret").c_str(), &secret));
  LONGS_EQUAL(0600, secret.st_mode & 0777);
  CHECK(!fs::exists(fs::path{host} / "sensor.secret"));

  const test::Said of_sensor = keys({"make", "--sensor", "--keys", sensor});
  LONGS_EQUAL(0, of_sensor.status);
  STRCMP_CONTAINS("sensor.public to the key folder of each host", of_sensor.out.c_str());
  CHECK(!fs::exists(fs::path{sensor} / "host.secret"));
}

TEST(KeysTool, ExchangedKeysAreWholeOnBothSides) {
  exchange();
  SUCCEEDS(wire::read_host_keys(host));
  const auto sensors = wire::read_sensor_keys(sensor);
  SUCCEEDS(sensors);
  STRCMP_CONTAINS("left", content(fs::path{sensor} / "hosts.allowed").c_str());
}

TEST(KeysTool, MadeKeysAreNotMadeOver) {
  works({"make", "--keys", host});
  const std::string before = content(fs::path{host} / "host.secret");
  fails({"make", "--keys", host}, "never overwritten");
  CHECK_EQUAL(before, content(fs::path{host} / "host.secret"));
}

TEST(KeysTool, RotationChangesThePairAndTheListFollowsByName) {
  exchange();
  const std::string secret = content(fs::path{host} / "host.secret"),
                    list = content(fs::path{sensor} / "hosts.allowed");
  std::string old_key = content(fs::path{host} / "host.public");
  while (!old_key.empty() && old_key.back() == '\n') old_key.pop_back();
  CHECK(list.find(old_key) != std::string::npos);
  works({"rotate", "--keys", host});
  CHECK(secret != content(fs::path{host} / "host.secret"));
  works({"allow", "--keys", sensor, "left", (fs::path{host} / "host.public").string()});
  const std::string now = content(fs::path{sensor} / "hosts.allowed");
  CHECK(list != now);
  // The older key of that name is out.
  CHECK(now.find(old_key) == std::string::npos);
  SUCCEEDS(wire::read_host_keys(host));
}

TEST(KeysTool, RevokedHostIsOutAndAnUnknownOneIsTold) {
  exchange();
  works({"revoke", "--keys", sensor, "left"});
  CHECK(content(fs::path{sensor} / "hosts.allowed").find("left") == std::string::npos);
  fails({"revoke", "--keys", sensor, "left"}, "left");
}

TEST(KeysTool, WhatCannotBeDoneIsOneLine) {
  fails({"rotate", "--keys", host}, "host");
  fails({"allow", "--keys", sensor, "left", "/nowhere/host.public"}, "nowhere");
  fails({"make"}, "--keys");
  fails({"forge", "--keys", host}, "see --help");
}

}  // namespace biteline
