// SPDX-License-Identifier: MIT
#include "common/wire/scan_file.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::wire {

TEST_GROUP(ScanFile) {
  test::TemporaryFolder folder;
  std::string text{k_scan_file_magic};
  std::vector<std::size_t> ends;  ///< of each record

  void add(const Message& message) {
    Bytes bytes, record;
    encode(message, bytes);
    make_scan_record(bytes, record);
    text.append(record.begin(), record.end());
    ends.push_back(text.size());
  }
  void setup() override {
    SensorHello hello;
    hello.model.camera = {.fu_px = 2000, .fv_px = 2000, .cu_px = 32, .cv_px = 32};
    hello.model.laser_plane = {.normal_cam = Vec3{0, 0, 1}, .distance_mm = 100};
    hello.model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 64, .height_px = 64};
    add({.scan_id = 3, .body = std::move(hello)});
    for (std::uint64_t i = 0; i < 4; ++i) add({.scan_id = 3, .sequence = i, .body = profile::Profile{}});
  }
  Result<ScanFileEnd> read(const std::string& bytes) const {
    return read_scan_file(folder.write("scan.btln", bytes),
                          [](const Message&, std::span<const std::uint8_t>) { return Result<void>{}; });
  }
};

TEST(ScanFile, CutFileGivesAllBeforeTheCut) {
  for (std::size_t size = ends[0]; size <= text.size(); ++size) {
    const auto end = read(text.substr(0, size));
    SUCCEEDS(end);
    const auto whole = static_cast<std::size_t>(
        std::count_if(ends.begin(), ends.end(), [&](std::size_t at) { return at <= size; }));
    LONGS_EQUAL(whole, end->messages);
    LONGS_EQUAL(size - ends[whole - 1], end->bytes_left);
  }
}

TEST(ScanFile, FlippedByteEndsItThere) {
  for (std::size_t at = ends[1]; at < ends[2]; ++at) {
    std::string spoiled = text;
    spoiled[at] = static_cast<char>(spoiled[at] ^ 0x10);
    const auto end = read(spoiled);
    SUCCEEDS(end);
    LONGS_EQUAL(2, end->messages);
    CHECK(end->bytes_left > 0);
  }
}

TEST(ScanFile, WhatIsNoScanIsRefused) {
  FAILS_NAMING(Errc::BadFormat, "not a recorded scan", read("BTLNSCAM"));
  FAILS_NAMING(Errc::BadFormat, "without its beginning", read(text.substr(0, ends[0] - 1)));
}

}  // namespace biteline::wire
