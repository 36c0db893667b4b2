// SPDX-License-Identifier: MIT
#include "host/interfaces/accounts/accounts.hpp"

#include <CppUTest/TestHarness.h>

#include "host/interfaces/accounts/secrets.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::accounts {
namespace {

using namespace std::chrono_literals;

constexpr const char* k_password = "a long password";

}  // namespace

TEST_GROUP(Accounts) {
  test::TemporaryFolder folder;
  Result<memory::Memory> memory{memory::Memory::open(folder.path() / memory::k_memory_file)};
  Accounts sut{*memory};

  void add_admin() {
    SUCCEEDS(sut.add("ada", Role::Administrator, k_password, "ada", "web"));
  }
  std::string token_of(const std::string& name) {
    const auto login = sut.log_in(name, k_password, "web");
    SUCCEEDS(login);
    CHECK(login->has_value());
    return (*login)->token;
  }
};

TEST(Accounts, PasswordIsKeptAsArgon2idWithItsSettings) {
  const auto hash = hash_password(k_password);
  SUCCEEDS(hash);
  STRCMP_CONTAINS("$argon2id$v=19$m=19456,t=2,p=1$", hash->c_str());
  CHECK(is_password(k_password, *hash));
  CHECK(!is_password("another password", *hash));
  CHECK(!is_password(k_password, "no hash"));
  CHECK(*hash != *hash_password(k_password));  // salted
}

TEST(Accounts, TokensAreRandomAndKeptHashed) {
  const auto token = make_token();
  SUCCEEDS(token);
  LONGS_EQUAL(64, token->size());
  CHECK(*token != *make_token());
  CHECK(hash_token(*token) == hash_token(*token));
  CHECK(hash_token(*token) != *token);
  LONGS_EQUAL(64, hash_token("x").size());
}

TEST(Accounts, FirstAccountIsAnAdministrators) {
  CHECK(!*sut.has_users());
  FAILS_NAMING(Errc::InvalidArgument, "administrator",
               sut.add("ana", Role::Operator, k_password, "ana", "web"));
  add_admin();
  SUCCEEDS(sut.add("ana", Role::Operator, k_password, "ada", "web"));
  FAILS_NAMING(Errc::InvalidArgument, "exists", sut.add("ana", Role::Operator, k_password, "ada", "web"));
  for (const char* name : {"", "two words", "a/b", "service", "guest", "\xc3\xa4"})
    FAILS_NAMING(Errc::InvalidArgument, "name", sut.add(name, Role::Viewer, k_password, "ada", "web"));
  FAILS_NAMING(Errc::InvalidArgument, "password", sut.add("bob", Role::Viewer, "short", "ada", "web"));
}

TEST(Accounts, LoginGivesASessionThatLogoutEnds) {
  add_admin();
  const std::string token = token_of("ada");
  const auto person = sut.who_is(token);
  SUCCEEDS(person);
  STRCMP_EQUAL("ada", (*person)->name.c_str());
  CHECK((*person)->role == Role::Administrator);
  CHECK(!sut.who_is("")->has_value());
  CHECK(!sut.who_is(token + "0")->has_value());
  SUCCEEDS(sut.log_out(token, "web"));
  CHECK(!sut.who_is(token)->has_value());
}

TEST(Accounts, FailedLoginsSlowDownByName) {
  add_admin();
  auto now = Accounts::Clock::now();
  int waits = 0;
  for (int i = 0; i < 6; ++i) {
    auto tried = sut.log_in("ada", "wrong password", "web", now);
    SUCCEEDS(tried);
    CHECK(!tried->has_value());
    if (tried->error().too_often) {
      ++waits;
      CHECK(tried->error().wait_s >= 2);
      // The right password waits, too.
      CHECK(!sut.log_in("ada", k_password, "web", now)->has_value());
      now += std::chrono::seconds{tried->error().wait_s};
    }
  }
  LONGS_EQUAL(1, waits > 0);
  now += 61s;
  CHECK(sut.log_in("ada", k_password, "web", now)->has_value());
  CHECK(!sut.log_in("nobody", k_password, "web", now)->has_value());
}

TEST(Accounts, LastAdministratorStays) {
  add_admin();
  FAILS_NAMING(Errc::InvalidArgument, "last administrator", sut.remove("ada", "ada", "web"));
  FAILS_NAMING(Errc::InvalidArgument, "last administrator",
               sut.change("ada", {.role = Role::Viewer}, "ada", "web"));
  FAILS_NAMING(Errc::InvalidArgument, "last administrator",
               sut.change("ada", {.enabled = false}, "ada", "web"));
  SUCCEEDS(sut.add("eve", Role::Administrator, k_password, "ada", "web"));
  SUCCEEDS(sut.remove("ada", "eve", "web"));
  FAILS_NAMING(Errc::FileNotFound, "ada", sut.remove("ada", "eve", "web"));
}

TEST(Accounts, ChangedPasswordEndsOldSessions) {
  add_admin();
  const std::string token = token_of("ada");
  SUCCEEDS(sut.change("ada", {.password = "quite another one"}, "ada", "web"));
  CHECK(!sut.who_is(token)->has_value());
  CHECK(!sut.log_in("ada", k_password, "web")->has_value());
  CHECK(sut.log_in("ada", "quite another one", "web")->has_value());
}

TEST(Accounts, ClosedAccountDoesNotLogIn) {
  add_admin();
  SUCCEEDS(sut.add("ana", Role::Operator, k_password, "ada", "web"));
  const std::string token = token_of("ana");
  SUCCEEDS(sut.change("ana", {.enabled = false}, "ada", "web"));
  CHECK(!sut.who_is(token)->has_value());
  CHECK(!sut.log_in("ana", k_password, "web")->has_value());
  SUCCEEDS(sut.change("ana", {.enabled = true}, "ada", "web"));
  CHECK(sut.log_in("ana", k_password, "web")->has_value());
}

TEST(Accounts, GuestTokenOpensOneViewersSession) {
  const auto token = sut.make_guest_token();
  SUCCEEDS(token);
  CHECK(!sut.use_guest_token("wrong", "web")->has_value());
  const auto login = sut.use_guest_token(*token, "web");
  SUCCEEDS(login);
  CHECK((*login)->person.role == Role::Viewer);
  CHECK(sut.who_is((*login)->token)->has_value());
  CHECK(!sut.use_guest_token(*token, "web")->has_value());
}

TEST(Accounts, ControlHasOneHolderAndIsHandedOver) {
  add_admin();
  SUCCEEDS(sut.add("ana", Role::Operator, k_password, "ada", "web"));
  SUCCEEDS(sut.add("vic", Role::Viewer, k_password, "ada", "web"));
  CHECK(!sut.holder());
  SUCCEEDS(sut.take_control("ada", "web"));
  FAILS_NAMING(Errc::NoRights, "ana", sut.release_control("ana", "web"));
  FAILS_NAMING(Errc::InvalidArgument, "operate", sut.give_control("ada", "vic", "web"));
  SUCCEEDS(sut.give_control("ada", "ana", "web"));
  STRCMP_EQUAL("ana", sut.holder()->name.c_str());
  SUCCEEDS(sut.take_control("ada", "web"));
  SUCCEEDS(sut.release_control("ada", "web"));
  CHECK(!sut.holder());
}

TEST(Accounts, EveryChangeIsInTheLogAndNoPassword) {
  add_admin();
  static_cast<void>(token_of("ada"));
  static_cast<void>(sut.log_in("ada", "my wrong password", "web"));
  SUCCEEDS(sut.take_control("ada", "web"));
  const auto rows = memory->log_rows(0, 100);
  SUCCEEDS(rows);
  std::string all;
  for (const memory::LogRow& row : *rows)
    all += row.action + "|" + row.who + "|" + row.subject + "|" + row.before + "|" + row.after + "\n";
  STRCMP_EQUAL(
      "take control|ada|control||ada\nlogin failed|ada|ada||\nlogin|ada|ada||\nadd "
      "user|ada|ada||administrator\n",
      all.c_str());
}

TEST(Accounts, ASessionThatHasEndedStaysSoWhateverTheClockIsSetTo) {
  constexpr memory::UnixMs k_hour = 3'600'000;
  memory::UnixMs wall = 1'795'000'000'000;
  Accounts clocked{*memory, [&wall] { return wall; }};
  add_admin();
  const auto login = clocked.log_in("ada", k_password, "web");
  SUCCEEDS(login);
  const std::string token = (*login)->token;
  const auto lives = [&](const Accounts& accounts) {
    const auto person = accounts.who_is(token);
    SUCCEEDS(person);
    return person->has_value();
  };
  wall += 11 * k_hour;
  CHECK(lives(clocked));
  // Seconds back, as a network's time does: nobody is thrown out.
  wall -= 5000;
  CHECK(lives(clocked));
  wall += 2 * k_hour;
  CHECK(!lives(clocked));
  for (const memory::UnixMs back : {k_hour, 3 * k_hour, 12 * k_hour, 24 * 365 * k_hour}) {
    wall -= back;
    CHECK(!lives(clocked));
  }
  // A service that begins anew with a clock before the session's beginning does not know when it ends.
  const Accounts later{*memory, [&wall] { return wall; }};
  CHECK(!lives(later));
  // And whoever logs in by the mended clock gets in.
  const auto again = clocked.log_in("ada", k_password, "web");
  SUCCEEDS(again);
  const auto person = clocked.who_is((*again)->token);
  SUCCEEDS(person);
  CHECK(person->has_value());
}

TEST(Accounts, NobodyIsCalledAsAProgramOrTheCentre) {
  for (const char* name : {"service", "guest", "fleet", "host"}) {
    FAILS_NAMING(Errc::InvalidArgument, name, sut.add(name, Role::Administrator, k_password, "x", "web"));
  }
  SUCCEEDS(sut.add("hosts", Role::Administrator, k_password, "x", "web"));
}

/// Whoever shall make room on a full disk has to get in first.
TEST(Accounts, AFullDiskKeepsNobodyOut) {
  add_admin();
  const std::string kept = token_of("ada");
  std::string token;
  {
    const test::FullDisk full;
    const auto wrong = sut.log_in("ada", "my wrong password", "web");
    SUCCEEDS(wrong);
    CHECK(!wrong->has_value());
    const auto login = sut.log_in("ada", k_password, "web");
    SUCCEEDS(login);
    CHECK(login->has_value());
    CHECK((*login)->not_kept.has_value());
    STRCMP_CONTAINS("disk full", to_line(*(*login)->not_kept).c_str());
    CHECK((*login)->not_kept->code == Errc::DiskFull);
    token = (*login)->token;
    CHECK(sut.who_is(token)->has_value());
    CHECK(sut.known(token).has_value());
    // Whose session stands in the memory leaves here, and is told what a restart would do.
    FAILS_NAMING(Errc::DiskFull, "", sut.log_out(kept, "web"));
    CHECK(!sut.who_is(kept)->has_value());
    CHECK(!sut.known(kept).has_value());
    CHECK(Accounts{*memory}.who_is(kept)->has_value());
    // And another such session, which the memory never had, leaves for good.
    const auto second = sut.log_in("ada", k_password, "web");
    SUCCEEDS(sut.log_out((*second)->token, "web"));
    CHECK(!sut.who_is((*second)->token)->has_value());
  }
  // It lives on here, and not in a program that begins anew.
  CHECK(sut.who_is(token)->has_value());
  CHECK(!Accounts{*memory}.who_is(token)->has_value());
  // The next login that finds room makes up for what was not kept.
  const auto login = sut.log_in("ada", k_password, "web");
  SUCCEEDS(login);
  CHECK(!(*login)->not_kept);
  CHECK(!Accounts{*memory}.who_is(kept)->has_value());
  // An account that is closed takes such a session with it.
  SUCCEEDS(sut.add("bob", Role::Administrator, k_password, "ada", "web"));
  SUCCEEDS(sut.change("ada", {.role = {}, .password = {}, .enabled = false}, "bob", "web"));
  CHECK(!sut.who_is(token)->has_value());
}

}  // namespace biteline::accounts
