// SPDX-License-Identifier: MIT
// A change of the sensor's settings on its way from a door to the sensor and back.
#include <CppUTest/TestHarness.h>

#include <future>

#include "common/settings/settings.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/apps/opened_operator_control.hpp"

namespace biteline::service {

using settings::Key;

TEST_GROUP(OperatorControlSettings) {
  test::TemporaryFolder folder;
  std::unique_ptr<OperatorControl> sut;

  void setup() override {
    sut = test::opened_operator_control(folder.path());
  }
  void hear_sensor() {
    wire::Health health;
    health.settings = wire::SettingsState{
        .text = "camera:\n  exposure_us: 250\n  gain: 3\npeaks:\n  choice: first\n...\n", .changes = 0};
    sut->hear(health);
  }
  std::future<Result<void>> change(std::vector<api::SettingChange> changes) {
    return std::async(std::launch::async,
                      [this, changes = std::move(changes)] { return sut->change_settings(changes, "eng"); });
  }
  OperatorCommand command() {
    for (int i = 0; i < 1000; ++i) {
      if (const auto found = sut->next_command()) return *found;
      std::this_thread::sleep_for(std::chrono::milliseconds{2});
    }
    FAIL("no command came");
    return {};
  }
  static api::SettingChange exposure(double us) {
    return {.key = Key::ExposureUs, .value = settings::Value{.number = us}};
  }
};

TEST(OperatorControlSettings, TheSetInUseGoesWholeWithTheChangesAndTheSensorsWordComesBack) {
  hear_sensor();
  auto done = change({exposure(300), {.key = Key::Gain, .value = {}}});
  const OperatorCommand asked = command();
  CHECK(asked.kind == OperatorCommand::Kind::Settings);
  STRCMP_EQUAL("eng", asked.who.c_str());
  const auto set = settings::parse_settings(asked.settings, "sent");
  SUCCEEDS(set);
  DOUBLES_EQUAL(300, set->number(Key::ExposureUs).value_or(0), 0);
  CHECK(!set->at(Key::Gain));
  STRCMP_EQUAL("first", set->word(Key::PeakChoice).value_or("").c_str());
  FAILS_NAMING(Errc::WrongState, "another change is on its way", sut->change_settings({exposure(1)}, "ada"));
  // The word to another question is not to this one.
  sut->answer_sensor(asked.question - 1, fail(Errc::PeerRefused, "too late"));
  sut->answer_sensor(asked.question, {});
  SUCCEEDS(done.get());

  auto again = change({{.key = Key::PeakChoice, .value = settings::Value{.word = "last"}}});
  const OperatorCommand second = command();
  CHECK(second.question != asked.question);
  // The sensor has not told its settings again yet: the change before stays.
  const auto kept = settings::parse_settings(second.settings, "sent");
  SUCCEEDS(kept);
  DOUBLES_EQUAL(300, kept->number(Key::ExposureUs).value_or(0), 0);
  CHECK(!kept->at(Key::Gain));
  sut->answer_sensor(second.question, fail(Errc::PeerRefused, "camera.exposure_us: at most 300 us"));
  FAILS_NAMING(Errc::PeerRefused, "at most 300 us", again.get());
}

TEST(OperatorControlSettings, WithoutASensorOrWithoutSenseNothingIsSent) {
  FAILS_NAMING(Errc::WrongState, "no sensor", sut->change_settings({exposure(300)}, "eng"));
  sut->hear(wire::Health{});
  FAILS_NAMING(Errc::WrongState, "takes no settings", sut->change_settings({exposure(300)}, "eng"));
  hear_sensor();
  FAILS_NAMING(
      Errc::BadValue, "more than exposure_us",
      sut->change_settings({{.key = Key::SecondExposureUs, .value = settings::Value{.number = 100}}}, "eng"));
  CHECK(!sut->next_command());
}

TEST(OperatorControlSettings, ASensorThatGoesAwayAnswersForItself) {
  hear_sensor();
  auto done = change({exposure(300)});
  static_cast<void>(command());
  sut->lose_sensor("silent for 5 s");
  FAILS_NAMING(Errc::WrongState, "silent for 5 s", done.get());
}

TEST(OperatorControlSettings, ARecordingIsAskedForAndTheSensorsWordComesBack) {
  FAILS_NAMING(Errc::WrongState, "no sensor", sut->keep_recording(false, "ada"));
  wire::SensorHello hello;
  hello.name = "head 3";
  hello.protocol_minor = 2;
  sut->hear(hello);
  FAILS_NAMING(Errc::WrongState, "head 3 keeps no recording over the network: it is older than protocol 1.3",
               sut->keep_recording(false, "ada"));
  CHECK(!sut->next_command());
  hello.protocol_minor = wire::k_least_minor_to_keep;
  sut->hear(hello);
  hear_sensor();
  const auto keep = [this](bool next) {
    return std::async(std::launch::async, [this, next] { return sut->keep_recording(next, "ada"); });
  };
  auto last = keep(false);
  OperatorCommand asked = command();
  CHECK(asked.kind == OperatorCommand::Kind::Keep && asked.command == wire::Command::KeepLast);
  FAILS_NAMING(Errc::WrongState, "on its way", sut->change_settings({exposure(300)}, "eng"));
  sut->answer_sensor(asked.question, Result<std::string>{"/data/scan-2"});
  const Result<std::string> kept = last.get();
  SUCCEEDS(kept);
  STRCMP_EQUAL("/data/scan-2", kept->c_str());
  auto next = keep(true);
  asked = command();
  CHECK(asked.command == wire::Command::KeepNext);
  sut->answer_sensor(asked.question, fail(Errc::PeerRefused, "this sensor records nothing"));
  FAILS_NAMING(Errc::PeerRefused, "records nothing", next.get());
}

}  // namespace biteline::service
