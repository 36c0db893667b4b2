// SPDX-License-Identifier: MIT
#include "common/wire/keys.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::wire {

TEST_GROUP(Keys) {
  test::TemporaryFolder folder;

  void setup() override {
    SUCCEEDS(make_keys(folder.path() / "keys"));
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
  FAILS_NAMING(Errc::WrongState, "never overwritten", make_keys(keys()));
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

}  // namespace biteline::wire
