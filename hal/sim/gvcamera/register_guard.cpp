// SPDX-License-Identifier: MIT
#include "hal/sim/gvcamera/register_guard.hpp"

#include <arpa/inet.h>
#include <arv.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <utility>

#include "common/gige/bootstrap.hpp"
#include "hal/sim/gvcamera/genicam_description.hpp"

namespace biteline::sim {
namespace {

constexpr std::uint32_t k_registers_bytes = ARV_FAKE_CAMERA_MEMORY_SIZE;
constexpr std::uint32_t k_any = 0xffff'ffff;
constexpr std::uint32_t k_heartbeat_timeout = 0x938, k_privilege = 0xa00;

struct Writable {
  std::uint32_t first, last;  ///< addresses, both included
  std::uint32_t minimum, maximum;
};

/// The bootstrap registers that the standard makes writable, and the features that the description calls RW
/// or WO, with its ranges.  Sizes and offsets have bounds of their own below.
constexpr std::array k_writable{
    Writable{0x014, 0x014, 0, k_any},                                    // network configuration
    Writable{0x64c, 0x67c, 0, k_any},                                    // persistent address
    Writable{k_heartbeat_timeout, k_heartbeat_timeout, 100, 3'600'000},  // ms
    Writable{0x944, 0x944, 0, 3},                                        // timestamp control
    Writable{k_privilege, k_privilege, 0, 3},                            // of the control channel
    Writable{0xb00, 0xb18, 0, k_any},                                    // message channel
    Writable{0xd00, 0xd00, 0, 65'535},                                   // stream channel: port
    Writable{0xd08, 0xd24, 0, k_any},                                    // delay, destination, source port
    Writable{0x120, 0x120, 10, 1'000'000},                               // ExposureTime, us
    Writable{0x470, 0x470, 10, 1'000'000},                               // of the sequencer's other set
    Writable{0x124, 0x124, 0, 1},                                        // AcquisitionStart, AcquisitionStop
    Writable{0x128, 0x128, 0x0108'0001, 0x0108'0001},                    // PixelFormat: Mono8
    Writable{0x12c, 0x12c, 1, 2},                                        // AcquisitionMode
    Writable{0x138, 0x138, 1000, 10'000'000},                            // period of AcquisitionFrameRate, us
    Writable{0x300, 0x300, 0, 1},                                        // TriggerMode
    Writable{0x304, 0x304, 1, 1},                                        // TriggerSource
    Writable{0x308, 0x308, 0, 0},                                        // TriggerActivation
    Writable{0x30c, 0x30c, 0, 0},     // the server's own word: a trigger was taken up
    Writable{0x400, 0x404, 0, 1},     // AcquisitionFrameRateEnable, LineSelector
    Writable{0x410, 0x414, 0, 1},     // LineSource
    Writable{0x760, 0x764, 0, 1},     // of the sequencer's other set
    Writable{0x420, 0x420, 0, 1},     // PtpEnable
    Writable{0x430, 0x43c, 0, 1},     // SequencerMode to SequencerSetSave
    Writable{0x440, 0x444, 0, 0},     // SequencerPathSelector, SequencerTriggerSource
    Writable{0x448, 0x448, 0, 1},     // SequencerSetStart
    Writable{0x450, 0x454, 0, 1},     // SequencerSetNext
    Writable{0x458, 0x458, 0, 2400},  // Gain, hundredths of a decibel
    Writable{0x45c, 0x460, 0, 1},     // ReverseX, ReverseY
    Writable{0x464, 0x468, 1, 4},     // BinningHorizontal, BinningVertical
    Writable{0x474, 0x478, 1, 4},     // DecimationHorizontal, DecimationVertical
    Writable{0x47c, 0x47c, 0, 64},    // BlackLevel
};
/// Stream packet size: low half; flags such as "fire a test packet" above it are not kept.
constexpr std::uint32_t k_packet_size = 0xd04, k_packet_size_mask = 0xffff;
/// Headers of a packet (IP, UDP, GVSP) and a word; what fits the server's own buffer.
constexpr std::uint32_t k_packet_least = 64, k_packet_most = 60'000;

gige::Status within(std::uint32_t value, std::uint32_t minimum, std::uint32_t maximum) {
  return value >= minimum && value <= maximum ? gige::Status::Success : gige::Status::InvalidParameter;
}

/// Room for a size beside its offset, and the other way round.
std::uint32_t left_of(std::uint32_t whole, std::uint32_t used) {
  return whole > used ? whole - used : 0;
}

thread_local int own_access = 0;
/// Of the camera whose server this thread is.
thread_local gige::ControlChannel control;
/// Of the last look of this thread: goes into the answer that it sends next.
thread_local gige::Status answer = gige::Status::Success;

template <class Function>
Function* real(const char* name) {
  void* found = dlsym(RTLD_NEXT, name);
  if (found == nullptr) {
    std::fprintf(stderr, "simulated camera: the Aravis library lacks %s\n", name);
    std::abort();
  }
  return reinterpret_cast<Function*>(found);
}

bool read(ArvFakeCamera* camera, GvRange range, void* out) {
  static auto* const next = real<decltype(arv_fake_camera_read_memory)>("arv_fake_camera_read_memory");
  return next(camera, range.address, range.bytes, out) != FALSE;
}

std::uint32_t read_word(ArvFakeCamera* camera, std::uint32_t address) {
  std::uint32_t word = 0;
  return read(camera, {address, sizeof word}, &word) ? ntohl(word) : 0;
}

/// Told by its own URL, "Local:NAME;ADDRESS;SIZE" in hexadecimal.
std::uint32_t description_bytes(ArvFakeCamera* camera) {
  constexpr std::uint32_t k_url = 0x200;
  std::array<char, 256> url{};
  if (!read(camera, {k_url, static_cast<std::uint32_t>(url.size() - 1)}, url.data())) return 0;
  unsigned address = 0, bytes = 0;
  const char* numbers = std::strchr(url.data(), ';');
  if (numbers == nullptr || std::sscanf(numbers, ";%x;%x", &address, &bytes) != 2) return 0;
  return bytes;
}

GvGeometry geometry_of(ArvFakeCamera* camera) {
  using namespace gv_register;
  const auto divided = [&](std::uint32_t size, std::uint32_t binning, std::uint32_t decimation) {
    return read_word(camera, size) / std::max(1U, read_word(camera, binning) * read_word(camera, decimation));
  };
  return {.sensor_width = divided(k_sensor_width, k_binning_x, k_decimation_x),
          .sensor_height = divided(k_sensor_height, k_binning_y, k_decimation_y),
          .width = read_word(camera, k_width),
          .height = read_word(camera, k_height),
          .offset_x = read_word(camera, k_offset_x),
          .offset_y = read_word(camera, k_offset_y),
          .state_locked = read_word(camera, k_state_locked) != 0};
}

}  // namespace

gige::Status may_read(const GvRange& range, std::uint32_t description_bytes) {
  if (range.bytes == 0) return gige::Status::InvalidParameter;
  if (range.address % 4 != 0) return gige::Status::BadAlignment;
  const std::uint64_t end = std::uint64_t{range.address} + range.bytes;
  if (end <= k_registers_bytes) return gige::Status::Success;
  // Whole words are read, also of a description that ends within one.
  const std::uint64_t end_of_description = k_registers_bytes + (std::uint64_t{description_bytes} + 3) / 4 * 4;
  return range.address >= k_registers_bytes && end <= end_of_description ? gige::Status::Success
                                                                         : gige::Status::InvalidAddress;
}

gige::Status may_write(std::uint32_t address, std::uint32_t value, const GvGeometry& now) {
  if (address % 4 != 0) return gige::Status::BadAlignment;
  if (address >= k_registers_bytes) return gige::Status::InvalidAddress;
  using namespace gv_register;
  switch (address) {
    case k_width:
      return within(value, 16, left_of(now.sensor_width, now.offset_x));
    case k_height:
      return within(value, 4, left_of(now.sensor_height, now.offset_y));
    case k_offset_x:
      return within(value, 0, left_of(now.sensor_width, now.width));
    case k_offset_y:
      return within(value, 0, left_of(now.sensor_height, now.height));
    case k_packet_size:
      return within(value & k_packet_size_mask, k_packet_least, k_packet_most);
    default:
      break;
  }
  const bool of_state = address == k_reverse_x || address == k_reverse_y || address == k_binning_x ||
                        address == k_binning_y || address == k_decimation_x || address == k_decimation_y ||
                        address == k_black_level;
  if (of_state && now.state_locked) return gige::Status::WriteProtected;
  const auto* row = std::ranges::find_if(
      k_writable, [&](const Writable& each) { return address >= each.first && address <= each.last; });
  return row == k_writable.end() ? gige::Status::WriteProtected : within(value, row->minimum, row->maximum);
}

OwnAccess::OwnAccess() {
  ++own_access;
}
OwnAccess::~OwnAccess() {
  --own_access;
}

namespace {

/// A block is written whole or not at all.
gige::Status may_write_block(ArvFakeCamera* camera, GvRange range, const void* bytes) {
  if (range.bytes == 0 || range.bytes % 4 != 0) return gige::Status::InvalidParameter;
  const GvGeometry now = geometry_of(camera);
  for (std::uint32_t at = 0; at < range.bytes; at += 4) {
    if (range.address > k_any - at) return gige::Status::InvalidAddress;
    std::uint32_t word = 0;
    std::memcpy(&word, static_cast<const std::uint8_t*>(bytes) + at, sizeof word);
    const gige::Status status = may_write(range.address + at, ntohl(word), now);
    if (status != gige::Status::Success) return status;
  }
  return gige::Status::Success;
}

/// What a write of one register does besides.
void follow_write(ArvFakeCamera* camera, std::uint32_t address, std::uint32_t value) {
  static auto* const write = real<decltype(arv_fake_camera_write_memory)>("arv_fake_camera_write_memory");
  const auto set = [&](std::uint32_t other, std::uint32_t number) {
    const std::uint32_t word = htonl(number);
    write(camera, other, sizeof word, &word);
  };
  switch (address) {
    case k_heartbeat_timeout:
      control.set_heartbeat_timeout(std::chrono::milliseconds{value});
      break;
    case k_privilege:
      control.set_privilege(value);
      if (value != 0) break;
      // Given back, or the heartbeat was missed: the stream ends with the control.
      set(gv_register::k_acquisition, 0);
      set(gv_register::k_stream_port, 0);
      break;
    case gv_register::k_sequencer_start:
      // A client that writes the set to start with starts the sequence anew, also with the set it had.
      set(gv_register::k_sequencer_begun_anew, 1);
      break;
    default:
      break;
  }
}

/// Nothing: no packet of the control protocol's port.
std::optional<gige::Peer> peer_of(GSocket* socket, GSocketAddress* from) {
  GSocketAddress* own = g_socket_get_local_address(socket, nullptr);
  const bool is_server = own != nullptr && G_IS_INET_SOCKET_ADDRESS(own) &&
                         g_inet_socket_address_get_port(G_INET_SOCKET_ADDRESS(own)) == gige::k_port;
  if (own != nullptr) g_object_unref(own);
  sockaddr_in address{};
  if (!is_server || from == nullptr ||
      g_socket_address_to_native(from, &address, sizeof address, nullptr) == FALSE)
    return std::nullopt;
  return gige::Peer{.address = address.sin_addr.s_addr, .port = address.sin_port};
}

}  // namespace
}  // namespace biteline::sim

namespace gige = biteline::gige;

// All that Aravis' server and fake camera do with registers ends in these two.
gboolean arv_fake_camera_read_memory(ArvFakeCamera* camera, guint32 address, guint32 size, void* buffer) {
  using namespace biteline::sim;
  const std::uint32_t description = address < k_registers_bytes ? 0 : description_bytes(camera);
  answer = may_read({address, size}, description);
  // What is not there reads as zeros: the last word of the description may end beyond it.
  std::memset(buffer, 0, size);
  return answer == gige::Status::Success && read(camera, {address, size}, buffer) ? TRUE : FALSE;
}

gboolean arv_fake_camera_write_memory(ArvFakeCamera* camera, guint32 address, guint32 size,
                                      const void* buffer) {
  using namespace biteline::sim;
  static auto* const next = real<decltype(arv_fake_camera_write_memory)>("arv_fake_camera_write_memory");
  answer = gige::Status::Success;
  if (own_access > 0) return next(camera, address, size, buffer);
  answer = may_write_block(camera, {address, size}, buffer);
  if (answer != gige::Status::Success) return FALSE;
  std::uint32_t word = 0;
  if (address == k_packet_size && size == sizeof word) {
    std::memcpy(&word, buffer, sizeof word);
    word = htonl(ntohl(word) & k_packet_size_mask);
    return next(camera, address, size, &word);
  }
  if (next(camera, address, size, buffer) == FALSE) return FALSE;
  for (guint32 at = 0; at + sizeof word <= size; at += sizeof word) {
    std::memcpy(&word, static_cast<const std::uint8_t*>(buffer) + at, sizeof word);
    follow_write(camera, address + at, ntohl(word));
  }
  return TRUE;
}

// Commands that the application may not give are answered here, and the server does not hear them.
gssize g_socket_receive_message(GSocket* socket, GSocketAddress** address, GInputVector* vectors,
                                gint num_vectors, GSocketControlMessage*** messages, gint* num_messages,
                                gint* flags, GCancellable* cancellable, GError** error) {
  using namespace biteline::sim;
  static auto* const next = real<decltype(g_socket_receive_message)>("g_socket_receive_message");
  const gssize got =
      next(socket, address, vectors, num_vectors, messages, num_messages, flags, cancellable, error);
  if (got <= 0 || address == nullptr || num_vectors != 1) return got;
  const std::optional<gige::Peer> peer = peer_of(socket, *address);
  if (!peer) return got;
  const auto* bytes = static_cast<const std::uint8_t*>(vectors[0].buffer);
  const auto reply =
      control.answer_for(*peer, {bytes, static_cast<std::size_t>(got)}, gige::ControlChannel::Clock::now());
  if (!reply) return got;
  (void)g_socket_send_to(socket, *address, reinterpret_cast<const gchar*>(reply->data()), reply->size(),
                         cancellable, nullptr);
  return 0;
}

// The server answers "success" whatever its registers say: the answer to a refused command tells the refusal.
gssize g_socket_send_to(GSocket* socket, GSocketAddress* address, const gchar* buffer, gsize size,
                        GCancellable* cancellable, GError** error) {
  static auto* const next = biteline::sim::real<decltype(g_socket_send_to)>("g_socket_send_to");
  const gige::Status status = std::exchange(biteline::sim::answer, gige::Status::Success);
  constexpr std::size_t k_header_bytes = 8;  // status, answer's kind, length of what follows, number
  if (status == gige::Status::Success || size < k_header_bytes)
    return next(socket, address, buffer, size, cancellable, error);
  std::array<char, k_header_bytes> refusal{};
  std::memcpy(refusal.data(), buffer, refusal.size());
  refusal[0] = static_cast<char>(static_cast<std::uint16_t>(status) >> 8U);
  refusal[1] = static_cast<char>(static_cast<std::uint16_t>(status) & 0xffU);
  refusal[4] = refusal[5] = 0;
  const gssize sent = next(socket, address, refusal.data(), refusal.size(), cancellable, error);
  return sent == static_cast<gssize>(refusal.size()) ? static_cast<gssize>(size) : sent;
}
