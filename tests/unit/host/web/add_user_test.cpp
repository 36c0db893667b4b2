// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/add_user.hpp"

#include <CppUTest/TestHarness.h>

#include "host/interfaces/accounts/accounts.hpp"
#include "host/interfaces/accounts/first_token.hpp"
#include "host/interfaces/control/server.hpp"
#include "host/records/memory/memory.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::web {

TEST_GROUP(AddUser) {
  test::TemporaryFolder folder;
  AddUserRequest request{
      .name = "ada", .role = "administrator", .out = folder.path(), .control = {}, .control_keys = {}};
};

TEST(AddUser, TheAccountLogsIn) {
  SUCCEEDS(add_user(request, "correct horse"));
  auto memory = memory::Memory::open(folder.path() / memory::k_memory_file);
  SUCCEEDS(memory);
  accounts::Accounts accounts{*memory};
  const auto login = accounts.log_in("ada", "correct horse", "web");
  SUCCEEDS(login);
  CHECK(login->has_value());
  CHECK((*login)->person.role == accounts::Role::Administrator);
  const auto wrong = accounts.log_in("ada", "correct hors", "web");
  CHECK(wrong && !wrong->has_value());
}

TEST(AddUser, WhatIsWrongIsTold) {
  FAILS_NAMING(Errc::InvalidArgument, "", add_user(request, "short"));
  request.role = "king";
  FAILS_NAMING(Errc::InvalidArgument, "--role king", add_user(request, "correct horse"));
  request.role = "viewer";
  CHECK_TEXT(!add_user(request, "correct horse"), "the first account must be an administrator's");
}

TEST(AddUser, APasswordIsOneLineOfBoundedLength) {
  const auto read = [this](const std::string& text) {
    const auto file = folder.write("input", text);
    std::FILE* input = std::fopen(file.c_str(), "r");
    auto password = read_password(input);
    std::fclose(input);
    return password;
  };
  STRCMP_EQUAL("correct horse", read("correct horse\nmore").value().c_str());
  FAILS_NAMING(Errc::BadValue, "200", read(std::string(100'000, 'x')));
}

TEST(AddUser, ARunningServiceIsAsked) {
  control::Request asked;
  int status = 201;
  const auto server = control::Server::open(
      {.endpoint = {.host = "127.0.0.1", .port = 0},
       .keys = {},
       .hello = {{"accounts", folder.path().string()}}},
      {.urgent = {}, .ordinary = [&](const control::Request& question) {
         asked = question;
         return status == 201 ? control::Answer{.id = 0, .status = 201, .body = {}}
                              : control::refusal(403, "not_allowed", "an administrator makes the next");
       }});
  SUCCEEDS(server);
  request.control = *wire::parse_endpoint((*server)->address());
  SUCCEEDS(add_user(request, "correct horse"));
  STRCMP_EQUAL("/api/v1/users", asked.path.c_str());
  STRCMP_EQUAL("ada", asked.body["name"].get<std::string>().c_str());
  CHECK(asked.local);
  // What only the service's own user can read.
  CHECK(asked.token.empty());
  folder.write(accounts::k_first_token_file, "the token\n");
  SUCCEEDS(add_user(request, "correct horse"));
  STRCMP_EQUAL("the token", asked.token.c_str());
  status = 403;
  FAILS_NAMING(Errc::PeerRefused, "an administrator makes the next", add_user(request, "correct horse"));
  CHECK(to_line(add_user(request, "correct horse").error()).find("real time") == std::string::npos);
}

}  // namespace biteline::web
