// SPDX-License-Identifier: MIT
#pragma once
/// \file A small MCAP file with every kind of record.

#include <CppUTest/TestHarness.h>

#include <fstream>
#include <iterator>

#include "common/mcap/writer.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::mcap {

inline View view(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

inline std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A new file each time: cutting one that is there to nothing waits for some disks.
inline std::filesystem::path put(const test::TemporaryFolder& folder, const std::string& bytes) {
  std::filesystem::remove(folder.path() / "spoiled.mcap");
  return folder.write("spoiled.mcap", bytes);
}

/// Nine messages of two channels in chunks of three, a settings file, and who built it.  The chain's last
/// link goes to `link`.
inline std::string made_file(const std::filesystem::path& file, Compression compression,
                             std::string* link = nullptr) {
  auto writer = Writer::create(file, {.library = "test", .compression = compression, .chunk_bytes = 200});
  SUCCEEDS(writer);
  const auto schema = writer->add_schema("Pose", "jsonschema", R"({"type":"object"})");
  SUCCEEDS(schema);
  const auto poses = writer->add_channel(*schema, "/pose", "json", {{"frame", "base"}});
  const auto raw = writer->add_channel(0, "/raw", "");
  SUCCEEDS(poses);
  SUCCEEDS(raw);
  const std::string settings = "rate_hz: 25\n";
  SUCCEEDS(writer->attach({.log_time_ns = 1,
                           .create_time_ns = 2,
                           .name = "settings.yaml",
                           .media_type = "text/yaml",
                           .data = view(settings),
                           .crc = 0}));
  SUCCEEDS(writer->add_metadata({.name = "build", .values = {{"version", "1"}, {"compiler", "g++"}}}));
  for (std::uint32_t i = 0; i < 9; ++i) {
    const std::string text = "message " + std::to_string(i) + std::string(50, 'a');
    SUCCEEDS(writer->write({.channel_id = i % 3 == 0 ? *raw : *poses,
                            .sequence = i,
                            .log_time_ns = 100 + 10 * i,
                            .publish_time_ns = i,
                            .data = view(text)}));
  }
  const auto last = writer->close();
  SUCCEEDS(last);
  if (link != nullptr) *link = *last;
  return content(file);
}

}  // namespace biteline::mcap
