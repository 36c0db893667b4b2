// SPDX-License-Identifier: MIT
#include "host/interfaces/accounts/metrics_token.hpp"

#include <CppUTest/TestHarness.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::accounts {

TEST_GROUP(MetricsToken) {
  test::TemporaryFolder folder;
  std::filesystem::path file{folder.path() / memory::k_memory_file};
  std::filesystem::path token_file{folder.path() / "metrics.token"};
  // As a service that runs has it open.
  Result<memory::Memory> memory{memory::Memory::open(file)};
  Accounts sut{*memory};

  std::string token() const {
    std::ifstream stream{token_file};
    std::string text;
    stream >> text;
    return text;
  }
  bool may(const std::string& token) const {
    const Result<bool> answer = may_read_metrics(*memory, sut, token);
    SUCCEEDS(answer);
    return *answer;
  }
};

TEST(MetricsToken, ReadsMetricsWhileTheServiceRunsAndIsNobody) {
  CHECK_FALSE(may(""));
  SUCCEEDS(use_metrics_token(file, token_file));
  CHECK(may(token()));
  CHECK_FALSE(may(token() + "0"));
  CHECK_FALSE(may(""));
  const auto person = sut.who_is(token());
  SUCCEEDS(person);
  CHECK_FALSE(person->has_value());
  struct stat facts {};
  LONGS_EQUAL(0, ::stat(token_file.c_str(), &facts));
  LONGS_EQUAL(0600, facts.st_mode & 0777);
}

TEST(MetricsToken, OneFileServesManyCellsAndANewOneEndsTheOld) {
  SUCCEEDS(use_metrics_token(file, token_file));
  const std::string first = token();
  SUCCEEDS(use_metrics_token(file, token_file));
  STRCMP_EQUAL(first.c_str(), token().c_str());
  CHECK(may(first));
  std::filesystem::remove(token_file);
  SUCCEEDS(use_metrics_token(file, token_file));
  CHECK(token() != first);
  CHECK(may(token()));
  CHECK_FALSE(may(first));
}

TEST(MetricsToken, DroppedItOpensNothing) {
  FAILS_NAMING(Errc::FileNotFound, "never made", drop_metrics_token(file));
  SUCCEEDS(use_metrics_token(file, token_file));
  SUCCEEDS(drop_metrics_token(file));
  CHECK_FALSE(may(token()));
  CHECK_FALSE(may(""));
  FAILS_NAMING(Errc::FileNotFound, "never made", drop_metrics_token(file));
}

TEST(MetricsToken, NoFileOfAnotherKindIsTaken) {
  SUCCEEDS(use_metrics_token(file, token_file));
  const std::string first = token();
  for (const std::string& text :
       {std::string{}, std::string{"secret\n"}, std::string(64, '.'), std::string(39, 'a')}) {
    FAILS_NAMING(Errc::BadFormat, "other.token", use_metrics_token(file, folder.write("other.token", text)));
  }
  CHECK(!use_metrics_token(file, folder.path() / "none/metrics.token"));
  CHECK(may(first));
  const std::filesystem::path misspelt = folder.path() / "misspelt.sqlite";
  FAILS_NAMING(Errc::FileNotFound, "misspelt", use_metrics_token(misspelt, token_file));
  CHECK_FALSE(std::filesystem::exists(misspelt));
}

TEST(MetricsToken, WhoMadeItStandsInTheLogAndItselfDoesNot) {
  SUCCEEDS(use_metrics_token(file, token_file));
  const auto rows = memory->log_rows(0, 10);
  SUCCEEDS(rows);
  STRCMP_EQUAL("make metrics token", rows->front().action.c_str());
  for (const memory::LogRow& row : *rows) {
    CHECK(row.before.find(token()) == std::string::npos);
    CHECK(row.after.find(token()) == std::string::npos);
  }
}

}  // namespace biteline::accounts
