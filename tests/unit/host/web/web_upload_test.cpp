// SPDX-License-Identifier: MIT
// A model's file: in by pieces to the service, out by the name that the service gives.
#include <CppUTest/TestHarness.h>

#include "common/core/base64.hpp"
#include "tests/unit/host/web/running_server.hpp"

namespace biteline::web {

TEST_GROUP(WebUpload){static std::string upload(const std::string& body, const std::string& query = "",
                                                const std::string& type = "application/x-tar"){
    return "POST /api/v1/model-files" + query + " HTTP/1.1\r\nHost: localhost\r\n" + k_session +
           "Content-Type: " + type + "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}
/// What the service was brought, put together; the pieces' own fields are checked.
static std::string brought(const std::vector<control::Request>& asked) {
  std::string all;
  bool ended = false;
  for (const control::Request& request : asked) {
    if (request.path != "/api/v1/exchange/model" || request.method != "POST") continue;
    LONGS_EQUAL(all.size(), request.body["at"].get<std::size_t>());
    CHECK_FALSE(ended);
    ended = request.body["last"].get<bool>();
    CHECK(control::to_text(request).size() < control::k_most_message_bytes);
    const auto piece = from_base64(request.body["bytes"].get<std::string>());
    CHECK(piece.has_value());
    all += *piece;
  }
  CHECK(ended);
  return all;
}
}
;

TEST(WebUpload, AFileLargerThanABodyComesWholeAndTheConnectionStays) {
  const RunningServer sut;
  std::string file;
  for (int i = 0; i < 1'000'000; ++i) file += static_cast<char>(i * 7 + i / 1000);
  WebClient client = sut.client();
  client.send(upload(file, "?name=boot&replace=true"));
  const WebReply reply = client.receive();
  LONGS_EQUAL_TEXT(201, reply.status, reply.body.c_str());
  CHECK(brought(sut.service->asked()) == file);
  const control::Request first = sut.service->asked().front();
  STRCMP_EQUAL("boot", first.body["name"].get<std::string>().c_str());
  CHECK(first.body["replace"].get<bool>());
  STRCMP_EQUAL("viewer-token", first.token.c_str());
  LONGS_EQUAL(200, client.ask("GET", "/api/v1/state", k_session).status);
}

TEST(WebUpload, ChunksAndPiecesOfAnySizeAreTheSameFile) {
  const RunningServer sut;
  for (const std::size_t size : {std::size_t{1}, std::size_t{192 * 1024}, std::size_t{2 * 192 * 1024}}) {
    WebClient client = sut.client();
    client.send("POST /api/v1/model-files HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n" +
                k_session + "Content-Type: application/octet-stream\r\n\r\n");
    const std::size_t before = sut.asked();
    const std::string file(size, 'x');
    char length[20];
    std::snprintf(length, sizeof length, "%zx\r\n", size);
    client.send(length + file + "\r\n0\r\n\r\n");
    LONGS_EQUAL(201, client.receive().status);
    const std::vector<control::Request> asked = sut.service->asked();
    CHECK(brought({asked.begin() + static_cast<long>(before), asked.end()}) == file);
  }
}

TEST(WebUpload, TheServicesRefusalIsReadByTheClient) {
  const RunningServer sut;
  WebClient client = sut.client();
  client.send(upload(std::string(3'000'000, 'x'), "?name=taken"));
  check_refused(409, "exists", client.receive());
  // One piece was asked about; the rest was read and thrown away.
  LONGS_EQUAL(1, sut.asked());
  LONGS_EQUAL(200, client.ask("GET", "/api/v1/state", k_session).status);
}

TEST(WebUpload, WhatIsNoFileOrTooMuchIsRefusedBeforeItIsRead) {
  const RunningServer sut{{.upload_bytes = 400'000}};
  check_refused(415, "wrong_type", [&] {
    WebClient client = sut.client();
    client.send(upload("{}", "", "application/json"));
    return client.receive();
  }());
  check_refused(413, "too_large", [&] {
    WebClient client = sut.client();
    client.send(upload(std::string(400'001, 'x')));
    return client.receive();
  }());
  check_refused(401, "login_needed",
                sut.client().ask("POST", "/api/v1/model-files", "Content-Type: application/x-tar\r\n"));
  check_refused(400, "bad_request", [&] {
    WebClient client = sut.client();
    client.send(upload(""));
    return client.receive();
  }());
  LONGS_EQUAL(0, sut.asked());
  sut.check_alive();
}

TEST(WebUpload, WhoStopsIsToldAndTheServiceForgetsThePieces) {
  const RunningServer sut{{.request_time = std::chrono::milliseconds{300}}};
  WebClient client = sut.client();
  const std::string all = upload(std::string(500'000, 'x'));
  client.send(all.substr(0, 300'000));
  check_refused(408, "too_slow", client.receive());
  STRCMP_EQUAL("DELETE", sut.service->asked().back().method.c_str());
  sut.check_alive();
}

TEST(WebUpload, AnAnswerThatIsAFileIsSentWithItsName) {
  const RunningServer sut;
  sut.folder.write("results/.exchange/out-1.tar", "the archive");
  const WebReply reply = sut.get("/api/v1/models/boot/file");
  LONGS_EQUAL_TEXT(200, reply.status, reply.body.c_str());
  STRCMP_EQUAL("the archive", reply.body.c_str());
  STRCMP_EQUAL("application/x-tar", reply.header("content-type").c_str());
  STRCMP_EQUAL("attachment; filename=\"boot.tar\"", reply.header("content-disposition").c_str());
  check_refused(503, "host_away", sut.get("/api/v1/models/gone/file"));
  check_refused(503, "host_away", sut.get("/api/v1/models/outside/file"));
}

}  // namespace biteline::web
