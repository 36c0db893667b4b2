// SPDX-License-Identifier: MIT
#include "hal/sim/gvcamera/genicam_description.hpp"

#include "common/gige/description.hpp"

namespace biteline::sim {

namespace {

/// Registers that Aravis lays out by the GigE Vision bootstrap map, and the fake camera's own commands.
constexpr std::uint32_t k_version = 0x88, k_serial = 0xd8;
constexpr std::uint32_t k_pixel_format = 0x128, k_trigger_activation = 0x308;

}  // namespace

std::string genicam_description() {
  using namespace gv_register;
  gige::Description xml{k_gv_vendor, k_gv_model};
  xml.text("DeviceVendorName", k_vendor_name, 32);
  xml.text("DeviceModelName", k_model_name, 32);
  xml.text("DeviceVersion", k_version, 32);
  xml.text("DeviceID", k_serial, 16);
  xml.text("DeviceSerialNumber", k_serial, 16);
  xml.real("DeviceTemperature", k_temperature_millidegc_register, "RO", 1000, -40, 125);

  xml.integer("SensorWidth", k_sensor_width, "RO", 0, "");
  xml.integer("SensorHeight", k_sensor_height, "RO", 0, "");
  const auto largest = [&](const std::string& size, const std::string& axis) {
    const std::string name = size + "Max";
    xml.listed(name.c_str());
    xml.line("<IntSwissKnife Name=\"" + name + "\" NameSpace=\"Standard\"><pVariable Name=\"S\">Sensor" +
             size + "</pVariable><pVariable Name=\"B\">Binning" + axis +
             "</pVariable><pVariable Name=\"D\">Decimation" + axis +
             "</pVariable><Formula>S / (B * D)</Formula></IntSwissKnife>");
  };
  largest("Width", "Horizontal");
  largest("Height", "Vertical");
  xml.integer("Width", k_width, "RW", 16, "WidthMax");
  xml.integer("Height", k_height, "RW", 4, "HeightMax");
  xml.integer("OffsetX", k_offset_x, "RW", 0, "WidthMax");
  xml.integer("OffsetY", k_offset_y, "RW", 0, "HeightMax");
  xml.boolean("ReverseX", k_reverse_x);
  xml.boolean("ReverseY", k_reverse_y);
  xml.integer("BinningHorizontal", k_binning_x, "RW", 1, "4");
  xml.integer("BinningVertical", k_binning_y, "RW", 1, "4");
  xml.integer("DecimationHorizontal", k_decimation_x, "RW", 1, "4");
  xml.integer("DecimationVertical", k_decimation_y, "RW", 1, "4");
  xml.real("BlackLevel", k_black_level, "RW", 1, 0, 64);
  xml.choices("PixelFormat", k_pixel_format, "RW", {{"Mono8", 0x01080001}});

  xml.choices("AcquisitionMode", k_acquisition_mode, "RW",
              {{"Continuous", 1}, {"SingleFrame", k_single_frame}});
  xml.command("AcquisitionStart", k_acquisition, 1);
  xml.command("AcquisitionStop", k_acquisition, 0);
  xml.boolean("AcquisitionFrameRateEnable", k_frame_rate_enable);
  xml.rate("AcquisitionFrameRate", k_frame_period_us, 0.1, 1000);
  const std::string per_set = gige::Description::per("SequencerSetSelector", k_set_stride);
  xml.real("ExposureTime", k_exposure_us, "RW", 1, 10, 1e6, per_set);

  xml.real("Gain", k_gain_centidb, "RW", 100, 0, 24);

  xml.listed("TriggerSelector");
  xml.line(
      "<Enumeration Name=\"TriggerSelector\" NameSpace=\"Standard\"><EnumEntry Name=\"FrameStart\" "
      "NameSpace=\"Standard\">"
      "<Value>0</Value></EnumEntry><Value>0</Value></Enumeration>");
  xml.choices("TriggerMode", k_trigger_mode, "RW", {{"Off", 0}, {"On", 1}});
  // The fake camera knows 1 as "fires when register k_trigger_fire is written"; here a wire writes it, not a
  // command.
  xml.choices("TriggerSource", k_trigger_source, "RW", {{"Line0", 1}});
  xml.choices("TriggerActivation", k_trigger_activation, "RW", {{"RisingEdge", 0}});

  xml.choices("LineSelector", k_line_selector, "RW", {{"Line0", 0}, {"Line1", 1}});
  xml.choices("LineSource", k_line_source, "RW",
              {{"Off", k_line_off}, {"ExposureActive", k_line_exposure_active}},
              gige::Description::per("LineSelector", 4) + per_set);
  // Two sets in turn.  Each set's registers are its own, so that there is nothing to save.
  xml.choices("SequencerMode", k_sequencer_mode, "RW", {{"Off", 0}, {"On", 1}});
  xml.choices("SequencerConfigurationMode", k_sequencer_configuration, "RW", {{"Off", 0}, {"On", 1}});
  xml.integer("SequencerSetSelector", k_sequencer_selector, "RW", 0, "1");
  xml.command("SequencerSetSave", k_sequencer_save, 1);
  xml.integer("SequencerPathSelector", k_sequencer_path, "RW", 0, "0");
  xml.choices("SequencerTriggerSource", k_sequencer_trigger, "RW", {{"ExposureEnd", 0}});
  xml.integer("SequencerSetNext", k_sequencer_next, "RW", 0, "1",
              gige::Description::per("SequencerSetSelector", 4));
  xml.integer("SequencerSetStart", k_sequencer_start, "RW", 0, "1");
  xml.boolean("PtpEnable", k_ptp_enable);
  xml.choices("PtpStatus", k_ptp_status, "RO", {{"Disabled", k_ptp_disabled}, {"Slave", k_ptp_slave}});

  xml.listed("PayloadSize");
  xml.line(
      "<IntSwissKnife Name=\"PayloadSize\" NameSpace=\"Standard\"><pVariable Name=\"W\">Width</pVariable>"
      "<pVariable Name=\"H\">Height</pVariable><Formula>W * H</Formula></IntSwissKnife>");
  xml.line(
      "<Integer "
      "Name=\"TLParamsLocked\"><Visibility>Invisible</Visibility><Value>0</Value><Min>0</Min><Max>1</Max></"
      "Integer>");
  return xml.whole();
}

}  // namespace biteline::sim
