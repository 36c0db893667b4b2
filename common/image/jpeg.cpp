// SPDX-License-Identifier: MIT
#include "common/image/jpeg.hpp"

#include <turbojpeg.h>

#include <memory>

#include "common/core/contracts.hpp"

namespace biteline::image {
namespace {

constexpr std::int64_t k_max_pixels = 64'000'000;

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, Destroy>;

}  // namespace

Result<std::vector<std::uint8_t>> encode_jpeg(const GreyImage& image, int quality) {
  BITELINE_EXPECTS(quality >= 1 && quality <= 100);
  const Handle handle{tjInitCompress()};
  if (!handle) return fail(Errc::DeviceError, "JPEG: %s", tjGetErrorStr2(nullptr));
  unsigned long bytes = tjBufSize(image.width_px, image.height_px, TJSAMP_GRAY);
  std::vector<std::uint8_t> file(bytes);
  unsigned char* out = file.data();
  if (tjCompress2(handle.get(), image.pixels.data(), image.width_px, image.width_px, image.height_px,
                  TJPF_GRAY, &out, &bytes, TJSAMP_GRAY, quality, TJFLAG_NOREALLOC | TJFLAG_FASTDCT) != 0) {
    return fail(Errc::BadValue, "JPEG of %d x %d: %s", image.width_px, image.height_px,
                tjGetErrorStr2(handle.get()));
  }
  file.resize(bytes);
  return file;
}

Result<GreyImage> decode_jpeg(std::span<const std::uint8_t> file) {
  const Handle handle{tjInitDecompress()};
  if (!handle) return fail(Errc::DeviceError, "JPEG: %s", tjGetErrorStr2(nullptr));
  GreyImage image;
  int sampling = 0, colours = 0;
  if (tjDecompressHeader3(handle.get(), file.data(), file.size(), &image.width_px, &image.height_px,
                          &sampling, &colours) != 0) {
    return fail(Errc::BadFormat, "JPEG: %s", tjGetErrorStr2(handle.get()));
  }
  if (std::int64_t{image.width_px} * image.height_px > k_max_pixels)
    return fail(Errc::BadFormat, "JPEG of %d x %d pixels", image.width_px, image.height_px);
  image.pixels.resize(static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px));
  if (tjDecompress2(handle.get(), file.data(), file.size(), image.pixels.data(), image.width_px,
                    image.width_px, image.height_px, TJPF_GRAY, TJFLAG_STOPONWARNING) != 0) {
    return fail(Errc::BadFormat, "JPEG: %s", tjGetErrorStr2(handle.get()));
  }
  return image;
}

}  // namespace biteline::image
