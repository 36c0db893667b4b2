// SPDX-License-Identifier: MIT
#include "common/image/grey_image.hpp"

#include <spng.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <optional>

#include "common/image/png_bytes.hpp"
#include "common/system/file.hpp"

namespace biteline::image {
namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
struct ContextCloser {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;
using Context = std::unique_ptr<spng_ctx, ContextCloser>;

// Larger than any camera here; a damaged header must not ask for gigabytes.
constexpr std::uint32_t k_max_side_px = 16384;
// Texts and colour profiles are packed: without a limit some kilobytes of them unpack to gigabytes.
constexpr std::size_t k_most_chunk_bytes = 1U << 20U;
constexpr std::size_t k_most_chunks_bytes = 4U << 20U;
// Unpacked pixels of the largest side both ways, and what a picture that does not pack may need beyond.
constexpr std::uint64_t k_most_file_bytes = 300ULL << 20U;

struct OpenPng {
  File file;
  Context context;
  int width_px{0};
  int height_px{0};
};

Result<OpenPng> open_png(const std::filesystem::path& path) {
  BITELINE_TRY(check_regular_file(path, k_most_file_bytes));
  OpenPng png;
  png.file.reset(std::fopen(path.c_str(), "rb"));
  if (!png.file) {
    return fail_errno(errno == ENOENT ? Errc::FileNotFound : Errc::FileUnreadable, errno, "%s", path.c_str());
  }
  png.context.reset(spng_ctx_new(0));
  if (!png.context) return fail(Errc::FileUnreadable, "%s: no memory to read it", path.c_str());
  spng_set_image_limits(png.context.get(), k_max_side_px, k_max_side_px);
  spng_set_chunk_limits(png.context.get(), k_most_chunk_bytes, k_most_chunks_bytes);
  spng_set_png_file(png.context.get(), png.file.get());
  spng_ihdr header{};
  if (const int status = spng_get_ihdr(png.context.get(), &header); status != SPNG_OK) {
    return fail(status == SPNG_IO_EOF ? Errc::Truncated : Errc::BadFormat, "%s: a PNG picture expected (%s)",
                path.c_str(), spng_strerror(status));
  }
  if (header.color_type != SPNG_COLOR_TYPE_GRAYSCALE || header.bit_depth != 8) {
    return fail(Errc::BadFormat, "%s: 8-bit grey expected, found colour type %d with %d bits", path.c_str(),
                int{header.color_type}, int{header.bit_depth});
  }
  png.width_px = static_cast<int>(header.width);
  png.height_px = static_cast<int>(header.height);
  return png;
}

Result<void> decode(OpenPng& png, const std::filesystem::path& path, std::span<std::uint8_t> pixels) {
  if (const int status = spng_decode_image(png.context.get(), pixels.data(), pixels.size(), SPNG_FMT_G8, 0);
      status != SPNG_OK) {
    return fail(status == SPNG_IO_EOF ? Errc::Truncated : Errc::BadFormat, "%s: picture data damaged (%s)",
                path.c_str(), spng_strerror(status));
  }
  return {};
}

}  // namespace

Result<GreyImage> read_png(const std::filesystem::path& path) {
  BITELINE_ASSIGN(OpenPng png, open_png(path));
  GreyImage image{.width_px = png.width_px, .height_px = png.height_px, .pixels = {}};
  image.pixels.resize(static_cast<std::size_t>(png.width_px) * static_cast<std::size_t>(png.height_px));
  BITELINE_TRY(decode(png, path, image.pixels));
  return image;
}

Result<void> read_png_into(const std::filesystem::path& path, int width_px, int height_px,
                           std::span<std::uint8_t> pixels) {
  BITELINE_ASSIGN(OpenPng png, open_png(path));
  if (png.width_px != width_px || png.height_px != height_px) {
    return fail(Errc::SizeMismatch, "%s: %d x %d px expected, found %d x %d", path.c_str(), width_px,
                height_px, png.width_px, png.height_px);
  }
  return decode(png, path, pixels);
}

Result<void> write_png(const std::filesystem::path& path, const GreyImage& image) {
  std::vector<std::uint8_t> bytes;
  BITELINE_TRY(pack_png(image, bytes));
  const File file{std::fopen(path.c_str(), "wb")};
  if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size() ||
      std::fflush(file.get()) != 0) {
    return fail_errno(errno == ENOSPC ? Errc::DiskFull : Errc::WriteFailed, errno, "%s", path.c_str());
  }
  return {};
}

}  // namespace biteline::image
