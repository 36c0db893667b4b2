// SPDX-License-Identifier: MIT
#include "common/gige/description.hpp"

#include <array>
#include <cstdarg>
#include <cstdio>

namespace biteline::gige {

void Description::text(const char* name, std::uint32_t address, int length) {
  listed(name);
  add("<StringReg Name=\"%s\" "
      "NameSpace=\"Standard\"><Address>0x%x</Address><Length>%d</Length><AccessMode>RO</AccessMode>"
      "<pPort>Device</pPort></StringReg>\n",
      name, address, length);
}

void Description::integer(const char* name, std::uint32_t address, const char* access, int minimum,
                          const std::string& limit, const std::string& index) {
  listed(name);
  const std::string tag = limit.empty()                          ? ""
                          : (limit[0] >= '0' && limit[0] <= '9') ? "<Max>" + limit + "</Max>"
                                                                 : "<pMax>" + limit + "</pMax>";
  add("<Integer Name=\"%s\" NameSpace=\"Standard\"><pValue>%sRegister</pValue><Min>%d</Min>%s</Integer>\n",
      name, name, minimum, tag.c_str());
  raw_register(name, address, access, index);
}

void Description::real(const char* name, std::uint32_t address, const char* access, int per_unit,
                       double minimum, double maximum, const std::string& index) {
  listed(name);
  add("<Float Name=\"%s\" "
      "NameSpace=\"Standard\"><pValue>%sConverter</pValue><Min>%g</Min><Max>%g</Max></Float>\n",
      name, name, minimum, maximum);
  add("<Converter Name=\"%sConverter\"><FormulaTo>FROM * %d</FormulaTo><FormulaFrom>TO / "
      "%d.0</FormulaFrom><pValue>%sRegister</pValue></Converter>\n",
      name, per_unit, per_unit, name);
  raw_register(name, address, access, index);
}

void Description::float_register(const char* name, std::uint32_t address, const char* access,
                                 const std::string& index) {
  listed(name);
  add("<FloatReg Name=\"%s\" "
      "NameSpace=\"Standard\"><Address>0x%x</Address>%s<Length>4</Length><AccessMode>%s</AccessMode>"
      "<pPort>Device</pPort><Endianess>BigEndian</Endianess></FloatReg>\n",
      name, address, index.c_str(), access);
}

void Description::rate(const char* name, std::uint32_t address, double minimum, double maximum) {
  listed(name);
  add("<Float Name=\"%s\" "
      "NameSpace=\"Standard\"><pValue>%sConverter</pValue><Min>%g</Min><Max>%g</Max></Float>\n",
      name, name, minimum, maximum);
  add("<Converter Name=\"%sConverter\"><FormulaTo>1000000 / FROM</FormulaTo><FormulaFrom>1000000.0 / "
      "TO</FormulaFrom><pValue>%sRegister</pValue></Converter>\n",
      name, name);
  raw_register(name, address, "RW");
}

void Description::boolean(const char* name, std::uint32_t address, const char* access) {
  listed(name);
  add("<Boolean Name=\"%s\" "
      "NameSpace=\"Standard\"><pValue>%sRegister</pValue><OnValue>1</OnValue><OffValue>0</OffValue></"
      "Boolean>\n",
      name, name);
  raw_register(name, address, access);
}

void Description::choices(const char* name, std::uint32_t address, const char* access,
                          const std::vector<Choice>& entries, const std::string& index,
                          const std::string& selected) {
  listed(name);
  add("<Enumeration Name=\"%s\" NameSpace=\"Standard\">", name);
  for (const auto& entry : entries) {
    add("<EnumEntry Name=\"%s\" NameSpace=\"Standard\"><Value>%u</Value></EnumEntry>", entry.name,
        entry.value);
  }
  add("<pValue>%sRegister</pValue>%s</Enumeration>\n", name, selected.c_str());
  raw_register(name, address, access, index);
}

void Description::command(const char* name, std::uint32_t address, int value) {
  listed(name);
  add("<Command Name=\"%s\" "
      "NameSpace=\"Standard\"><pValue>%sRegister</pValue><CommandValue>%d</CommandValue></Command>\n",
      name, name, value);
  raw_register(name, address, "WO");
}

void Description::listed(const char* name) {
  features_ += std::string("<pFeature>") + name + "</pFeature>";
}

std::string Description::per(const char* selector, std::uint32_t stride) {
  return "<pIndex Offset=\"" + std::to_string(stride) + "\">" + selector + "Register</pIndex>";
}

std::string Description::selected(const std::vector<const char*>& features) {
  std::string text;
  for (const char* feature : features) text += std::string{"<pSelected>"} + feature + "</pSelected>";
  return text;
}

std::string Description::whole() const {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
         "<RegisterDescription ModelName=\"" +
         std::string{model_} + "\" VendorName=\"" + std::string{vendor_} +
         "\" "
         "StandardNameSpace=\"None\" "
         "SchemaMajorVersion=\"1\" SchemaMinorVersion=\"0\" SchemaSubMinorVersion=\"1\" MajorVersion=\"1\" "
         "MinorVersion=\"0\" "
         "SubMinorVersion=\"0\" ToolTip=\"" +
         std::string{model_} +
         "\" ProductGuid=\"0\" VersionGuid=\"0\" "
         "xmlns=\"http://www.genicam.org/GenApi/Version_1_0\" "
         "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
         "xsi:schemaLocation=\"http://www.genicam.org/GenApi/Version_1_0 GenApiSchema.xsd\">\n"
         "<Category Name=\"Root\" NameSpace=\"Standard\">" +
         features_ + "</Category>\n" + body_ +
         "<Port Name=\"Device\" NameSpace=\"Standard\"></Port>\n</RegisterDescription>\n";
}

void Description::add(const char* pattern, ...) {
  std::array<char, 1024> text{};
  std::va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text.data(), text.size(), pattern, arguments);
  va_end(arguments);
  body_ += text.data();
}

void Description::raw_register(const char* name, std::uint32_t address, const char* access,
                               const std::string& index) {
  add("<IntReg Name=\"%sRegister\" "
      "NameSpace=\"Custom\"><Address>0x%x</Address>%s<Length>4</Length><AccessMode>%s</AccessMode>"
      "<pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>\n",
      name, address, index.c_str(), access);
}

}  // namespace biteline::gige
