// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "firmware/pipeline/picture_tap.hpp"
#include "firmware/pipeline/profile_pipeline.hpp"

// Every allocation of this program is counted: glibc's own entry points are replaced, so malloc of C code
// counts too.
namespace {
std::atomic<long> g_allocations{0};
}
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) {
  return g_allocations.fetch_add(1, std::memory_order_relaxed), __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  return g_allocations.fetch_add(1, std::memory_order_relaxed), __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  return g_allocations.fetch_add(1, std::memory_order_relaxed), __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return g_allocations.fetch_add(1, std::memory_order_relaxed), __libc_memalign(alignment, size);
}
}

namespace biteline::pipeline {

TEST_GROUP(MallocGuard) {
  // A small region: what matters is the number of frames.
  static constexpr int k_width_px = 256, k_height_px = 96;

  static geometry::SensorModel sensor() {
    geometry::SensorModel model;
    model.camera = {.fu_px = 2700,
                    .fv_px = 2700,
                    .cu_px = 128,
                    .cv_px = 48,
                    .k1 = -0.1,
                    .k2 = 0,
                    .p1 = 0,
                    .p2 = 0,
                    .k3 = 0};
    model.laser_plane = {.normal_cam = Vec3{0, 0.7071, -0.7071}.normalized(), .distance_mm = -200};
    model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = k_width_px, .height_px = k_height_px};
    return model;
  }

  static void draw(std::vector<std::uint8_t> & pixels, int frame) {
    for (int u = 0; u < k_width_px; ++u) {
      const double row_px = 40 + 20 * std::sin(0.02 * u + 0.1 * frame);
      for (int v = 0; v < k_height_px; ++v) {
        const double x = (v - row_px) / 2.2;
        pixels[static_cast<std::size_t>(v * k_width_px + u)] =
            std::fabs(x) < 5 ? static_cast<std::uint8_t>(180 * std::exp(-0.5 * x * x)) : std::uint8_t{0};
      }
    }
  }
};

TEST(MallocGuard, TenThousandFramesAllocateNothing) {
  auto pipeline = ProfilePipeline::create({}, sensor());
  CHECK(pipeline.has_value());
  const auto poses = std::make_unique<PoseHistory>();
  const auto buffer = std::make_unique<profile::ProfileBuffer>();
  std::vector<std::vector<std::uint8_t>> pictures(16, std::vector<std::uint8_t>(k_width_px * k_height_px));
  for (int i = 0; i < 16; ++i) draw(pictures[static_cast<std::size_t>(i)], i);

  PictureTap tap{sensor().region};
  std::size_t points = 0;
  SensorClock::time_point now{};
  const long before = g_allocations.load();
  for (std::uint64_t frame = 0; frame < 10000; ++frame) {
    const std::vector<std::uint8_t>& picture = pictures[frame % 16];
    for (int k = 0; k < 5; ++k) {
      now += std::chrono::milliseconds{2};
      geometry::PoseSample sample{.stamp = now, .encoder_ticks = now.time_since_epoch().count() / 1000};
      sample.T_base_flange.translation().x() = 1e-6 * static_cast<double>(now.time_since_epoch().count());
      poses->rt_push(sample);
    }
    const hal::FrameView view{.pixels = picture,
                              .width_px = k_width_px,
                              .height_px = k_height_px,
                              .stride_bytes = k_width_px,
                              .sequence = frame,
                              .exposure_mid = now - std::chrono::milliseconds{25},
                              .flags = 0};
    pipeline->rt_process(view, *buffer);
    tap.rt_want();
    tap.rt_keep_peaks(*buffer);
    tap.rt_keep_frame(view);
    pipeline->rt_stamp(*buffer, *poses);
    points += buffer->count;
  }
  LONGS_EQUAL(0, g_allocations.load() - before);
  CHECK(points > 10000 * 200);  // the frames were not empty
}

TEST(MallocGuard, CountsAnAllocation) {
  const long before = g_allocations.load();
  const auto volatile_size = std::make_unique<volatile std::size_t>(100);
  const std::vector<char> seeded(*volatile_size);
  CHECK(g_allocations.load() - before >= 2);
  CHECK(seeded.size() == 100);
}

}  // namespace biteline::pipeline
