// SPDX-License-Identifier: MIT
// The V4L2 camera on vivid: conformance, pictures bit for bit through its loop, and the faults that it can
// make.
#include <CppUTest/TestHarness.h>

#include <cstring>

#include "hal/linux/v4l2/v4l2_camera.hpp"
#include "tests/hal/conformance/camera.hpp"
#include "tests/hal/kernel/skip.hpp"
#include "tests/hal/kernel/vivid.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;
using test::PictureFeeder;
using test::VividNodes;

constexpr int k_width_px = 640;
constexpr int k_height_px = 480;
constexpr int k_header_bytes = 4;
constexpr const char* k_heap = "/dev/dma_heap/system";

/// Picture `number`: its number in the first bytes of every row, then a texture of its own.
std::uint8_t texture(std::uint32_t number, int u_px, int v_px) {
  return static_cast<std::uint8_t>(number * 7U + static_cast<unsigned>(u_px) * 3U +
                                   static_cast<unsigned>(v_px) * 5U);
}

void paint(std::uint32_t number, std::span<std::uint8_t> pixels) {
  for (int v = 0; v < k_height_px; ++v) {
    std::uint8_t* const row = pixels.data() + static_cast<std::size_t>(v) * k_width_px;
    std::memcpy(row, &number, k_header_bytes);
    for (int u = k_header_bytes; u < k_width_px; ++u) row[u] = texture(number, u, v);
  }
}

/// Pixels of the frame that are not those of the picture that its first bytes name, which is given in
/// `number`.
int wrong_pixels(const FrameView& frame, const geometry::Region& region, std::uint32_t& number) {
  std::memcpy(&number, frame.pixels.data(), k_header_bytes);
  int wrong = 0;
  for (int v = 0; v < frame.height_px; ++v) {
    const std::uint8_t* const row = frame.pixels.data() + static_cast<std::size_t>(v) * frame.stride_bytes;
    for (int u = k_header_bytes; u < frame.width_px; ++u)
      wrong += row[u] != texture(number, u, v + region.offset_v_px);
  }
  return wrong;
}

#define VIVID_OR_SKIP(name)                                            \
  const std::optional<VividNodes> name##_found = test::find_vivid();   \
  BITELINE_DEVICE_OR_SKIP(name##_found ? "/" : "/dev/video0 (vivid)"); \
  const VividNodes& name = *name##_found;                              \
  test::loop_vivid(name, k_width_px, k_height_px)

geometry::Region whole() {
  return {.width_px = k_width_px, .height_px = k_height_px};
}

TEST_GROUP(VideoKernel){std::unique_ptr<V4l2Camera> open(const VividNodes& nodes){
    return V4l2Camera::open({.device = nodes.capture}).value();
}  // namespace

std::unique_ptr<V4l2Camera> running(const VividNodes& nodes) {
  auto camera = open(nodes);
  CHECK(camera->configure({.region = whole()}).has_value());
  CHECK(camera->start().has_value());
  return camera;
}

void check_pictures(const VividNodes& nodes, BufferMemory memory) {
  const geometry::Region part{.offset_v_px = 112, .width_px = 640, .height_px = 128};
  const geometry::Region larger{.offset_v_px = 96, .width_px = 640, .height_px = 160};
  // Rectangles left in the driver must not be scaled into those after them.
  for (const geometry::Region& region : {whole(), part, larger, whole()}) {
    const PictureFeeder feeder{nodes, k_width_px, k_height_px, paint};
    const auto sut = V4l2Camera::open({.device = nodes.capture, .memory = memory}).value();
    CHECK(sut->configure({.region = region}).has_value());
    CHECK(sut->start().has_value());
    std::uint32_t last_number = 0;
    for (int i = 0; i < 60; ++i) {
      const Result<FrameView> frame = sut->next_frame(5s);
      CHECK(frame.has_value());
      std::uint32_t number = 0;
      CHECK_EQUAL(0, wrong_pixels(*frame, region, number));
      CHECK(number >= last_number);
      CHECK_EQUAL(0, frame->flags & k_frame_damaged);
      last_number = number;
      sut->release(*frame);
    }
  }
}
};  // namespace biteline::hal

TEST(VideoKernel, CameraConforms) {
  VIVID_OR_SKIP(nodes);
  conformance::check_camera(*open(nodes), {.settings = {.region = whole()}});
  conformance::check_camera(
      *open(nodes),
      {.settings = {.region = {.offset_u_px = 0, .offset_v_px = 100, .width_px = 640, .height_px = 96}}});
}

TEST(VideoKernel, StarvedCameraSaysSoAndGoesOn) {
  VIVID_OR_SKIP(nodes);
  conformance::check_camera_starved(*open(nodes), {.settings = {.region = whole()}});
}

TEST(VideoKernel, PicturesComeThroughBitForBit) {
  VIVID_OR_SKIP(nodes);
  check_pictures(nodes, BufferMemory::Mapped);
}

TEST(VideoKernel, PicturesComeThroughDmaBufBitForBit) {
  VIVID_OR_SKIP(nodes);
  BITELINE_DEVICE_OR_SKIP(k_heap);
  conformance::check_camera(
      *V4l2Camera::open({.device = nodes.capture, .memory = BufferMemory::DmaBuf}).value(),
      {.settings = {.region = whole()}});
  check_pictures(nodes, BufferMemory::DmaBuf);
}

TEST(VideoKernel, HeapThatIsNotThereIsSaid) {
  VIVID_OR_SKIP(nodes);
  const auto sut =
      V4l2Camera::open(
          {.device = nodes.capture, .memory = BufferMemory::DmaBuf, .heap = "/dev/dma_heap/none"})
          .value();
  CHECK(sut->configure({.region = whole()}).has_value());
  CHECK(sut->start().error().code == Errc::DeviceNotFound);
}

TEST(VideoKernel, StampsAreOnTheMonotonicClockAndSure) {
  VIVID_OR_SKIP(nodes);
  const auto sut = running(nodes);
  for (int i = 0; i < 10; ++i) {
    const Result<FrameView> frame = sut->next_frame(5s);
    CHECK(frame.has_value());
    CHECK_EQUAL(0, frame->flags & k_frame_stamp_uncertain);
    CHECK(frame->exposure_mid < monotonic_now() + 1ms);
    CHECK(frame->exposure_mid > monotonic_now() - 2s);
    sut->release(*frame);
  }
}

TEST(VideoKernel, EndOfFrameStampIsUncertainUntilTheReadoutIsTold) {
  VIVID_OR_SKIP(nodes);
  CHECK(test::set_control(nodes.capture, "Timestamp Source", 0));
  for (const std::optional<Nanoseconds> readout :
       {std::optional<Nanoseconds>{}, std::optional<Nanoseconds>{5ms}}) {
    const auto sut = V4l2Camera::open({.device = nodes.capture, .readout = readout}).value();
    CHECK(sut->configure({.region = whole()}).has_value());
    CHECK(sut->start().has_value());
    const Result<FrameView> frame = sut->next_frame(5s);
    CHECK(frame.has_value());
    CHECK_EQUAL(!readout.has_value(), (frame->flags & k_frame_stamp_uncertain) != 0);
  }
}

TEST(VideoKernel, EveryGreyFormatGivesTheSameEightBits) {
  VIVID_OR_SKIP(nodes);
  CHECK(test::set_control(nodes.capture, "Loop Video", 0));
  CHECK(test::set_control(nodes.capture, "Test Pattern", 10));  // squares of 16 x 16, black and white
  std::vector<std::uint8_t> grey8;
  for (const PixelFormat format :
       {PixelFormat::Grey8, PixelFormat::Grey10In16, PixelFormat::Grey12In16, PixelFormat::Grey16}) {
    const auto sut = V4l2Camera::open({.device = nodes.capture, .format = format}).value();
    CHECK(sut->configure({.region = whole()}).has_value());
    CHECK(sut->start().has_value());
    const Result<FrameView> frame = sut->next_frame(5s);
    CHECK(frame.has_value());
    if (grey8.empty()) grey8.assign(frame->pixels.begin(), frame->pixels.end());
    CHECK(grey8[8] != grey8[24]);
    CHECK(std::equal(grey8.begin(), grey8.end(), frame->pixels.begin(), frame->pixels.end()));
    sut->release(*frame);
  }
  CHECK(test::set_control(nodes.capture, "Test Pattern", 0));
}

TEST(VideoKernel, FormatThatTheDriverLacksIsSaid) {
  VIVID_OR_SKIP(nodes);
  CHECK(V4l2Camera::open({.device = nodes.capture, .format = PixelFormat::Grey12Packed}).error().code ==
        Errc::NotSupported);
}

TEST(VideoKernel, DroppedBuffersAreGapsAndCounted) {
  VIVID_OR_SKIP(nodes);
  const auto sut = running(nodes);
  CHECK(test::set_control(nodes.capture, "Percentage of Dropped Buffers", 5));
  std::uint64_t last = 0;
  std::uint64_t flagged = 0;
  constexpr std::uint64_t k_frames = 200;  // none of them dropped: once in 30 000 runs
  for (std::uint64_t i = 0; i < k_frames; ++i) {
    const Result<FrameView> frame = sut->next_frame(5s);
    CHECK(frame.has_value());
    flagged += (frame->flags & k_frame_gap_before) != 0;
    last = frame->sequence;
    sut->release(*frame);
  }
  static_cast<void>(test::set_control(nodes.capture, "Percentage of Dropped Buffers", 0));
  CHECK(flagged > 0);
  CHECK_EQUAL(last - k_frames,
              sut->health().frames_lost);  // numbered from 1, so those before the first one count too
}

TEST(VideoKernel, BufferWithErrorFlagIsGivenOutFlagged) {
  VIVID_OR_SKIP(nodes);
  const auto sut = running(nodes);
  // A button: the next buffer only.
  CHECK(test::set_control(nodes.capture, "Inject V4L2_BUF_FLAG_ERROR", 1));
  std::uint64_t damaged = 0;
  for (int i = 0; i < 30; ++i) {
    const Result<FrameView> frame = sut->next_frame(5s);
    CHECK(frame.has_value());
    damaged += (frame->flags & k_frame_damaged) != 0;
    sut->release(*frame);
  }
  CHECK(damaged > 0);
  CHECK_EQUAL(damaged, sut->health().frames_damaged);
}

TEST(VideoKernel, StreamThatTheDriverGaveUpIsLostAndANewOneWorks) {
  VIVID_OR_SKIP(nodes);
  auto sut = running(nodes);
  CHECK(sut->next_frame(5s).has_value());
  CHECK(test::set_control(nodes.capture, "Inject Fatal Streaming Error", 1));
  Result<FrameView> frame = sut->next_frame(5s);
  for (int i = 0; i < 20 && frame; ++i) frame = sut->next_frame(5s);
  CHECK(frame.error().code == Errc::DeviceLost);
  CHECK(sut->next_frame(0ns).error().code == Errc::DeviceLost);
  CHECK_FALSE(sut->health().connected);
  sut.reset();
  sut = running(nodes);
  CHECK(sut->next_frame(5s).has_value());
}

TEST(VideoKernel, UnpluggedCameraIsLostAndWorksAgainWhenBack) {
  VIVID_OR_SKIP(nodes);
  auto sut = running(nodes);
  CHECK(sut->next_frame(5s).has_value());
  // The driver puts its nodes back when the last of its users closed them.
  CHECK(test::set_control(nodes.capture, "Disconnect", 1));
  Result<FrameView> frame = sut->next_frame(5s);
  for (int i = 0; i < 20 && frame; ++i) frame = sut->next_frame(5s);
  CHECK(frame.error().code == Errc::DeviceLost);
  CHECK(sut->stop().has_value());
  sut.reset();
  sut = running(nodes);
  CHECK(sut->next_frame(5s).has_value());
}

TEST(VideoKernel, RegionBeyondTheSensorIsRefused) {
  VIVID_OR_SKIP(nodes);
  CHECK(open(nodes)
            ->configure({.region = {.offset_u_px = 1, .width_px = k_width_px, .height_px = 8}})
            .error()
            .code == Errc::BadValue);
}

}  // namespace
}  // namespace biteline::hal
