// SPDX-License-Identifier: MIT
#include "host/records/recording/import.hpp"

#include <CppUTest/TestHarness.h>

#include "common/mcap/writer.hpp"
#include "common/recording/layout.hpp"
#include "common/recording/picture.hpp"
#include "host/records/recording/refused.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/refusals.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::recording {
namespace fs = std::filesystem;

TEST_GROUP(RecordingImport) {
  test::TemporaryFolder folder;
  fs::path file = folder.path() / "a.mcap", out = folder.path() / "out";

  static mcap::View view(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  }
  /// A file of others with one message for each topic, and one attachment.
  void write(const std::vector<std::pair<std::string, std::string>>& messages, const std::string& attached)
      const {
    auto writer = mcap::Writer::create(file, {.library = "another"});
    SUCCEEDS(writer);
    for (const auto& [topic, data] : messages) {
      const auto channel = writer->add_channel(0, topic, "json");
      SUCCEEDS(channel);
      SUCCEEDS(writer->write({.channel_id = *channel,
                              .sequence = 0,
                              .log_time_ns = 1,
                              .publish_time_ns = 1,
                              .data = view(data)}));
    }
    SUCCEEDS(writer->attach({.log_time_ns = 0,
                             .create_time_ns = 0,
                             .name = attached,
                             .media_type = "",
                             .data = view("x"),
                             .crc = 0}));
    SUCCEEDS(writer->close());
  }
  static std::string picture() {
    const auto message = picture_message(1, std::vector<std::uint8_t>{1, 2, 3});
    return {message.begin(), message.end()};
  }
};

TEST(RecordingImport, FileOfAnotherNameStaysOutside) {
  write(
      {{topic::k_frame, R"({"stamp_ns":1,"file":"1.png"})"}, {topic::k_picture, picture()}, {"/other", "x"}},
      "../evil");
  const auto imported = import_mcap(file, out);
  SUCCEEDS(imported);
  LONGS_EQUAL(2, imported->strange);
  LONGS_EQUAL(1, imported->pictures);
  CHECK(fs::exists(out / "cam0/data/1.png"));
  CHECK(!fs::exists(folder.path() / "evil"));
}

TEST(RecordingImport, PictureWithoutItsRowIsRefusedAndNothingIsLeft) {
  write({{topic::k_picture, picture()}}, "a");
  FAILS_NAMING(Errc::BadFormat, "without its row", import_mcap(file, out));
  CHECK(!fs::exists(out) && !fs::exists(out.string() + ".new"));
}

TEST(RecordingImport, FileWithoutARecordingIsRefused) {
  write({{"/imu", "x"}}, "a");
  FAILS_NAMING(Errc::BadFormat, "no pictures on /cam0/image", import_mcap(file, out));
  CHECK(!fs::exists(out));
}

TEST(RecordingImport, TwoPicturesOfOneNameAreRefused) {
  const std::pair<std::string, std::string> row{topic::k_frame, R"({"stamp_ns":1,"file":"1.png"})"};
  write({row, {topic::k_picture, picture()}, row, {topic::k_picture, picture()}}, "a");
  FAILS_NAMING(Errc::WriteFailed, "1.png", import_mcap(file, out));
}

TEST(RecordingImport, RefusalsHaveNamesAndSteps) {
  test::check_refusal_table(Refused::OtherLink);
}

}  // namespace biteline::recording
