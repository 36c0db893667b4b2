// SPDX-License-Identifier: MIT
#include "common/rtde/fields.hpp"

#include <charconv>
#include <span>

namespace biteline::rtde {
namespace {

struct Named {
  std::string_view name;
  FieldType type;
};

using enum FieldType;

constexpr std::array k_wire_names{
    Named{"BOOL", Bool},
    Named{"UINT8", Uint8},
    Named{"UINT32", Uint32},
    Named{"UINT64", Uint64},
    Named{"INT32", Int32},
    Named{"DOUBLE", Double},
    Named{"VECTOR3D", Vector3d},
    Named{"VECTOR6D", Vector6d},
    Named{"VECTOR6INT32", Vector6i},
    Named{"VECTOR6UINT32", Vector6u},
};

constexpr std::array k_outputs{
    Named{"timestamp", Double},
    Named{"target_q", Vector6d},
    Named{"target_qd", Vector6d},
    Named{"target_qdd", Vector6d},
    Named{"target_current", Vector6d},
    Named{"target_moment", Vector6d},
    Named{"actual_q", Vector6d},
    Named{"actual_qd", Vector6d},
    Named{"actual_current", Vector6d},
    Named{"joint_control_output", Vector6d},
    Named{"actual_TCP_pose", Vector6d},
    Named{"actual_TCP_speed", Vector6d},
    Named{"actual_TCP_force", Vector6d},
    Named{"target_TCP_pose", Vector6d},
    Named{"target_TCP_speed", Vector6d},
    Named{"tcp_offset", Vector6d},
    Named{"actual_digital_input_bits", Uint64},
    Named{"actual_digital_output_bits", Uint64},
    Named{"joint_temperatures", Vector6d},
    Named{"joint_mode", Vector6i},
    Named{"actual_execution_time", Double},
    Named{"robot_mode", Int32},
    Named{"safety_mode", Int32},
    Named{"safety_status", Int32},
    Named{"robot_status_bits", Uint32},
    Named{"safety_status_bits", Uint32},
    Named{"actual_tool_accelerometer", Vector3d},
    Named{"speed_scaling", Double},
    Named{"target_speed_fraction", Double},
    Named{"actual_momentum", Double},
    Named{"actual_main_voltage", Double},
    Named{"actual_robot_voltage", Double},
    Named{"actual_robot_current", Double},
    Named{"actual_joint_voltage", Vector6d},
    Named{"elbow_position", Vector3d},
    Named{"elbow_velocity", Vector3d},
    Named{"runtime_state", Uint32},
    Named{"payload", Double},
    Named{"payload_cog", Vector3d},
    Named{"script_control_line", Uint32},
    Named{"output_bit_registers0_to_31", Uint32},
    Named{"output_bit_registers32_to_63", Uint32},
    Named{"actual_current_window", Vector6d},
    Named{"actual_current_as_torque", Vector6d},
    Named{"actual_TCP_acceleration", Vector6d},
    Named{"target_TCP_acceleration", Vector6d},
    Named{"actual_configurable_digital_input_bits", Uint64},
    Named{"actual_configurable_digital_output_bits", Uint64},
    Named{"target_execution_time", Double},
    Named{"analog_io_types", Uint32},
    Named{"standard_analog_input0", Double},
    Named{"standard_analog_input1", Double},
    Named{"standard_analog_output0", Double},
    Named{"standard_analog_output1", Double},
    Named{"io_current", Double},
    Named{"actual_robot_energy_consumed", Double},
    Named{"actual_robot_braking_energy_dissipated", Double},
    Named{"encoder0_raw", Int32},
    Named{"encoder1_raw", Int32},
    Named{"euromap67_input_bits", Uint32},
    Named{"euromap67_output_bits", Uint32},
    Named{"euromap67_24V_voltage", Double},
    Named{"euromap67_24V_current", Double},
    Named{"tool_mode", Uint32},
    Named{"tool_analog_input_types", Uint32},
    Named{"tool_analog_input0", Double},
    Named{"tool_analog_input1", Double},
    Named{"tool_output_voltage", Int32},
    Named{"tool_output_current", Double},
    Named{"tool_temperature", Double},
    Named{"tool_output_mode", Uint8},
    Named{"tool_digital_output0_mode", Uint8},
    Named{"tool_digital_output1_mode", Uint8},
    Named{"tcp_force_scalar", Double},
    Named{"joint_position_deviation_ratio", Double},
    Named{"collision_detection_ratio", Double},
    Named{"ft_raw_wrench", Vector6d},
    Named{"wrench_calc_from_currents", Vector6d},
    Named{"payload_inertia", Vector6d},
    Named{"time_scale_source", Int32},
    Named{"target_gravity", Vector3d},
    Named{"target_base_acceleration", Vector6d},
    Named{"target_base_wrench", Vector6d},
    Named{"control_step", Uint64},
    Named{"input_bit_registers0_to_31", Uint32},
    Named{"input_bit_registers32_to_63", Uint32},
};

constexpr std::array k_inputs{
    Named{"speed_slider_mask", Uint32},
    Named{"speed_slider_fraction", Double},
    Named{"standard_digital_output_mask", Uint8},
    Named{"standard_digital_output", Uint8},
    Named{"configurable_digital_output_mask", Uint8},
    Named{"configurable_digital_output", Uint8},
    Named{"tool_digital_output_mask", Uint8},
    Named{"tool_digital_output", Uint8},
    Named{"standard_analog_output_mask", Uint8},
    Named{"standard_analog_output_type", Uint8},
    Named{"standard_analog_output_0", Double},
    Named{"standard_analog_output_1", Double},
    Named{"input_bit_registers0_to_31", Uint32},
    Named{"input_bit_registers32_to_63", Uint32},
    Named{"external_force_torque", Vector6d},
};

/// Numbered registers, the inputs' read back as outputs under their own names; the e series has 48 of each
/// kind, 64 to 127 of the bits one by one.
struct Family {
  std::string_view prefix;
  int first;
  int last;
  FieldType type;
};
constexpr std::array k_output_registers{
    Family{"output_int_register_", 0, 47, Int32},    Family{"output_double_register_", 0, 47, Double},
    Family{"output_bit_register_", 64, 127, Bool},   Family{"input_int_register_", 0, 47, Int32},
    Family{"input_double_register_", 0, 47, Double}, Family{"input_bit_register_", 64, 127, Bool},
};
constexpr std::array k_input_registers{
    Family{"input_int_register_", 0, 47, Int32},
    Family{"input_double_register_", 0, 47, Double},
    Family{"input_bit_register_", 64, 127, Bool},
};

std::optional<FieldType> find(std::string_view name, std::span<const Named> table,
                              std::span<const Family> families) {
  for (const Named& row : table) {
    if (row.name == name) return row.type;
  }
  for (const Family& family : families) {
    if (!name.starts_with(family.prefix)) continue;
    const std::string_view digits = name.substr(family.prefix.size());
    int number = -1;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    const bool whole = error == std::errc{} && end == digits.data() + digits.size();
    if (whole && number >= family.first && number <= family.last) return family.type;
  }
  return std::nullopt;
}

std::vector<std::string> all_names(std::span<const Named> table, std::span<const Family> families) {
  std::vector<std::string> names;
  for (const Named& row : table) names.emplace_back(row.name);
  for (const Family& family : families) {
    for (int number = family.first; number <= family.last; ++number)
      names.push_back(std::string{family.prefix} + std::to_string(number));
  }
  return names;
}

}  // namespace

std::string_view wire_name(FieldType type) {
  return k_wire_names[static_cast<std::size_t>(type)].name;
}

std::optional<FieldType> field_type_of(std::string_view wire_name) {
  return find(wire_name, k_wire_names, {});
}

Value zero_of(FieldType type) {
  switch (type) {
    case Bool:
      return false;
    case Uint8:
      return std::uint8_t{0};
    case Uint32:
      return std::uint32_t{0};
    case Uint64:
      return std::uint64_t{0};
    case Int32:
      return std::int32_t{0};
    case Double:
      return 0.0;
    case Vector3d:
      return Vector3{};
    case Vector6d:
      return Vector6{};
    case Vector6i:
      return Vector6Int32{};
    case Vector6u:
      return Vector6Uint32{};
  }
  return 0.0;
}

std::optional<FieldType> output_type(std::string_view name) {
  return find(name, k_outputs, k_output_registers);
}
std::optional<FieldType> input_type(std::string_view name) {
  return find(name, k_inputs, k_input_registers);
}

std::vector<std::string> output_names() {
  return all_names(k_outputs, k_output_registers);
}
std::vector<std::string> input_names() {
  return all_names(k_inputs, k_input_registers);
}

std::string join(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ",") + name;
  return list;
}

std::vector<std::string> split(std::string_view list) {
  std::vector<std::string> names;
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    names.emplace_back(list.substr(0, comma));
    list = comma == std::string_view::npos ? std::string_view{} : list.substr(comma + 1);
  }
  return names;
}

}  // namespace biteline::rtde
