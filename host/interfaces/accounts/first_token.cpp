// SPDX-License-Identifier: MIT
#include "host/interfaces/accounts/first_token.hpp"

#include <sys/stat.h>

#include "common/system/file.hpp"
#include "host/report/report.hpp"

namespace biteline::accounts {
namespace {

constexpr std::size_t k_most_bytes = 200;

}  // namespace

Result<void> offer_first_account(Accounts& accounts, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / k_first_token_file;
  BITELINE_ASSIGN(const bool any, accounts.has_users());
  if (any) {
    std::error_code error;
    std::filesystem::remove(file, error);
    return {};
  }
  BITELINE_ASSIGN(const std::string token, accounts.make_first_token());
  const mode_t before = ::umask(0077);
  Result<void> written = report::write_file_atomically(file, token + "\n");
  ::umask(before);
  return written;
}

std::string read_first_token(const std::filesystem::path& folder) {
  const Result<std::string> text = read_regular_file(folder / k_first_token_file, k_most_bytes);
  return text ? text->substr(0, text->find('\n')) : std::string{};
}

}  // namespace biteline::accounts
