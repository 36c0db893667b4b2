// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/network.hpp"

#include <CppUTest/TestHarness.h>

#include "host/interfaces/gige/server.hpp"
#include "tests/support/errors.hpp"

namespace biteline {

TEST_GROUP(GigeNetwork) {
  const std::vector<gige::Interface> all{
      {.name = "lo", .address = 0x7f00'0001, .mask = 0xff00'0000, .loopback = true},
      {.name = "eth0", .address = 0xc0a8'2801, .mask = 0xffff'ff00},
      {.name = "eth1", .address = 0x0a00'0005, .mask = 0xffff'0000}};
};

TEST(GigeNetwork, AddressesAreReadAndTold) {
  LONGS_EQUAL(0xc0a8'2802, gige::read_address("192.168.40.2").value_or(0));
  STRCMP_EQUAL("192.168.40.2", gige::address_text(0xc0a8'2802).c_str());
  for (const char* bad : {"", "eth0", "192.168.40", "192.168.40.256", "::1"})
    CHECK_FALSE(gige::read_address(bad).has_value());
}

TEST(GigeNetwork, AnInterfaceIsChosenByNameOrAddress) {
  STRCMP_EQUAL("eth1", gige::choose_interface(all, "eth1")->name.c_str());
  STRCMP_EQUAL("eth0", gige::choose_interface(all, "192.168.40.1")->name.c_str());
  LONGS_EQUAL(0x7f00'0009, gige::choose_interface(all, "127.0.0.9")->address);
  LONGS_EQUAL(0xc0a8'28ff, gige::choose_interface(all, "eth0")->broadcast());
  const auto none = gige::choose_interface(all, "192.168.40.7");
  CHECK_FALSE(none.has_value());
  STRCMP_CONTAINS("no interface 192.168.40.7", to_line(none.error()).c_str());
  STRCMP_CONTAINS("eth1 (10.0.0.5)", to_line(none.error()).c_str());
}

TEST(GigeNetwork, TheCamerasInterfaceIsRefused) {
  const std::uint32_t camera = 0xc0a8'2802;
  SUCCEEDS(gige::keep_off_camera(all[2], camera));
  const auto refused = gige::keep_off_camera(all[1], camera);
  CHECK_FALSE(refused.has_value());
  STRCMP_CONTAINS("eth0 (192.168.40.1) reaches the camera at 192.168.40.2", to_line(refused.error()).c_str());
}

TEST(GigeNetwork, BeyondLoopbackClientsAreNamed) {
  const auto opened =
      gige::Server::open({.interface = all[1], .clients = {}, .version = {}, .serial = {}, .name = {}});
  CHECK_FALSE(opened.has_value());
  STRCMP_CONTAINS("--client", to_line(opened.error()).c_str());
}

}  // namespace biteline
