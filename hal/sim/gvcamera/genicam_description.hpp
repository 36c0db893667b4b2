// SPDX-License-Identifier: MIT
#pragma once
/// \file What the simulated camera says it can do: its GenICam description, SFNC names over Aravis' fake
/// camera's registers.

#include <cstdint>
#include <string>
#include <string_view>

namespace biteline::sim {

/// Registers.  Those below 0x400 are what Aravis' fake camera itself acts on; those from 0x400 on are plain
/// memory that the owner of the camera reads and writes.
namespace gv_register {
inline constexpr std::uint32_t k_width = 0x100;
inline constexpr std::uint32_t k_height = 0x104;
inline constexpr std::uint32_t k_sensor_height = 0x118;
inline constexpr std::uint32_t k_sensor_width = 0x11c;
inline constexpr std::uint32_t k_exposure_us = 0x120;
inline constexpr std::uint32_t k_offset_x = 0x130;
inline constexpr std::uint32_t k_offset_y = 0x134;
inline constexpr std::uint32_t k_frame_period_us = 0x138;
inline constexpr std::uint32_t k_trigger_mode = 0x300;
inline constexpr std::uint32_t k_trigger_source = 0x304;
inline constexpr std::uint32_t k_trigger_fire = 0x30c;
inline constexpr std::uint32_t k_acquisition = 0x124;
inline constexpr std::uint32_t k_acquisition_mode = 0x12c;
inline constexpr std::uint32_t k_vendor_name = 0x48;   ///< GigE Vision bootstrap: 32 bytes
inline constexpr std::uint32_t k_model_name = 0x68;    ///< 32 bytes
inline constexpr std::uint32_t k_stream_port = 0xd00;  ///< GigE Vision bootstrap: where frames go
inline constexpr std::uint32_t k_frame_rate_enable = 0x400;
inline constexpr std::uint32_t k_line_selector = 0x404;
inline constexpr std::uint32_t k_line_source = 0x410;  ///< and + 4 for Line1
inline constexpr std::uint32_t k_ptp_enable = 0x420;
inline constexpr std::uint32_t k_ptp_status = 0x424;
inline constexpr std::uint32_t k_temperature_millidegc_register = 0x428;
inline constexpr std::uint32_t k_gvcp_capability = 0x934;  ///< a bootstrap register of the standard's own
inline constexpr std::uint32_t k_sequencer_mode = 0x430;
inline constexpr std::uint32_t k_sequencer_configuration = 0x434;
inline constexpr std::uint32_t k_sequencer_selector = 0x438;
inline constexpr std::uint32_t k_sequencer_save = 0x43c;
inline constexpr std::uint32_t k_sequencer_path = 0x440;
inline constexpr std::uint32_t k_sequencer_trigger = 0x444;
inline constexpr std::uint32_t k_sequencer_start = 0x448;
inline constexpr std::uint32_t k_sequencer_begun_anew = 0x44c;  ///< a client has written the one before
inline constexpr std::uint32_t k_sequencer_next = 0x450;        ///< and + 4 for set 1
inline constexpr std::uint32_t k_gain_centidb = 0x458;
inline constexpr std::uint32_t k_reverse_x = 0x45c;
inline constexpr std::uint32_t k_reverse_y = 0x460;
inline constexpr std::uint32_t k_binning_x =
    0x464;  ///< BinningHorizontal; a pixel is the mean of the binned ones
inline constexpr std::uint32_t k_binning_y = 0x468;
inline constexpr std::uint32_t k_decimation_x = 0x474;
inline constexpr std::uint32_t k_decimation_y = 0x478;
inline constexpr std::uint32_t k_black_level = 0x47c;  ///< added to each pixel
inline constexpr std::uint32_t k_state_locked =
    0x480;  ///< the camera's own: clients write none of the seven above
/// What set 1 has of its own (exposure, line sources) stands so far behind what set 0 has.
inline constexpr std::uint32_t k_set_stride = 0x350;
}  // namespace gv_register

/// Bit of k_gvcp_capability: PACKETRESEND is answered.
inline constexpr std::uint32_t k_can_resend = 1U << 2U;

/// Value of AcquisitionMode.
inline constexpr std::uint32_t k_single_frame = 2;
/// Values of LineSource.
inline constexpr std::uint32_t k_line_off = 0;
inline constexpr std::uint32_t k_line_exposure_active = 1;

/// Values of PtpStatus.
inline constexpr std::uint32_t k_ptp_disabled = 0;
inline constexpr std::uint32_t k_ptp_slave = 1;

/// What its registers and its description both say.
inline constexpr std::string_view k_gv_vendor = "Biteline", k_gv_model = "SimulatedLineCamera";

[[nodiscard]] std::string genicam_description();

}  // namespace biteline::sim
