// SPDX-License-Identifier: MIT
#include "firmware/app/picture.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>
#include <memory>
#include <random>
#include <thread>

#include "common/image/jpeg.hpp"
#include "firmware/app/picture_maker.hpp"
#include "tests/support/errors.hpp"

namespace biteline::sensor {
namespace {

using std::chrono::milliseconds;

/// Rows 10 to 29 of a head's region of 40 x 30 pixels at (100, 200); a pixel's grey is its column plus its
/// row.
constexpr geometry::Region k_head{.offset_u_px = 100, .offset_v_px = 200, .width_px = 40, .height_px = 30};

pipeline::TappedPicture made_frame() {
  pipeline::TappedPicture tapped;
  tapped.width_px = 40;
  tapped.height_px = 20;
  tapped.first_row_px = 10;
  tapped.frame_sequence = 9;
  tapped.profile_sequence = 5;
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 40; ++column)
      tapped.pixels.push_back(static_cast<std::uint8_t>(column + row));
  }
  tapped.peaks = {{.column = 3, .row_px = 212.5F, .flags = 0},
                  {.column = 4, .row_px = 213.5F, .flags = profile::k_point_reflection}};
  tapped.peak_count = 2;
  return tapped;
}

wire::PictureWish raw(int width_max_px) {
  return {.rate_hz = 10, .width_max_px = width_max_px, .format = wire::PictureFormat::Raw};
}

}  // namespace

TEST_GROUP(MakePicture){};

TEST(MakePicture, WholeFrameKeepsItsPixelsAndSaysWhereItLies) {
  const auto picture = make_picture(made_frame(), k_head, raw(40));
  SUCCEEDS(picture);
  LONGS_EQUAL(1, picture->step);
  LONGS_EQUAL(100, picture->region.offset_u_px);
  LONGS_EQUAL(210, picture->region.offset_v_px);
  CHECK(picture->pixels == made_frame().pixels);
  LONGS_EQUAL(9, picture->frame_sequence);
  LONGS_EQUAL(5, picture->profile_sequence);
  LONGS_EQUAL(104, picture->peaks[1].u_px);
  DOUBLES_EQUAL(213.5, picture->peaks[1].v_px, 0);
  LONGS_EQUAL(profile::k_point_reflection, picture->peaks[1].flags);
  // The peak of column 3 in row 212.5 lies between the frame's rows 2 and 3.
  DOUBLES_EQUAL(3, picture->x_of(103), 1e-12);
  DOUBLES_EQUAL(2.5, picture->y_of(212.5), 1e-12);
}

TEST(MakePicture, IsScaledByTheLeastWholeNumberThatFits) {
  const auto picture = make_picture(made_frame(), k_head, raw(15));
  SUCCEEDS(picture);
  LONGS_EQUAL(3, picture->step);  // 40 / 3 = 13 columns; 40 / 2 = 20 would be too wide
  LONGS_EQUAL(13, picture->width_px());
  LONGS_EQUAL(6, picture->height_px());
  for (int y = 0; y < 6; ++y) {
    // The mean of a plane over 3 x 3 pixels is its value in their middle.
    for (int x = 0; x < 13; ++x)
      LONGS_EQUAL(3 * x + 1 + 3 * y + 1, picture->pixels[static_cast<std::size_t>(13 * y + x)]);
  }
}

TEST(MakePicture, ShowsTheRegionAskedForAsFarAsTheCameraDoes) {
  wire::PictureWish wish = raw(40);
  wish.region = {.offset_u_px = 130, .offset_v_px = 190, .width_px = 50, .height_px = 25};
  const auto picture = make_picture(made_frame(), k_head, wish);
  SUCCEEDS(picture);
  LONGS_EQUAL(10, picture->width_px());
  LONGS_EQUAL(5, picture->height_px());
  LONGS_EQUAL(30, picture->pixels[0]);
  LONGS_EQUAL(39 + 4, picture->pixels[49]);
  wish.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 50, .height_px = 25};
  FAILS_NAMING(Errc::OutOfReach, "nothing of what was asked for", make_picture(made_frame(), k_head, wish));
}

TEST(MakePicture, JpegShowsTheSamePicture) {
  wire::PictureWish wish = raw(40);
  wish.format = wire::PictureFormat::Jpeg;
  wish.quality = 95;
  const auto picture = make_picture(made_frame(), k_head, wish);
  SUCCEEDS(picture);
  const auto image = image::decode_jpeg(picture->pixels);
  SUCCEEDS(image);
  LONGS_EQUAL(40, image->width_px);
  LONGS_EQUAL(20, image->height_px);
  DOUBLES_EQUAL(39 + 19, image->at(39, 19), 6);
}

/// Noise cannot be packed: a picture of 2448 x 2048 at full quality is scaled until it fits a message.
TEST(MakePicture, NeverOutgrowsAMessage) {
  const geometry::Region head{.offset_u_px = 0, .offset_v_px = 0, .width_px = 2448, .height_px = 2048};
  pipeline::TappedPicture tapped;
  tapped.width_px = head.width_px;
  tapped.height_px = head.height_px;
  std::mt19937 random{1};
  tapped.pixels.resize(std::size_t{2448} * 2048);
  for (std::uint8_t& pixel : tapped.pixels) pixel = static_cast<std::uint8_t>(random());
  tapped.peaks.assign(profile::k_max_profile_points, {.column = 9, .row_px = 1.1F, .flags = 3});
  tapped.peak_count = tapped.peaks.size();
  for (const wire::PictureFormat format : {wire::PictureFormat::Raw, wire::PictureFormat::Jpeg}) {
    wire::PictureWish wish{.rate_hz = 1, .width_max_px = 5000, .format = format, .quality = 100};
    const auto picture = make_picture(tapped, head, wish);
    SUCCEEDS(picture);
    CHECK(picture->step > 1);
    wire::Bytes packet;
    wire::encode({.body = *picture}, packet);
    CHECK(packet.size() <= wire::k_max_message_bytes);
    SUCCEEDS(wire::decode(packet));
  }
}

TEST_GROUP(PictureMaker) {
  std::shared_ptr<pipeline::PictureTap> tap = std::make_shared<pipeline::PictureTap>(k_head);
  std::unique_ptr<profile::ProfileBuffer> profile = std::make_unique<profile::ProfileBuffer>();
  pipeline::TappedPicture frame_pixels = made_frame();
  PictureMaker sut{runtime::RealtimeDemand::Ignored};
  std::uint64_t frames{0};

  /// As the acquisition thread.  True: this frame was wanted.
  bool frame_comes() {
    ++frames;
    if (!tap->rt_wanted()) return false;
    profile->header.sequence = frames;
    tap->rt_keep_peaks(*profile);
    tap->rt_keep_frame({.pixels = frame_pixels.pixels,
                        .width_px = 40,
                        .height_px = 20,
                        .first_row_px = 10,
                        .stride_bytes = 40,
                        .sequence = frames,
                        .exposure_mid = {}});
    return true;
  }
  void order(std::vector<wire::PictureWish> wishes) {
    while (!sut.try_order({.tap = tap, .scan_id = 4, .wishes = wishes})) std::this_thread::yield();
  }
  /// Frames until so many pictures are there; 0 when none come for long.
  std::vector<stream::MadePicture> made(std::size_t count) {
    std::vector<stream::MadePicture> all;
    for (int turn = 0; turn < 20'000 && all.size() < count; ++turn) {
      frame_comes();
      std::this_thread::sleep_for(milliseconds{1});
      for (stream::MadePicture& one : sut.try_take()) all.push_back(std::move(one));
    }
    return all;
  }
};

TEST(PictureMaker, MakesEachWishOfTheSameFrames) {
  sut.start();
  order({raw(40), raw(20)});
  const auto pictures = made(6);
  CHECK(pictures.size() >= 6);
  int wide = 0, narrow = 0;
  for (const stream::MadePicture& made : pictures) {
    LONGS_EQUAL(4, made.scan_id);
    const auto message = wire::decode(made.packet);
    SUCCEEDS(message);
    const auto& picture = std::get<wire::Picture>(message->body);
    LONGS_EQUAL(made.wish.width_max_px, picture.width_px());
    LONGS_EQUAL(picture.frame_sequence, picture.profile_sequence);
    (picture.width_px() == 40 ? wide : narrow) += 1;
  }
  CHECK(wide >= 2 && narrow >= 2);
  CHECK(sut.made() >= pictures.size());
}

TEST(PictureMaker, TakesNothingFromTheHotPathWhileNobodyAsks) {
  sut.start();
  order({});
  for (int i = 0; i < 50; ++i) {
    CHECK(!frame_comes());
    std::this_thread::sleep_for(milliseconds{1});
  }
  LONGS_EQUAL(0, sut.made());
}

TEST(PictureMaker, AsksForFewerFramesThanItSeesAndForNoneOnceTheWishIsGone) {
  sut.start();
  wire::PictureWish slow = raw(40);
  slow.rate_hz = 0.001;  // the first at once, the next in a quarter of an hour
  order({slow});
  LONGS_EQUAL(1, made(1).size());
  for (int i = 0; i < 50; ++i) {
    CHECK(!frame_comes());
    std::this_thread::sleep_for(milliseconds{1});
  }
  LONGS_EQUAL(1, sut.made());
}

}  // namespace biteline::sensor
