// SPDX-License-Identifier: MIT
#pragma once
/// \file A bank of the kernel's simulated GPIO lines, made through configfs, with hands on its wires.
///
/// Documentation/admin-guide/gpio/gpio-sim.rst.

#include <CppUTest/TestHarness.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace biteline::test {

inline constexpr const char* k_gpio_sim_config = "/sys/kernel/config/gpio-sim";

class GpioSim {
 public:
  static constexpr int k_lines = 8;
  static constexpr const char* k_label = "biteline-test";
  static constexpr int k_laser_enable = 2;  // named as in boards/qemu-virt/board.yaml
  static constexpr int k_strobe_echo = 4;
  static constexpr int k_heartbeat = 5;
  static constexpr int k_interlock = 6;

  GpioSim() {
    std::filesystem::create_directories(bank());
    put(bank() / "num_lines", std::to_string(k_lines));
    put(bank() / "label", k_label);
    for (const Name& name : k_names) {
      std::filesystem::create_directories(bank() / name.folder);
      put(bank() / name.folder / "name", name.name);
    }
    put(device() / "live", "1");
    lines_ = std::filesystem::path{"/sys/devices/platform"} / get(device() / "dev_name") /
             get(bank() / "chip_name");
  }
  ~GpioSim() {
    put(device() / "live", "0");
    for (const Name& name : k_names) std::filesystem::remove(bank() / name.folder);
    std::filesystem::remove(bank());
    std::filesystem::remove(device());
  }
  GpioSim(const GpioSim&) = delete;
  GpioSim& operator=(const GpioSim&) = delete;

  void pull(int line, bool up) const { put(line_folder(line) / "pull", up ? "pull-up" : "pull-down"); }
  [[nodiscard]] bool value(int line) const { return get(line_folder(line) / "value") == "1"; }
  void unplug() const { put(device() / "live", "0"); }

 private:
  struct Name {
    const char* folder;
    const char* name;
  };
  static constexpr Name k_names[] = {
      {"line2", "laser-enable"}, {"line4", "strobe-echo"}, {"line5", "heartbeat"}, {"line6", "interlock"}};

  static std::filesystem::path device() { return std::filesystem::path{k_gpio_sim_config} / "biteline"; }
  static std::filesystem::path bank() { return device() / "bank0"; }
  [[nodiscard]] std::filesystem::path line_folder(int line) const {
    return lines_ / ("sim_gpio" + std::to_string(line));
  }
  static void put(const std::filesystem::path& path, const std::string& text) { std::ofstream{path} << text; }
  static std::string get(const std::filesystem::path& path) {
    std::string text;
    std::ifstream{path} >> text;
    return text;
  }

  std::filesystem::path lines_;
};

}  // namespace biteline::test
