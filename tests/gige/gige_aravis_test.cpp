// SPDX-License-Identifier: MIT
// Aravis' own client against the face: description, frames, chunks, and packets that are lost on the way.
#include <CppUTest/TestHarness.h>

#include <atomic>
#include <cfenv>
#include <cmath>
#include <random>
#include <thread>

#include "host/interfaces/gige/server.hpp"
#include "tests/gige/aravis_client.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_profile.hpp"

namespace biteline {

using namespace std::chrono_literals;

TEST_GROUP(GigeAravis) {
  static constexpr std::size_t k_columns = 1000, k_points = 480;
  static constexpr int k_frames = 60, k_lines = 4;
  static constexpr gige::Depth k_depth{
      .scale_mm = 0.01F, .offset_mm = -300, .across = {.scale_mm = 0.002F, .offset_mm = -60}};
  static const char* name_of(gige::Format format) {
    if (format == gige::Format::C16) return "Coord3D_C16";
    return format == gige::Format::Ac16 ? "Coord3D_AC16" : "Coord3D_ABC32f";
  }
  static constexpr std::uint64_t k_scan = 77, k_picture_stamp_ns = 1'000'000;
  std::mt19937 random{5};
  bool noisy{false};               ///< one in a hundred of the frames' packets is lost
  bool losing{false};              ///< just now
  std::atomic<bool> stuck{false};  ///< the network takes no packet of the stream
  std::atomic<int> waiting{0};
  bool wait_for_network() {
    ++waiting;
    while (stuck) std::this_thread::sleep_for(1ms);
    return false;
  }
  std::unique_ptr<gige::Server> server;
  std::unique_ptr<test::AravisClient> client;

  void open_both() {
    const auto all = gige::interfaces();
    SUCCEEDS(all);
    const auto loopback = gige::choose_interface(*all, "127.0.0.1");
    SUCCEEDS(loopback);
    auto opened = gige::Server::open(
        {.interface = *loopback,
         .clients = {},
         .version = "1",
         .serial = "12",
         .name = "face",
         .lose = [this] { return stuck ? wait_for_network() : losing && random() % 100 == 0; }});
    SUCCEEDS(opened);
    server = std::move(*opened);
    server->set_head(k_columns, k_depth);
    auto connected = test::AravisClient::open("127.0.0.1");
    SUCCEEDS(connected);
    client = std::move(*connected);
  }
  void teardown() override {
    client.reset();
    server.reset();
  }

  static profile::Profile made_line(int frame, int line) {
    profile::Profile made = test::made_profile(static_cast<std::uint64_t>(frame * k_lines + line), k_points);
    if (frame % 2 != 0) made.header.encoder_ticks.reset();
    return made;
  }

  /// Another one for each frame.
  static Nanoseconds exposure_of(int frame) {
    return Nanoseconds{400'000 + 1'500 * frame};
  }

  /// The lines of the next frame as they are to arrive, after they were offered.
  std::vector<std::uint8_t> offer_frame(gige::Format format, int frame) const {
    std::vector<std::uint8_t> lines;
    for (int line = 0; line < k_lines; ++line) {
      const profile::Profile made = made_line(frame, line);
      server->offer(k_scan, made);
      const std::vector<std::uint8_t> bytes = gige::line_of(format, k_columns, k_depth, made);
      lines.insert(lines.end(), bytes.begin(), bytes.end());
    }
    return lines;
  }

  static void is_complete(const std::optional<test::ArrivedFrame>& arrived) {
    CHECK_TEXT(arrived, "no frame came");
    const std::string status = "Aravis' status " + std::to_string(arrived->status);
    CHECK_TEXT(arrived->complete, status.c_str());
  }

  void stream_with(gige::Format format, bool chunks) {
    SUCCEEDS(client->choose("PixelFormat", name_of(format)));
    SUCCEEDS(client->set("Height", k_lines));
    SUCCEEDS(client->set("ChunkModeActive", chunks ? 1 : 0));
    SUCCEEDS(client->start(8));
    std::feclearexcept(FE_INVALID | FE_DIVBYZERO);  // raised when Aravis makes its first stream
    const gige::ServerCounts before = server->counts();
    for (int frame = 0; frame < k_frames; ++frame) {
      losing = noisy;
      server->set_exposure(exposure_of(frame));
      const std::vector<std::uint8_t> expected = offer_frame(format, frame);
      // A frame whose end is lost shows that by the next one, which comes whole.
      losing = false;
      server->offer(k_scan, test::made_profile(0, 1));
      server->end_scan();
      const auto arrived = client->next_frame(20s);
      is_complete(arrived);
      is_complete(client->next_frame(20s));
      LONGS_EQUAL(k_columns, arrived->width);
      LONGS_EQUAL(k_lines, arrived->height);
      LONGS_EQUAL(static_cast<std::uint32_t>(format), arrived->pixel_format);
      CHECK(arrived->payload.size() >= expected.size());
      MEMCMP_EQUAL(expected.data(), arrived->payload.data(), expected.size());
      if (!chunks) continue;
      LONGS_EQUAL(frame * k_lines, arrived->sequence);
      std::vector<std::uint8_t> records;
      for (int line = 0; line < k_lines; ++line) {
        const profile::Profile made = made_line(frame, line);
        const std::vector<std::uint8_t> record = gige::line_record(k_scan, made.header, exposure_of(frame));
        records.insert(records.end(), record.begin(), record.end());
        if (line != 0) continue;
        DOUBLES_EQUAL(made.header.T_base_flange.linear()(0, 0), arrived->flange, 0);
        LONGS_EQUAL(made.header.frame_sequence, arrived->camera_frame);
        CHECK_EQUAL(made.header.encoder_ticks.has_value(), arrived->encoder_valid);
        CHECK(made.header.encoder_ticks.value_or(0) == arrived->encoder_ticks);
      }
      CHECK(records == arrived->lines_chunk);
      DOUBLES_EQUAL(1e-3 * static_cast<double>(exposure_of(frame).count()), arrived->exposure_us, 0);
    }
    SUCCEEDS(client->stop());
    const gige::ServerCounts after = server->counts();
    LONGS_EQUAL(0, client->statistics().failed);
    LONGS_EQUAL(0, after.stream.unavailable);
    // A client on a busy machine also asks for what is late.
    CHECK(before.lost == after.lost || after.stream.resent != before.stream.resent);
  }
};

TEST(GigeAravis, ReadsEveryFeatureOfTheDescription) {
  open_both();
  const auto read = client->read_all_features();
  SUCCEEDS(read);
  CHECK(*read > 15);
  STRCMP_EQUAL("Biteline", client->text("DeviceVendorName").value_or("").c_str());
  STRCMP_EQUAL("Linescan3D", client->text("DeviceScanType").value_or("").c_str());
  SUCCEEDS(client->choose("PixelFormat", "Coord3D_C16"));
  SUCCEEDS(client->choose("Scan3dCoordinateSelector", "CoordinateC"));
  DOUBLES_EQUAL(k_depth.scale_mm, client->real("Scan3dCoordinateScale").value_or(0), 0);
  DOUBLES_EQUAL(k_depth.offset_mm, client->real("Scan3dCoordinateOffset").value_or(0), 0);
  DOUBLES_EQUAL(gige::k_no_depth, client->real("Scan3dInvalidDataValue").value_or(0), 0);
  STRCMP_EQUAL("CalibratedC_Linescan", client->text("Scan3dOutputMode").value_or("").c_str());
  SUCCEEDS(client->choose("PixelFormat", "Coord3D_ABC32f"));
  DOUBLES_EQUAL(1, client->real("Scan3dCoordinateScale").value_or(0), 0);
  CHECK(std::isnan(client->real("Scan3dInvalidDataValue").value_or(0)));
  STRCMP_EQUAL("CalibratedABC_Grid", client->text("Scan3dOutputMode").value_or("").c_str());
}

TEST(GigeAravis, FramesAreTheProfiles) {
  open_both();
  stream_with(gige::Format::Abc32f, true);
  LONGS_EQUAL(0, server->counts().lost);
}

TEST(GigeAravis, DepthsAreTheProfiles) {
  open_both();
  stream_with(gige::Format::C16, true);
}

TEST(GigeAravis, ProfilesOfTwoNumbersAreTheProfiles) {
  open_both();
  SUCCEEDS(client->choose("PixelFormat", "Coord3D_AC16"));
  STRCMP_EQUAL("CalibratedAC_Linescan", client->text("Scan3dOutputMode").value_or("").c_str());
  SUCCEEDS(client->choose("Scan3dCoordinateSelector", "CoordinateA"));
  DOUBLES_EQUAL(k_depth.across.scale_mm, client->real("Scan3dCoordinateScale").value_or(0), 0);
  DOUBLES_EQUAL(k_depth.across.offset_mm, client->real("Scan3dCoordinateOffset").value_or(0), 0);
  SUCCEEDS(client->choose("Scan3dCoordinateSelector", "CoordinateB"));
  DOUBLES_EQUAL(1, client->real("Scan3dCoordinateScale").value_or(0), 0);
  stream_with(gige::Format::Ac16, true);
}

TEST(GigeAravis, PicturesAreThePictures) {
  open_both();
  const gige::PictureShape shape =
      gige::picture_shape({.offset_u_px = 0, .offset_v_px = 8, .width_px = 640, .height_px = 480});
  server->set_head(k_columns, k_depth, shape);
  SUCCEEDS(client->choose("PixelFormat", "Mono8"));
  SUCCEEDS(client->set("ChunkModeActive", 1));
  SUCCEEDS(client->start(8));
  std::feclearexcept(FE_INVALID | FE_DIVBYZERO);  // raised when Aravis makes its first stream
  CHECK(server->wants_pictures());
  for (std::uint64_t number = 0; number < 10; ++number) {
    wire::Picture picture;
    picture.profile_sequence = number;
    picture.exposure_mid =
        SensorClock::time_point{Nanoseconds{static_cast<std::int64_t>(k_picture_stamp_ns * (1 + number))}};
    picture.region = shape.region;
    picture.format = wire::PictureFormat::Raw;
    picture.pixels.resize(shape.bytes());
    for (std::uint8_t& pixel : picture.pixels) pixel = static_cast<std::uint8_t>(random());
    server->set_exposure(exposure_of(3));
    server->offer(k_scan, picture);
    const auto arrived = client->next_frame(20s);
    is_complete(arrived);
    LONGS_EQUAL(640, arrived->width);
    LONGS_EQUAL(480, arrived->height);
    LONGS_EQUAL(static_cast<std::uint32_t>(gige::Format::Mono8), arrived->pixel_format);
    MEMCMP_EQUAL(picture.pixels.data(), arrived->payload.data(), picture.pixels.size());
    LONGS_EQUAL(number, arrived->sequence);
    LONGS_EQUAL(k_picture_stamp_ns * (1 + number), arrived->stamp);
    CHECK(arrived->lines_chunk == gige::picture_record(k_scan, picture, exposure_of(3)));
  }
  SUCCEEDS(client->stop());
  LONGS_EQUAL(0, client->statistics().failed);
}

TEST(GigeAravis, NetworkThatTakesNoPacketHoldsUpNoCommand) {
  open_both();
  SUCCEEDS(client->start(8));
  stuck = true;
  std::thread offering{[this] { server->offer(k_scan, made_line(0, 0)); }};
  while (waiting == 0) std::this_thread::sleep_for(1ms);
  const auto answered = client->text("PixelFormat");
  const bool acquiring = server->acquiring();
  const auto stopped = client->stop();
  stuck = false;
  offering.join();
  SUCCEEDS(answered);
  STRCMP_EQUAL("Coord3D_ABC32f", answered->c_str());
  CHECK(acquiring);
  SUCCEEDS(stopped);
}

TEST(GigeAravis, LostPacketsAreSentAgain) {
  open_both();
  noisy = true;
  stream_with(gige::Format::Abc32f, false);
  CHECK(server->counts().lost > 10);
  CHECK(server->counts().stream.resent >= server->counts().lost);
}

}  // namespace biteline
