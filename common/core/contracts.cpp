// SPDX-License-Identifier: MIT
#include "common/core/contracts.hpp"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "common/core/make_safe.hpp"

namespace biteline {
namespace {

std::atomic<ContractHandler> g_handler{nullptr};

}  // namespace

void set_contract_handler(ContractHandler handler) noexcept {
  g_handler.store(handler);
}

void make_safe(const char* condition, const char* file, int line) noexcept {
  if (ContractHandler handler = g_handler.exchange(nullptr)) handler(condition, file, line);
}

void contract_broken(const char* condition, const char* file, int line) noexcept {
  make_safe(condition, file, line);
  std::fprintf(stderr, "%s:%d: contract broken: %s\n", file, line, condition);
  // A dump of the place, and no last words of others (last_words.hpp).
  std::signal(SIGABRT, SIG_DFL);
  std::abort();
}

}  // namespace biteline
