// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/device_registers.hpp"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <limits>

#include "common/gige/bootstrap.hpp"
#include "host/interfaces/gige/device_description.hpp"

namespace biteline::gige {
namespace {

struct Writable {
  std::uint32_t address, minimum, maximum;
  bool shapes_frames{false};  ///< stands while frames come
};

constexpr std::uint32_t k_any = 0xffff'ffff;
constexpr std::array k_writable{
    Writable{bootstrap::k_heartbeat_timeout, 500, 60'000},  // ms; a dead client keeps the light for so long
    Writable{bootstrap::k_privilege, 0, 3},
    Writable{bootstrap::k_stream_port, 0, 65'535, true},
    Writable{bootstrap::k_stream_packet_size, 0, k_any},  // looked at below
    Writable{bootstrap::k_stream_address, 0, k_any, true},
    Writable{own::k_height, 1, k_most_height, true},  // looked at below
    Writable{own::k_pixel_format, 0, k_any, true},    // looked at below
    Writable{own::k_acquisition_mode, 0, 0},
    Writable{own::k_acquisition, 0, 1},
    Writable{own::k_locked, 0, 1},
    Writable{own::k_chunk_mode, 0, 1, true},
    Writable{own::k_coordinate_selector, 0, 2},
};

/// Of the packet size: its low half; flags stand above it.
constexpr std::uint32_t k_packet_size_mask = 0xffff, k_packet_least = 576, k_packet_most = 65'000;

bool in_range(const Writable& row, std::uint32_t value) {
  if (row.address == bootstrap::k_stream_packet_size) {
    const std::uint32_t bytes = value & k_packet_size_mask;
    return bytes >= k_packet_least && bytes <= k_packet_most;
  }
  if (row.address == own::k_pixel_format) {
    const auto format = static_cast<Format>(value);
    return format == Format::Mono8 || format == Format::C16 || format == Format::Ac16 ||
           format == Format::Abc32f;
  }
  return value >= row.minimum && value <= row.maximum;
}

/// Registers that the standard gives a place but that hold nothing here.
constexpr std::array k_zeros{bootstrap::k_gateway,
                             bootstrap::k_message_channels,
                             bootstrap::k_privilege,
                             bootstrap::k_stream_port,
                             bootstrap::k_stream_delay,
                             bootstrap::k_stream_address,
                             bootstrap::k_stream_source_port,
                             bootstrap::k_tick_frequency_high,
                             own::k_acquisition_mode,
                             own::k_acquisition,
                             own::k_locked,
                             own::k_chunk_mode,
                             own::k_unit,
                             own::k_system,
                             own::k_reference};

}  // namespace

PayloadSize payload_size(const Choices& choices, std::size_t columns) {
  const std::size_t picture = choices.lines * line_bytes(choices.format, columns);
  if (!choices.chunks) return {.picture = picture, .whole = picture};
  const std::size_t filled = (picture + 3) / 4 * 4;
  return {.picture = filled,
          .whole = filled + choices.records() * k_line_record_bytes + 2 * k_chunk_tag_bytes};
}

DeviceRegisters::DeviceRegisters(const Identity& identity) : description_{device_description()} {
  using namespace bootstrap;
  // Address by address: DISCOVERY tells them all.
  for (std::uint32_t address = 0; address < k_discovery_bytes; address += 4) words_[address] = 0;
  for (const std::uint32_t address : k_zeros) words_[address] = 0;
  words_[k_version] = 0x0002'0000;
  words_[k_device_mode] = 0x8000'0001;  // big-endian, a transmitter, UTF-8
  words_[k_mac_high] = static_cast<std::uint32_t>(identity.mac[0] << 8U | identity.mac[1]);
  words_[k_mac_low] = word_at(identity.mac, 2);
  words_[k_ip_offered] = words_[k_ip_used] = 0x5;  // link-local and persistent: the machine's own business
  words_[k_address] = identity.address;
  words_[k_mask] = identity.mask;
  set_text(k_vendor, 32, k_own_vendor);
  set_text(k_model, 32, k_own_model);
  set_text(k_device_version, 32, identity.version);
  set_text(k_manufacturer_info, 48, "3-D laser profiles, camera's frame");
  set_text(k_serial, 16, identity.serial);
  set_text(k_user_name, 16, identity.name);
  while (description_.size() % 4 != 0) description_ += '\n';
  std::array<char, 64> url{};
  std::snprintf(url.data(), url.size(), "Local:biteline.xml;%x;%zx", own::k_description, description_.size());
  set_text(k_first_url, 512, url.data());
  set_text(k_second_url, 512, "");
  words_[k_interfaces] = words_[k_stream_channels] = 1;
  words_[k_capability] = k_can_concatenate | k_can_write_memory | k_can_resend | k_has_serial;
  words_[k_heartbeat_timeout] = 3000;
  words_[k_tick_frequency_low] = 1'000'000'000;
  words_[k_stream_packet_size] = 1400;
  words_[own::k_height] = 1;
  words_[own::k_pixel_format] = static_cast<std::uint32_t>(Format::Abc32f);
  words_[own::k_scan_type] = 3;
  words_[own::k_coordinate_selector] = 2;
  words_[own::k_invalid_flag] = 1;
  set_head(0, {}, {});
}

Status DeviceRegisters::read(std::uint32_t address, std::span<std::uint8_t> out) const {
  if (address % 4 != 0 || out.size() % 4 != 0) return Status::BadAlignment;
  for (std::size_t at = 0; at < out.size(); at += 4) {
    const std::uint64_t place = std::uint64_t{address} + at;
    if (place >= own::k_description && place - own::k_description < description_.size()) {
      const std::size_t from = place - own::k_description;
      std::copy_n(description_.begin() + static_cast<std::ptrdiff_t>(from), 4,
                  out.begin() + static_cast<std::ptrdiff_t>(at));
      continue;
    }
    const auto found = place > k_any ? words_.end() : words_.find(static_cast<std::uint32_t>(place));
    if (found == words_.end()) return Status::InvalidAddress;
    put_word(out, at, found->second);
  }
  return Status::Success;
}

Status DeviceRegisters::write(std::uint32_t address, std::uint32_t value, bool acquiring) {
  if (address % 4 != 0) return Status::BadAlignment;
  const auto row = std::ranges::find(k_writable, address, &Writable::address);
  if (row == k_writable.end())
    return words_.contains(address) || address >= own::k_description ? Status::WriteProtected
                                                                     : Status::InvalidAddress;
  if (!in_range(*row, value)) return Status::InvalidParameter;
  if (acquiring && row->shapes_frames && words_[address] != value &&
      !(address == bootstrap::k_stream_port && value == 0))
    return Status::WriteProtected;
  // A picture has the rows that it has.
  if (address == own::k_height) {
    const bool fits = choices().picture() ? value == word(own::k_height) : value <= k_most_lines;
    if (!fits) return Status::InvalidParameter;
    if (!choices().picture()) lines_ = value;
  }
  words_[address] = address == bootstrap::k_stream_packet_size ? value & k_packet_size_mask : value;
  follow_choices();
  return Status::Success;
}

std::uint32_t DeviceRegisters::word(std::uint32_t address) const {
  const auto found = words_.find(address);
  return found == words_.end() ? 0 : found->second;
}

Choices DeviceRegisters::choices() const {
  return {.format = static_cast<Format>(word(own::k_pixel_format)),
          .lines = word(own::k_height),
          .chunks = word(own::k_chunk_mode) != 0};
}

std::size_t DeviceRegisters::columns() const {
  return choices().picture() ? pictures_.columns() : columns_;
}

void DeviceRegisters::set_head(std::size_t columns, const Depth& depth, const PictureShape& pictures) {
  columns_ = columns;
  depth_ = depth;
  pictures_ = pictures;
  words_[own::k_sensor_width] = static_cast<std::uint32_t>(columns);
  follow_choices();
}

void DeviceRegisters::follow_choices() {
  const bool picture = choices().picture();
  words_[own::k_height] = picture ? pictures_.rows() : lines_;
  words_[own::k_width] = static_cast<std::uint32_t>(columns());
  words_[own::k_binning] = static_cast<std::uint32_t>(picture ? pictures_.step : 1);
  const Choices chosen = choices();
  const bool depths = chosen.format == Format::C16 || chosen.format == Format::Ac16,
             across = chosen.format == Format::Ac16;
  words_[own::k_payload_size] = static_cast<std::uint32_t>(payload_size(chosen, columns()).whole);
  words_[own::k_output_mode] = across   ? k_calibrated_profile
                               : depths ? k_calibrated_depth
                                        : k_calibrated_grid;
  set_float(own::k_invalid_value, depths ? float{k_no_depth} : std::numeric_limits<float>::quiet_NaN());
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const bool scaled = axis == 2 ? depths : axis == 0 && across;
    const Scale scale = axis == 0 ? depth_.across : depth_.away();
    set_float(own::k_scale + 4 * axis, scaled ? scale.scale_mm : 1);
    set_float(own::k_offset + 4 * axis, scaled ? scale.offset_mm : 0);
  }
}

void DeviceRegisters::set_text(std::uint32_t address, std::size_t bytes, std::string_view text) {
  // A zero ends it.
  std::vector<std::uint8_t> padded(bytes);
  std::copy_n(text.begin(), std::min(text.size(), bytes - 1), padded.begin());
  for (std::size_t at = 0; at < bytes; at += 4)
    words_[address + static_cast<std::uint32_t>(at)] = word_at(padded, at);
}

void DeviceRegisters::set_float(std::uint32_t address, float value) {
  words_[address] = std::bit_cast<std::uint32_t>(value);
}

}  // namespace biteline::gige
