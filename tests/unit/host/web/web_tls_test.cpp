// SPDX-License-Identifier: MIT
// Beyond loopback: a certificate, TLS and nothing older.
#include <CppUTest/TestHarness.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "tests/unit/host/web/running_server.hpp"

namespace biteline::web {

TEST_GROUP(WebTls){};

TEST(WebTls, WithACertificateItServesTlsAndNothingOlder) {
  if (std::system("command -v curl >/dev/null && command -v openssl >/dev/null") != 0) {
    std::puts("skipped: TLS needs curl and openssl");
    return;
  }
  const test::TemporaryFolder keys;
  const std::string folder = keys.path().string();
  const std::string made =
      "cd " + folder +
      " && openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout key.pem "
      "-out certificate.pem -days 2 -subj /CN=localhost -addext subjectAltName=DNS:localhost "
      ">/dev/null 2>&1";
  LONGS_EQUAL(0, std::system(made.c_str()));
  const RunningServer sut{
      {}, TlsFiles{.certificate = keys.path() / "certificate.pem", .key = keys.path() / "key.pem"}};
  const std::string curl = "cd " + folder + " && curl -s --max-time 60 --cacert certificate.pem ";
  const std::string place = "https://localhost:" + std::to_string(sut.server->port());
  const auto said = [&keys] {
    std::ifstream out{keys.path() / "out"};
    return std::string{std::istreambuf_iterator<char>{out}, {}};
  };
  LONGS_EQUAL(0, std::system((curl + "-D - " + place + "/ >out").c_str()));
  STRCMP_CONTAINS("Strict-Transport-Security", said().c_str());
  STRCMP_CONTAINS("<title>page</title>", said().c_str());
  const std::string login =
      R"(-H 'Content-Type: application/json' -d '{"name":"ada","password":"correct horse","cookie":true}' )";
  LONGS_EQUAL(0, std::system((curl + login + "-D - " + place + "/api/v1/sessions >out").c_str()));
  STRCMP_CONTAINS("SameSite=Strict; Secure", said().c_str());
  // The live data over TLS: the socket is opened and stays open until curl gives up.
  const std::string upgrade =
      "-N --max-time 1 --http1.1 -D - -H 'Authorization: Bearer viewer-token' -H 'Connection: Upgrade' "
      "-H 'Upgrade: websocket' -H 'Sec-WebSocket-Version: 13' -H 'Sec-WebSocket-Key: "
      "dGhlIHNhbXBsZSBub25jZQ==' ";
  CHECK(std::system((curl + upgrade + place + "/api/v1/events >out").c_str()) != 0);
  STRCMP_CONTAINS("101 Switching Protocols", said().c_str());
  CHECK(std::system((curl + "--tls-max 1.1 " + place + "/ >out").c_str()) != 0);
  // Who speaks no TLS gets no answer, and holds nobody up.
  CHECK(sut.client().ask("GET", "/").status == 0);
  LONGS_EQUAL(0, std::system((curl + place + "/ >out").c_str()));
}

TEST(WebTls, BeyondLoopbackItWantsTls) {
  WebConfig config;
  config.port = 0;
  config.address = "0.0.0.0";
  FAILS_NAMING(Errc::AuthenticationFailed, "--certificate", WebServer::open(config, closed_service_door()));
  config.address = "example.org";
  FAILS_NAMING(Errc::InvalidArgument, "example.org", WebServer::open(config, closed_service_door()));
  config.address = "127.0.0.1";
  config.tls = TlsFiles{.certificate = "/none.pem", .key = "/none.key"};
  FAILS_NAMING(Errc::FileUnreadable, "none.pem", WebServer::open(config, closed_service_door()));
}

}  // namespace biteline::web
