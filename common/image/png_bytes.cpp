// SPDX-License-Identifier: MIT
#include "common/image/png_bytes.hpp"

#include <spng.h>
#include <zlib.h>

#include <memory>

namespace biteline::image {
namespace {

struct ContextCloser {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};

int append(spng_ctx*, void* user, void* source, std::size_t length) {
  auto& bytes = *static_cast<std::vector<std::uint8_t>*>(user);
  const auto* const from = static_cast<const std::uint8_t*>(source);
  bytes.insert(bytes.end(), from, from + length);
  return SPNG_OK;
}

Result<void> encode(const GreyImage& image, std::vector<std::uint8_t>& out, int level) {
  const std::unique_ptr<spng_ctx, ContextCloser> context{spng_ctx_new(SPNG_CTX_ENCODER)};
  out.clear();
  spng_set_png_stream(context.get(), append, &out);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.width_px);
  header.height = static_cast<std::uint32_t>(image.height_px);
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  spng_set_ihdr(context.get(), &header);
  spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, level);
  // Zlib's search for repeats takes seconds on a picture of noise and nothing, and finds hardly any.
  spng_set_option(context.get(), SPNG_IMG_COMPRESSION_STRATEGY, Z_RLE);
  spng_set_option(context.get(), SPNG_FILTER_CHOICE, SPNG_DISABLE_FILTERING);
  const int status = spng_encode_image(context.get(), image.pixels.data(), image.pixels.size(), SPNG_FMT_PNG,
                                       SPNG_ENCODE_FINALIZE);
  if (status == SPNG_OK) return {};
  return fail(Errc::WriteFailed, "a picture of %d x %d px: %s", image.width_px, image.height_px,
              spng_strerror(status));
}

}  // namespace

Result<void> pack_png(const GreyImage& image, std::vector<std::uint8_t>& out) {
  return encode(image, out, Z_DEFAULT_COMPRESSION);
}

Result<void> store_png(const GreyImage& image, std::vector<std::uint8_t>& out) {
  return encode(image, out, Z_NO_COMPRESSION);
}

}  // namespace biteline::image
