// SPDX-License-Identifier: MIT
#include "common/recording/recording_writer.hpp"

#include <CppUTest/TestHarness.h>

#include <map>

#include "common/mcap/reader.hpp"
#include "common/mcap/verify.hpp"
#include "common/recording/layout.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::recording {

namespace {

using Texts = std::vector<std::string>;

struct Read {
  mcap::FileEnd end;
  std::map<std::string, Texts> topics;                      ///< messages by topic, as they stand in the file
  std::map<std::string, std::vector<std::uint64_t>> times;  ///< their log times [ns]
  std::vector<std::pair<std::string, std::string>> attached;
};

std::string text_of(mcap::View bytes) {
  return {bytes.begin(), bytes.end()};
}

}  // namespace

TEST_GROUP(RecordingWriter) {
  test::TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "a.mcap";

  RecordingWriter begun() const {
    auto writer = RecordingWriter::create(file, {.library = "a test", .build = "a test 1", .packed = false});
    SUCCEEDS(writer);
    SUCCEEDS(writer->attach("recording.yaml", "first"));
    SUCCEEDS(writer->add_channels());
    return std::move(*writer);
  }
  static wire::Message hello() {
    wire::SensorHello hello;
    hello.name = "left";
    return {.scan_id = 7, .body = std::move(hello)};
  }
  static void add(RecordingWriter & writer, const wire::Message& message) {
    wire::Bytes bytes;
    wire::encode(message, bytes);
    SUCCEEDS(writer.add_message(message, bytes));
  }
  Read read() const {
    Read all;
    const auto end = mcap::read_messages(
        file, {.on_message =
                   [&](const mcap::Channel& channel, const mcap::Schema*, const mcap::Message& message) {
                     all.topics[channel.topic].push_back(text_of(message.data));
                     all.times[channel.topic].push_back(message.log_time_ns);
                     return Result<void>{};
                   },
               .on_attachment =
                   [&](const mcap::Attachment& attachment) {
                     all.attached.emplace_back(attachment.name, text_of(attachment.data));
                     return Result<void>{};
                   },
               .on_metadata = {}});
    SUCCEEDS(end);
    all.end = *end;
    return all;
  }
};

TEST(RecordingWriter, HelloGetsTheTimeOfWhatComesNext) {
  RecordingWriter writer = begun();
  add(writer, hello());
  SUCCEEDS(writer.add_pose({.stamp_ns = 900, .values = {1, 2, 3, 1, 0, 0, 0}}, 500));
  SUCCEEDS(writer.close());
  const Read all = read();
  LONGS_EQUAL(500, all.times.at(topic::k_scan).at(0));
  LONGS_EQUAL(500, all.times.at(topic::k_event).at(0));
  STRCMP_CONTAINS("\"sensor\":\"left\"", all.topics.at(topic::k_event).at(0).c_str());
  STRCMP_CONTAINS("\"stamp_ns\":900", all.topics.at(topic::k_pose).at(0).c_str());
}

TEST(RecordingWriter, ScanWithoutAnyTimeKeepsItsMessages) {
  RecordingWriter writer = begun();
  add(writer, hello());
  add(writer, {.scan_id = 7, .sequence = 1, .body = wire::EndOfScan{}});
  SUCCEEDS(writer.close());
  LONGS_EQUAL(2, read().topics.at(topic::k_scan).size());
}

TEST(RecordingWriter, FileAttachedAgainStandsBehindTheFirst) {
  RecordingWriter writer = begun();
  SUCCEEDS(writer.add_pose({.stamp_ns = 1, .values = {0, 0, 0, 1, 0, 0, 0}}, 1));
  SUCCEEDS(writer.attach("recording.yaml", "last"));
  SUCCEEDS(writer.close());
  const Read all = read();
  LONGS_EQUAL(2, all.attached.size());
  STRCMP_EQUAL("last", all.attached[1].second.c_str());
  const auto verdict = mcap::verify(file);
  SUCCEEDS(verdict);
  CHECK(verdict->faults.empty());
}

TEST(RecordingWriter, WhatWasFlushedIsThereWithoutAnEnd) {
  RecordingWriter writer = begun();
  SUCCEEDS(writer.add_pose({.stamp_ns = 1, .values = {0, 0, 0, 1, 0, 0, 0}}, 1));
  LONGS_EQUAL(0, read().topics.size());
  SUCCEEDS(writer.flush());
  const Read all = read();
  LONGS_EQUAL(1, all.topics.at(topic::k_pose).size());
  CHECK(!all.end.damage.empty());
}

}  // namespace biteline::recording
