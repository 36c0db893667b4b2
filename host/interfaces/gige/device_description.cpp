// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/device_description.hpp"

#include <array>
#include <cstdio>

#include "common/gige/bootstrap.hpp"
#include "common/gige/description.hpp"
#include "host/interfaces/gige/frame.hpp"

namespace biteline::gige {
namespace {

/// A number in the record of the line that ChunkScanLineSelector names.
struct ChunkField {
  const char* name;
  const char* kind;      ///< IntReg or FloatReg
  std::uint32_t offset;  ///< in the record, bytes
  int bytes;
  const char* index;  ///< a further selector with its stride, or nothing
  const char* space{"Custom"};
  const char* unit{""};
  const char* sign{"Unsigned"};
  const char* available{""};  ///< where it is not always there: what says so
};

constexpr std::array k_chunk_fields{
    ChunkField{"ChunkTimestamp", "IntReg", 0, 8, ""},
    ChunkField{"ChunkScanID", "IntReg", 8, 8, ""},
    ChunkField{"ChunkProfileSequence", "IntReg", 16, 8, ""},
    ChunkField{"ChunkProfileFlags", "IntReg", 24, 4, ""},
    ChunkField{"ChunkLineValid", "IntReg", 28, 4, ""},
    ChunkField{"ChunkFlangePose", "FloatReg", 32, 8, "<pIndex Offset=\"8\">ChunkFlangePoseSelector</pIndex>"},
    ChunkField{"ChunkExposureTime", "FloatReg", 128, 8, "", "Standard", "<Unit>us</Unit>"},
    ChunkField{"ChunkCameraFrame", "IntReg", 136, 8, ""},
    ChunkField{"ChunkEncoderValue", "IntReg", 144, 8, "", "Standard", "", "Signed",
               "<pIsAvailable>ChunkEncoderValid</pIsAvailable>"},
    ChunkField{"ChunkEncoderValid", "IntReg", 152, 4, ""},
};

void add_chunks(Description& xml) {
  xml.boolean("ChunkModeActive", own::k_chunk_mode);
  xml.listed("ChunkScanLineSelector");
  std::string selected;
  for (const ChunkField& field : k_chunk_fields)
    selected += std::string{"<pSelected>"} + field.name + "</pSelected>";
  xml.line(
      "<Integer Name=\"ChunkScanLineSelector\" NameSpace=\"Standard\"><Value>0</Value><Min>0</Min>"
      "<pMax>HeightLast</pMax>" +
      selected + "</Integer>");
  xml.line(
      "<IntSwissKnife Name=\"HeightLast\"><pVariable Name=\"H\">Height</pVariable><Formula>H - 1</Formula>"
      "</IntSwissKnife>");
  xml.listed("ChunkFlangePoseSelector");
  xml.line(
      "<Integer Name=\"ChunkFlangePoseSelector\" NameSpace=\"Custom\"><Value>0</Value><Min>0</Min>"
      "<Max>11</Max><pSelected>ChunkFlangePose</pSelected></Integer>");
  xml.listed("ChunkEncoderSelector");
  xml.line(
      "<Enumeration Name=\"ChunkEncoderSelector\" NameSpace=\"Standard\"><EnumEntry Name=\"Encoder0\" "
      "NameSpace=\"Standard\"><Value>0</Value></EnumEntry><Value>0</Value>"
      "<pSelected>ChunkEncoderValue</pSelected></Enumeration>");
  for (const ChunkField& field : k_chunk_fields) {
    xml.listed(field.name);
    std::array<char, 640> text{};
    const std::string sign = std::string_view{field.kind} == "IntReg"
                                 ? std::string{"<Sign>"} + field.sign + "</Sign>"
                                 : std::string{};
    std::snprintf(
        text.data(), text.size(),
        "<%s Name=\"%s\" NameSpace=\"%s\">%s<Address>%u</Address>"
        "<pIndex Offset=\"%zu\">ChunkScanLineSelector</pIndex>%s<Length>%d</Length>"
        "<AccessMode>RO</AccessMode><pPort>LinesChunk</pPort>%s<Endianess>BigEndian</Endianess>%s</%s>",
        field.kind, field.name, field.space, field.available, field.offset, k_line_record_bytes, field.index,
        field.bytes, sign.c_str(), field.unit, field.kind);
    xml.line(text.data());
  }
  std::array<char, 160> port{};
  std::snprintf(port.data(), port.size(),
                "<Port Name=\"LinesChunk\" NameSpace=\"Custom\"><ChunkID>%08x</ChunkID></Port>",
                k_lines_chunk);
  xml.line(port.data());
}

}  // namespace

std::string device_description() {
  Description xml{k_own_vendor, k_own_model};
  xml.text("DeviceVendorName", bootstrap::k_vendor, 32);
  xml.text("DeviceModelName", bootstrap::k_model, 32);
  xml.text("DeviceVersion", bootstrap::k_device_version, 32);
  xml.text("DeviceSerialNumber", bootstrap::k_serial, 16);
  xml.choices("DeviceScanType", own::k_scan_type, "RO", {{"Linescan3D", 3}});

  xml.integer("SensorWidth", own::k_sensor_width, "RO", 0, "");
  xml.integer("Width", own::k_width, "RO", 0, "");
  xml.integer("Height", own::k_height, "RW", 1, std::to_string(k_most_height));
  xml.choices("PixelFormat", own::k_pixel_format, "RW",
              {{"Mono8", static_cast<std::uint32_t>(Format::Mono8)},
               {"Coord3D_ABC32f", static_cast<std::uint32_t>(Format::Abc32f)},
               {"Coord3D_AC16", static_cast<std::uint32_t>(Format::Ac16)},
               {"Coord3D_C16", static_cast<std::uint32_t>(Format::C16)}});

  xml.integer("BinningHorizontal", own::k_binning, "RO", 1, "");
  xml.integer("BinningVertical", own::k_binning, "RO", 1, "");

  xml.choices("AcquisitionMode", own::k_acquisition_mode, "RW", {{"Continuous", 0}});
  xml.command("AcquisitionStart", own::k_acquisition, 1);
  xml.command("AcquisitionStop", own::k_acquisition, 0);

  const std::string per_coordinate = Description::per("Scan3dCoordinateSelector", 4);
  xml.choices("Scan3dDistanceUnit", own::k_unit, "RO", {{"Millimeter", 0}});
  xml.choices("Scan3dCoordinateSystem", own::k_system, "RO", {{"Cartesian", 0}});
  xml.choices("Scan3dCoordinateSystemReference", own::k_reference, "RO", {{"Anchor", 0}});
  xml.choices("Scan3dOutputMode", own::k_output_mode, "RO",
              {{"CalibratedABC_Grid", k_calibrated_grid},
               {"CalibratedAC_Linescan", k_calibrated_profile},
               {"CalibratedC_Linescan", k_calibrated_depth}});
  xml.choices("Scan3dCoordinateSelector", own::k_coordinate_selector, "RW",
              {{"CoordinateA", 0}, {"CoordinateB", 1}, {"CoordinateC", 2}}, {},
              Description::selected({"Scan3dCoordinateScale", "Scan3dCoordinateOffset"}));
  xml.float_register("Scan3dCoordinateScale", own::k_scale, "RO", per_coordinate);
  xml.float_register("Scan3dCoordinateOffset", own::k_offset, "RO", per_coordinate);
  xml.boolean("Scan3dInvalidDataFlag", own::k_invalid_flag, "RO");
  xml.float_register("Scan3dInvalidDataValue", own::k_invalid_value, "RO");

  add_chunks(xml);
  xml.integer("PayloadSize", own::k_payload_size, "RO", 0, "");
  xml.integer("GevSCPSPacketSize", bootstrap::k_stream_packet_size, "RW", 576, "65000");
  xml.integer("GevHeartbeatTimeout", bootstrap::k_heartbeat_timeout, "RW", 500, "60000");
  xml.integer("TLParamsLocked", own::k_locked, "RW", 0, "1");
  return xml.whole();
}

}  // namespace biteline::gige
