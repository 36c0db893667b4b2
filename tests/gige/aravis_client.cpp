// SPDX-License-Identifier: MIT
#include "tests/gige/aravis_client.hpp"

#include <arv.h>

#include <string_view>

#include "host/interfaces/gige/frame.hpp"

namespace biteline::test {
namespace {

/// The Error that a call left behind, if it did.
Result<void> checked(GError* error, const char* what) {
  if (error == nullptr) return {};
  auto failure = fail(Errc::DeviceError, "Aravis, %s: %s", what, error->message);
  g_error_free(error);
  return failure;
}

/// A busy machine may be late.  Aravis asks for a packet again after k_packet_us, gives a frame up after
/// k_retention_us, and also once it asked for more than k_asked times as many packets as the frame has: what
/// it asked for too early counts.
constexpr guint k_packet_us = 100'000, k_retention_us = 10'000'000;
constexpr double k_asked = 2;

}  // namespace

struct AravisClient::State {
  ArvCamera* camera{nullptr};
  ArvStream* stream{nullptr};
  ArvChunkParser* chunks{nullptr};
  bool with_chunks{false};

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    g_clear_object(&chunks);
    g_clear_object(&stream);
    g_clear_object(&camera);
  }
  [[nodiscard]] ArvDevice* device() const { return arv_camera_get_device(camera); }
};

AravisClient::AravisClient(std::unique_ptr<State> state) : state_{std::move(state)} {}
AravisClient::~AravisClient() = default;

Result<std::unique_ptr<AravisClient>> AravisClient::open(const std::string& address) {
  auto state = std::make_unique<State>();
  GError* error = nullptr;
  state->camera = arv_camera_new(address.c_str(), &error);
  BITELINE_TRY(checked(error, "open"));
  return std::unique_ptr<AravisClient>{new AravisClient{std::move(state)}};
}

Result<void> AravisClient::set(const char* feature, std::int64_t value) {
  GError* error = nullptr;
  if (feature == std::string_view{"ChunkModeActive"}) {
    state_->with_chunks = value != 0;
    arv_device_set_boolean_feature_value(state_->device(), feature, value != 0 ? TRUE : FALSE, &error);
  } else {
    arv_device_set_integer_feature_value(state_->device(), feature, value, &error);
  }
  return checked(error, feature);
}

Result<void> AravisClient::choose(const char* feature, const char* value) {
  GError* error = nullptr;
  arv_device_set_string_feature_value(state_->device(), feature, value, &error);
  return checked(error, feature);
}

Result<double> AravisClient::real(const char* feature) {
  GError* error = nullptr;
  const double value = arv_device_get_float_feature_value(state_->device(), feature, &error);
  BITELINE_TRY(checked(error, feature));
  return value;
}

Result<std::string> AravisClient::text(const char* feature) {
  GError* error = nullptr;
  const char* value = arv_device_get_string_feature_value(state_->device(), feature, &error);
  BITELINE_TRY(checked(error, feature));
  return std::string{value != nullptr ? value : ""};
}

Result<int> AravisClient::read_all_features() {
  ArvGc* description = arv_device_get_genicam(state_->device());
  ArvGcNode* root = arv_gc_get_node(description, "Root");
  if (!ARV_IS_GC_CATEGORY(root)) return fail(Errc::BadFormat, "the description has no root");
  int read = 0;
  for (const GSList* one = arv_gc_category_get_features(ARV_GC_CATEGORY(root)); one != nullptr;
       one = one->next) {
    const char* name = static_cast<const char*>(one->data);
    ArvGcNode* node = arv_gc_get_node(description, name);
    if (node == nullptr) return fail(Errc::BadFormat, "the description lists %s, which is not there", name);
    // A chunk's values come with a frame, a command has none.
    if (g_str_has_prefix(name, "Chunk") != FALSE || ARV_IS_GC_COMMAND(node)) continue;
    GError* error = nullptr;
    (void)arv_gc_feature_node_get_value_as_string(ARV_GC_FEATURE_NODE(node), &error);
    BITELINE_TRY(checked(error, name));
    ++read;
  }
  return read;
}

Result<void> AravisClient::start(int buffers) {
  GError* error = nullptr;
  // As root, Aravis would read all that its interface carries until its filter is set: the packets of others.
  arv_gv_device_set_stream_options(ARV_GV_DEVICE(state_->device()),
                                   ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  const guint payload = arv_camera_get_payload(state_->camera, &error);
  BITELINE_TRY(checked(error, "PayloadSize"));
  state_->stream = arv_camera_create_stream(state_->camera, nullptr, nullptr, &error);
  BITELINE_TRY(checked(error, "stream"));
  g_object_set(state_->stream, "frame-retention", k_retention_us, "packet-timeout", k_packet_us,
               "packet-request-ratio", k_asked, nullptr);
  for (int i = 0; i < buffers; ++i) arv_stream_push_buffer(state_->stream, arv_buffer_new_allocate(payload));
  if (state_->with_chunks) state_->chunks = arv_camera_create_chunk_parser(state_->camera);
  arv_camera_start_acquisition(state_->camera, &error);
  return checked(error, "AcquisitionStart");
}

std::optional<ArrivedFrame> AravisClient::next_frame(Nanoseconds timeout) {
  ArvBuffer* buffer =
      arv_stream_timeout_pop_buffer(state_->stream, static_cast<guint64>(timeout.count() / 1000));
  if (buffer == nullptr) return std::nullopt;
  ArrivedFrame frame;
  frame.status = arv_buffer_get_status(buffer);
  frame.complete = frame.status == ARV_BUFFER_STATUS_SUCCESS;
  if (frame.complete) {
    frame.stamp = arv_buffer_get_timestamp(buffer);
    frame.pixel_format = arv_buffer_get_image_pixel_format(buffer);
    frame.width = arv_buffer_get_image_width(buffer);
    frame.height = arv_buffer_get_image_height(buffer);
    std::size_t size = 0;
    const auto* bytes = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size));
    frame.payload.assign(bytes, bytes + size);
  }
  if (frame.complete && state_->with_chunks) {
    std::size_t size = 0;
    const auto* bytes =
        static_cast<const std::uint8_t*>(arv_buffer_get_chunk_data(buffer, gige::k_lines_chunk, &size));
    frame.lines_chunk.assign(bytes, bytes + size);
    GError* error = nullptr;
    frame.sequence = static_cast<std::uint64_t>(
        arv_chunk_parser_get_integer_value(state_->chunks, buffer, "ChunkProfileSequence", &error));
    if (error == nullptr)
      frame.flange = arv_chunk_parser_get_float_value(state_->chunks, buffer, "ChunkFlangePose", &error);
    if (error == nullptr)
      frame.exposure_us =
          arv_chunk_parser_get_float_value(state_->chunks, buffer, "ChunkExposureTime", &error);
    if (error == nullptr)
      frame.camera_frame = static_cast<std::uint64_t>(
          arv_chunk_parser_get_integer_value(state_->chunks, buffer, "ChunkCameraFrame", &error));
    if (error == nullptr)
      frame.encoder_valid =
          arv_chunk_parser_get_integer_value(state_->chunks, buffer, "ChunkEncoderValid", &error) != 0;
    if (error == nullptr)
      frame.encoder_ticks =
          arv_chunk_parser_get_integer_value(state_->chunks, buffer, "ChunkEncoderValue", &error);
    if (const Result<void> read = checked(error, "chunk"); !read) frame.complete = false;
  }
  arv_stream_push_buffer(state_->stream, buffer);
  return frame;
}

Result<void> AravisClient::stop() {
  GError* error = nullptr;
  arv_camera_stop_acquisition(state_->camera, &error);
  return checked(error, "AcquisitionStop");
}

StreamStatistics AravisClient::statistics() const {
  guint64 complete = 0, failed = 0, underruns = 0, resent = 0, missing = 0;
  arv_stream_get_statistics(state_->stream, &complete, &failed, &underruns);
  arv_gv_stream_get_statistics(ARV_GV_STREAM(state_->stream), &resent, &missing);
  return {.complete = complete,
          .failed = failed + underruns,
          .missing_packets = missing,
          .resent_packets = resent};
}

}  // namespace biteline::test
