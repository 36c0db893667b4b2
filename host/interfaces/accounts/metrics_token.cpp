// SPDX-License-Identifier: MIT
#include "host/interfaces/accounts/metrics_token.hpp"

#include <sys/stat.h>

#include "common/system/file.hpp"
#include "host/interfaces/accounts/secrets.hpp"
#include "host/report/report.hpp"

namespace biteline::accounts {
namespace {

/// A setting of the memory; empty: none was made, or it was dropped.
constexpr const char* k_setting = "metrics_token_hash";
/// Nobody's own word, which could be guessed; and what a header takes.
constexpr std::size_t k_shortest_token = 40, k_longest_token = 128;
constexpr const char* k_letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";

/// A misspelt folder gets no memory of its own.
Result<memory::Memory> opened(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    return fail(Errc::FileNotFound, "%.200s: no accounts there; start its program once", file.c_str());
  return memory::Memory::open(file);
}

Result<std::string> read_token(const std::filesystem::path& file) {
  BITELINE_ASSIGN(std::string text, read_regular_file(file, 2 * k_longest_token));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  if (text.size() >= k_shortest_token && text.size() <= k_longest_token &&
      text.find_first_not_of(k_letters) == std::string::npos)
    return text;
  return fail(Errc::BadFormat,
              "%.200s: no token (%zu to %zu letters and digits); remove it, and a new one is made",
              file.c_str(), k_shortest_token, k_longest_token);
}

Result<std::string> token_of(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::exists(file, error)) return read_token(file);
  BITELINE_ASSIGN(std::string token, make_token());
  const mode_t before = ::umask(0077);
  const Result<void> written = report::write_file_atomically(file, token + "\n");
  ::umask(before);
  BITELINE_TRY(written);
  return token;
}

Result<void> put_hash(memory::Memory& memory, const std::string& hash, const char* action) {
  return memory.put_setting(k_setting, hash,
                            {.id = 0,
                             .time = memory::now_ms(),
                             .who = "cell",
                             .door = "command line",
                             .action = action,
                             .subject = "metrics",
                             .before = {},
                             .after = {}});
}

}  // namespace

Result<void> use_metrics_token(const std::filesystem::path& memory, const std::filesystem::path& token_file) {
  BITELINE_ASSIGN(memory::Memory kept, opened(memory));
  // A file that cannot be read or written costs nobody the token that works.
  BITELINE_ASSIGN(const std::string token, token_of(token_file));
  return put_hash(kept, hash_token(token), "make metrics token");
}

Result<void> drop_metrics_token(const std::filesystem::path& memory) {
  BITELINE_ASSIGN(memory::Memory kept, opened(memory));
  BITELINE_ASSIGN(const std::optional<std::string> hash, kept.setting(k_setting));
  if (!hash || hash->empty())
    return fail(Errc::FileNotFound, "%.200s: a metrics token was never made", memory.c_str());
  return put_hash(kept, {}, "drop metrics token");
}

Result<bool> may_read_metrics(const memory::Memory& memory, const Accounts& accounts,
                              const std::string& token) {
  if (token.empty()) return false;
  BITELINE_ASSIGN(const std::optional<std::string> hash, memory.setting(k_setting));
  if (hash && !hash->empty() && hash_token(token) == *hash) return true;
  BITELINE_ASSIGN(const std::optional<Person> person, accounts.who_is(token));
  return person.has_value();
}

}  // namespace biteline::accounts
