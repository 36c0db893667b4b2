// SPDX-License-Identifier: MIT
// The text door: what is not its protocol, and who asks nothing.
#include "host/apps/biteline-web/line/line_doors.hpp"

#include <CppUTest/TestHarness.h>

#include "host/apps/biteline-web/line/line_talk.hpp"
#include "tests/unit/host/web/running_server.hpp"

namespace biteline::web {
namespace {

struct TextDoor {
  explicit TextDoor(const LineLimits& limits = {}) {
    auto made = std::make_unique<MadeService>();
    service = made.get();
    auto opened = LineDoors::open({.text = LineListener{.address = "127.0.0.1", .port = 0}, .limits = limits},
                                  std::move(made));
    SUCCEEDS(opened);
    doors = std::move(*opened);
  }
  [[nodiscard]] WebClient peer() const { return WebClient{doors->text_port()}; }
  /// Commands that came to the service, reading apart.
  [[nodiscard]] int commands() const {
    int count = 0;
    for (const control::Request& request : service->asked()) count += request.method == "GET" ? 0 : 1;
    return count;
  }

  MadeService* service{nullptr};
  std::unique_ptr<LineDoors> doors;
};

/// All that comes until the door ends the connection.
std::string all_of(const WebClient& peer) {
  std::string all;
  char bytes[512];
  for (ssize_t got = 1; got > 0;) {
    got = ::recv(peer.fd(), bytes, sizeof bytes, 0);
    if (got > 0) all.append(bytes, static_cast<std::size_t>(got));
  }
  return all;
}

/// One line of answer.
std::string line_of(const WebClient& peer) {
  std::string line;
  char byte = 0;
  while (::recv(peer.fd(), &byte, 1, 0) == 1 && byte != '\n') line += byte;
  return line;
}

LineCut cut(const std::string& text) {
  static const std::unique_ptr<LineTalk> talk = text_talk();
  return talk->cut({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace

TEST_GROUP(LineDoors){};

TEST(LineDoors, WhatIsAnotherProtocolEndsBeforeItsNextLine) {
  const std::string commands = "JOB 1\nSTART 77\n";
  const std::string hello{"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11};
  const TextDoor sut;
  for (const std::string& front :
       {std::string{"POST / HTTP/1.1\r\nHost: x\r\n\r\n"}, std::string{"GET /\n"}, std::string{"PUT x\n"},
        std::string{"OPTIONS * HTTP/1.0\n"}, std::string{"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"}, hello + "\n",
        std::string{"\xff\xfb\x01\n"}, std::string{"\0\0\0\x05\n", 5}, std::string{"EHLO me\r\n"},
        std::string{"SSH-2.0-x\r\n"}, std::string{"{\"job\":1}\n"}, std::string{"start 3\n"},
        std::string{"STATES\n"}, std::string(300, 'J') + "\n", "JOB " + std::string(80, '1') + "\n",
        std::string{"JOB 1\x01\n"}}) {
    const WebClient peer = sut.peer();
    peer.send(front + commands);
    const std::string said = all_of(peer);
    CHECK_TEXT(said.empty() || said == "(10)\n", said.c_str());
  }
  LONGS_EQUAL(0, sut.commands());
}

TEST(LineDoors, ASlipOfTheLinesOwnPeerIsToldAndItGoesOn) {
  const TextDoor sut;
  const WebClient peer = sut.peer();
  for (const char* slip : {"\n", "JOB\n", "JOB -1\n", "JOB 1 2\n", "START 99999\n", "STATE \r\n"}) {
    peer.send(slip);
    STRCMP_EQUAL("(10)", line_of(peer).c_str());
  }
  peer.send("STATE\n");
  CHECK(line_of(peer).starts_with("("));
}

TEST(LineDoors, WhatIsNoBeginningEndsWithoutItsLineEnd) {
  for (const char* text : {"GET /", "PO", "PU", "PARTY", "\x16\x03", "Jo", "STATEX", "\x80"})
    CHECK_TEXT(cut(text).garbled, text);
  for (const char* text :
       {"", "S", "STA", "STATE", "JOB", "JOB 1", "P", "PART A-17", "START 7", "BYE", "STATE\r"})
    CHECK_TEXT(!cut(text).garbled, text);
}

TEST(LineDoors, SilentPeersGiveTheirPlaceToAControl) {
  const TextDoor sut;
  const WebClient control = sut.peer();
  control.send("STATE\n");
  CHECK(line_of(control).starts_with("("));
  std::vector<WebClient> silent;
  for (int i = 0; i < 40; ++i) silent.push_back(sut.peer());
  const WebClient later = sut.peer();
  later.send("STATE\n");
  CHECK(line_of(later).starts_with("("));
  // Who asks keeps its place.
  control.send("STATE\n");
  CHECK(line_of(control).starts_with("("));
}

TEST(LineDoors, WhoIsAtWorkGivesWayToNobody) {
  const TextDoor sut;
  std::vector<WebClient> once;
  for (int i = 0; i < 16; ++i) {
    once.push_back(sut.peer());
    once.back().send("STATE\n");
    CHECK(line_of(once.back()).starts_with("("));
  }
  const WebClient turned_away = sut.peer();
  turned_away.send("STATE\n");
  STRCMP_EQUAL("", line_of(turned_away).c_str());
}

}  // namespace biteline::web
