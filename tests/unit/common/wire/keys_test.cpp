// SPDX-License-Identifier: MIT
#include "common/wire/keys.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/key_set.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::wire {

TEST_GROUP(Keys) {
  test::TemporaryFolder folder;

  void setup() override {
    SUCCEEDS(test::make_key_set(folder.path() / "keys"));
  }
  std::filesystem::path keys() const {
    return folder.path() / "keys";
  }
};

TEST(Keys, BothSidesFindWhatTheyNeed) {
  const Result<SensorKeys> sensor = read_sensor_keys(keys());
  const Result<HostKeys> host = read_host_keys(keys());
  SUCCEEDS(sensor);
  SUCCEEDS(host);
  STRCMP_EQUAL(sensor->own.public_key.c_str(), host->sensor_public_key.c_str());
  LONGS_EQUAL(1, sensor->allowed_hosts.size());
  STRCMP_EQUAL(host->own.public_key.c_str(), sensor->allowed_hosts[0].c_str());
  CHECK(sensor->own.secret_key != host->own.secret_key);
}

TEST(Keys, ExistingKeysAreNeverOverwritten) {
  const std::string before = read_host_keys(keys())->own.secret_key;
  FAILS_NAMING(Errc::WrongState, "never overwritten", make_host_keys(keys()));
  FAILS_NAMING(Errc::WrongState, "never overwritten", make_sensor_keys(keys()));
  STRCMP_EQUAL(before.c_str(), read_host_keys(keys())->own.secret_key.c_str());
}

TEST(Keys, SecretThatOthersMayReadIsRefused) {
  std::filesystem::permissions(keys() / "sensor.secret", std::filesystem::perms::group_read,
                               std::filesystem::perm_options::add);
  FAILS_NAMING(Errc::AuthenticationFailed, "sensor.secret", read_sensor_keys(keys()));
}

TEST(Keys, BrokenFilesAreNamed) {
  folder.write("keys/host.public", "too short\n");
  FAILS_NAMING(Errc::BadFormat, "host.public line 1", read_host_keys(keys()));
  folder.write("keys/hosts.allowed", "# who may come in\nnonsense somebody\n");
  FAILS_NAMING(Errc::BadFormat, "hosts.allowed line 2", read_sensor_keys(keys()));
  FAILS_NAMING(Errc::FileNotFound, "sensor.public", read_sensor_keys(folder.path()));
}

TEST(Keys, AllowListTakesCommentsNamesAndSeveralHosts) {
  const std::string key = read_host_keys(keys())->own.public_key;
  folder.write("keys/hosts.allowed", "# workshop\n\n" + key + " workshop PC\n" + key + "\n");
  const Result<SensorKeys> sensor = read_sensor_keys(keys());
  SUCCEEDS(sensor);
  LONGS_EQUAL(2, sensor->allowed_hosts.size());
}

TEST(Keys, EachSideMakesItsOwnAndTheHostsSecretIsNeverOnTheSensor) {
  const auto sensor = folder.path() / "sensor", host = folder.path() / "host";
  SUCCEEDS(make_sensor_keys(sensor));
  SUCCEEDS(make_host_keys(host));
  CHECK(!std::filesystem::exists(sensor / "host.secret") && !std::filesystem::exists(sensor / "host.public"));
  CHECK(!std::filesystem::exists(host / "sensor.secret"));
  for (const auto& made : {sensor, host}) {
    LONGS_EQUAL(0700, static_cast<int>(std::filesystem::status(made).permissions()));
  }
  LONGS_EQUAL(0600, static_cast<int>(std::filesystem::status(host / "host.secret").permissions()));
  FAILS_NAMING(Errc::AuthenticationFailed, "names no host", read_sensor_keys(sensor));
  SUCCEEDS(allow_host(sensor, "workshop", host / "host.public"));
  LONGS_EQUAL(1, read_sensor_keys(sensor)->allowed_hosts.size());
}

TEST(Keys, HalvesOfTwoSetsAreNamed) {
  SUCCEEDS(test::make_key_set(folder.path() / "other"));
  for (const char* name : {"sensor.secret", "host.public"}) {
    std::filesystem::copy_file(folder.path() / "other" / name, keys() / name,
                               std::filesystem::copy_options::overwrite_existing);
  }
  FAILS_NAMING(Errc::AuthenticationFailed, "sensor.secret: it does not belong to sensor.public",
               read_sensor_keys(keys()));
  FAILS_NAMING(Errc::AuthenticationFailed, "host.secret: it does not belong to host.public",
               read_host_keys(keys()));
}

TEST(Keys, RotationMakesANewWholePairAndKeepsTheOther) {
  const HostKeys before = *read_host_keys(keys());
  SUCCEEDS(rotate_keys(keys(), KeyOwner::Host));
  const Result<HostKeys> after = read_host_keys(keys());
  SUCCEEDS(after);
  CHECK(before.own.public_key != after->own.public_key && before.own.secret_key != after->own.secret_key);
  STRCMP_EQUAL(before.sensor_public_key.c_str(), after->sensor_public_key.c_str());
  // The sensor learns the new key under the old name.
  SUCCEEDS(allow_host(keys(), "host", keys() / "host.public"));
  LONGS_EQUAL(1, read_allowed_hosts(keys())->size());
  STRCMP_EQUAL(after->own.public_key.c_str(), read_allowed_hosts(keys())->front().c_str());
  SUCCEEDS(rotate_keys(keys(), KeyOwner::Sensor));
  CHECK(read_host_keys(keys())->sensor_public_key != before.sensor_public_key);
  FAILS_NAMING(Errc::FileNotFound, "host.public", rotate_keys(folder.path(), KeyOwner::Host));
}

TEST(Keys, HostIsRevokedByNameOrKeyAndTheOthersStayWithTheirComments) {
  const std::string key = read_host_keys(keys())->own.public_key;
  SUCCEEDS(make_host_keys(folder.path() / "second"));
  SUCCEEDS(allow_host(keys(), "second PC", folder.path() / "second" / "host.public"));
  LONGS_EQUAL(2, read_allowed_hosts(keys())->size());
  FAILS_NAMING(Errc::InvalidArgument, "no host 'third' in it", revoke_host(keys(), "third"));
  SUCCEEDS(revoke_host(keys(), "second PC"));
  LONGS_EQUAL(1, read_allowed_hosts(keys())->size());
  SUCCEEDS(revoke_host(keys(), key));
  LONGS_EQUAL(0, read_allowed_hosts(keys())->size());
  std::ifstream list{keys() / "hosts.allowed"};
  std::string first;
  std::getline(list, first);
  STRCMP_CONTAINS("# One host a line", first.c_str());
  FAILS_NAMING(Errc::InvalidArgument, "a host's name",
               allow_host(keys(), "two\nlines", keys() / "host.public"));
}

TEST(Keys, LettersThatSayMoreThanTheirBytesHoldAreToldInWords) {
  // 40 letters of the right kind; each five of them exceed 32 bits.
  folder.write("keys/host.public", std::string(40, '#').append("\n"));
  FAILS_NAMING(Errc::BadFormat, "host.public line 1: a key of 40 Z85 characters (32 bytes) expected",
               read_host_keys(keys()));
  folder.write("keys/hosts.allowed", std::string(40, '#').append(" nobody\n").append(40, '%').append(" x\n"));
  FAILS_NAMING(Errc::BadFormat, "hosts.allowed line 2", read_sensor_keys(keys()));
}

}  // namespace biteline::wire
