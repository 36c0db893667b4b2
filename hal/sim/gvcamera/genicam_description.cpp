// SPDX-License-Identifier: MIT
#include "hal/sim/gvcamera/genicam_description.hpp"

#include <cstdio>
#include <vector>

namespace biteline::sim {

namespace {

/// Registers that Aravis lays out by the GigE Vision bootstrap map, and the fake camera's own commands.
constexpr std::uint32_t k_version = 0x88, k_serial = 0xd8;
constexpr std::uint32_t k_pixel_format = 0x128, k_trigger_activation = 0x308;

struct Choice {
  const char* name;
  std::uint32_t value;
};

class Description {
 public:
  void text(const char* name, std::uint32_t address, int length) {
    feature(name);
    add("<StringReg Name=\"%s\" "
        "NameSpace=\"Standard\"><Address>0x%x</Address><Length>%d</Length><AccessMode>RO</AccessMode>"
        "<pPort>Device</pPort></StringReg>\n",
        name, address, length);
  }
  /// `limit`: a feature's name or a number, empty for none.
  void integer(const char* name, std::uint32_t address, const char* access, int minimum,
               const std::string& limit, const std::string& index = {}) {
    feature(name);
    const std::string tag = limit.empty()                          ? ""
                            : (limit[0] >= '0' && limit[0] <= '9') ? "<Max>" + limit + "</Max>"
                                                                   : "<pMax>" + limit + "</pMax>";
    add("<Integer Name=\"%s\" NameSpace=\"Standard\"><pValue>%sRegister</pValue><Min>%d</Min>%s</Integer>\n",
        name, name, minimum, tag.c_str());
    raw_register(name, address, access, index);
  }
  /// value = register / per_unit
  void real(const char* name, std::uint32_t address, const char* access, int per_unit, double minimum,
            double maximum, const std::string& index = {}) {
    feature(name);
    add("<Float Name=\"%s\" "
        "NameSpace=\"Standard\"><pValue>%sConverter</pValue><Min>%g</Min><Max>%g</Max></Float>\n",
        name, name, minimum, maximum);
    add("<Converter Name=\"%sConverter\"><FormulaTo>FROM * %d</FormulaTo><FormulaFrom>TO / "
        "%d.0</FormulaFrom><pValue>%sRegister</pValue></Converter>\n",
        name, per_unit, per_unit, name);
    raw_register(name, address, access, index);
  }
  /// value = 1e6 / register: a rate kept as a period in microseconds
  void rate(const char* name, std::uint32_t address, double minimum, double maximum) {
    feature(name);
    add("<Float Name=\"%s\" "
        "NameSpace=\"Standard\"><pValue>%sConverter</pValue><Min>%g</Min><Max>%g</Max></Float>\n",
        name, name, minimum, maximum);
    add("<Converter Name=\"%sConverter\"><FormulaTo>1000000 / FROM</FormulaTo><FormulaFrom>1000000.0 / "
        "TO</FormulaFrom><pValue>%sRegister</pValue></Converter>\n",
        name, name);
    raw_register(name, address, "RW");
  }
  void boolean(const char* name, std::uint32_t address) {
    feature(name);
    add("<Boolean Name=\"%s\" "
        "NameSpace=\"Standard\"><pValue>%sRegister</pValue><OnValue>1</OnValue><OffValue>0</OffValue></"
        "Boolean>\n",
        name, name);
    raw_register(name, address, "RW");
  }
  void choices(const char* name, std::uint32_t address, const char* access,
               const std::vector<Choice>& entries, const std::string& index = {}) {
    feature(name);
    add("<Enumeration Name=\"%s\" NameSpace=\"Standard\">", name);
    for (const auto& entry : entries) {
      add("<EnumEntry Name=\"%s\" NameSpace=\"Standard\"><Value>%u</Value></EnumEntry>", entry.name,
          entry.value);
    }
    add("<pValue>%sRegister</pValue></Enumeration>\n", name);
    raw_register(name, address, access, index);
  }
  void command(const char* name, std::uint32_t address, int value) {
    feature(name);
    add("<Command Name=\"%s\" "
        "NameSpace=\"Standard\"><pValue>%sRegister</pValue><CommandValue>%d</CommandValue></Command>\n",
        name, name, value);
    raw_register(name, address, "WO");
  }
  void line(const std::string& text) { body_ += text + "\n"; }
  void listed(const char* name) { feature(name); }
  /// One register for each value of the selector, `stride` bytes apart.
  [[nodiscard]] static std::string per(const char* selector, std::uint32_t stride) {
    return "<pIndex Offset=\"" + std::to_string(stride) + "\">" + selector + "Register</pIndex>";
  }

  [[nodiscard]] std::string whole() const {
    return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
           "<RegisterDescription ModelName=\"" +
           std::string{k_gv_model} + "\" VendorName=\"" + std::string{k_gv_vendor} +
           "\" "
           "StandardNameSpace=\"None\" "
           "SchemaMajorVersion=\"1\" SchemaMinorVersion=\"0\" SchemaSubMinorVersion=\"1\" MajorVersion=\"1\" "
           "MinorVersion=\"0\" "
           "SubMinorVersion=\"0\" ToolTip=\"Simulated\" ProductGuid=\"0\" VersionGuid=\"0\" "
           "xmlns=\"http://www.genicam.org/GenApi/Version_1_0\" "
           "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
           "xsi:schemaLocation=\"http://www.genicam.org/GenApi/Version_1_0 GenApiSchema.xsd\">\n"
           "<Category Name=\"Root\" NameSpace=\"Standard\">" +
           features_ + "</Category>\n" + body_ +
           "<Port Name=\"Device\" NameSpace=\"Standard\"></Port>\n</RegisterDescription>\n";
  }

 private:
  template <class... Arguments>
  void add(const char* pattern, Arguments... arguments) {
    char text[1024];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
#pragma GCC diagnostic ignored "-Wformat-security"
    std::snprintf(text, sizeof text, pattern, arguments...);
#pragma GCC diagnostic pop
    body_ += text;
  }
  void feature(const char* name) {
    features_ += std::string("<pFeature>") + name + "</pFeature>";
  }
  void raw_register(const char* name, std::uint32_t address, const char* access,
                    const std::string& index = {}) {
    add("<IntReg Name=\"%sRegister\" "
        "NameSpace=\"Custom\"><Address>0x%x</Address>%s<Length>4</Length><AccessMode>%s</AccessMode>"
        "<pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>\n",
        name, address, index.c_str(), access);
  }

  std::string features_, body_;
};

}  // namespace

std::string genicam_description() {
  using namespace gv_register;
  Description xml;
  xml.text("DeviceVendorName", k_vendor_name, 32);
  xml.text("DeviceModelName", k_model_name, 32);
  xml.text("DeviceVersion", k_version, 32);
  xml.text("DeviceID", k_serial, 16);
  xml.text("DeviceSerialNumber", k_serial, 16);
  xml.real("DeviceTemperature", k_temperature_millidegc_register, "RO", 1000, -40, 125);

  xml.integer("SensorWidth", k_sensor_width, "RO", 0, "");
  xml.integer("SensorHeight", k_sensor_height, "RO", 0, "");
  xml.integer("Width", k_width, "RW", 16, "SensorWidth");
  xml.integer("Height", k_height, "RW", 4, "SensorHeight");
  xml.integer("OffsetX", k_offset_x, "RW", 0, "SensorWidth");
  xml.integer("OffsetY", k_offset_y, "RW", 0, "SensorHeight");
  xml.choices("PixelFormat", k_pixel_format, "RW", {{"Mono8", 0x01080001}});

  xml.choices("AcquisitionMode", k_acquisition_mode, "RW",
              {{"Continuous", 1}, {"SingleFrame", k_single_frame}});
  xml.command("AcquisitionStart", k_acquisition, 1);
  xml.command("AcquisitionStop", k_acquisition, 0);
  xml.boolean("AcquisitionFrameRateEnable", k_frame_rate_enable);
  xml.rate("AcquisitionFrameRate", k_frame_period_us, 0.1, 1000);
  const std::string per_set = Description::per("SequencerSetSelector", k_set_stride);
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
              Description::per("LineSelector", 4) + per_set);
  // Two sets in turn.  Each set's registers are its own, so that there is nothing to save.
  xml.choices("SequencerMode", k_sequencer_mode, "RW", {{"Off", 0}, {"On", 1}});
  xml.choices("SequencerConfigurationMode", k_sequencer_configuration, "RW", {{"Off", 0}, {"On", 1}});
  xml.integer("SequencerSetSelector", k_sequencer_selector, "RW", 0, "1");
  xml.command("SequencerSetSave", k_sequencer_save, 1);
  xml.integer("SequencerPathSelector", k_sequencer_path, "RW", 0, "0");
  xml.choices("SequencerTriggerSource", k_sequencer_trigger, "RW", {{"ExposureEnd", 0}});
  xml.integer("SequencerSetNext", k_sequencer_next, "RW", 0, "1",
              Description::per("SequencerSetSelector", 4));
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
