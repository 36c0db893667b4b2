// SPDX-License-Identifier: MIT
#include "common/system/last_words.hpp"

#include <cxxabi.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>
#include <typeinfo>

#include "common/core/error.hpp"
#include "common/core/make_safe.hpp"
#include "common/system/journal.hpp"

namespace biteline {
namespace {

const char* g_program = "biteline";

void say(const char* words) noexcept {
  // Not printf: there may be no memory for its buffer.
  [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, words, std::strlen(words));
}

[[noreturn]] void end_with_words() noexcept {
  make_safe("terminate", __FILE__, __LINE__);
  const std::type_info* thrown = abi::__cxa_current_exception_type();
  say(g_program);
  if (thrown != nullptr && *thrown == typeid(std::bad_alloc)) {
    say(": out of memory: raise the limit or free some, then start again\n");
  } else if (thrown != nullptr && *thrown == typeid(std::system_error)) {
    say(": the system gives no more threads or memory: raise the limits, then start again\n");
  } else {
    say(": internal failure: ");
    say(thrown != nullptr ? thrown->name() : "terminated");
    say(": report this as a defect\n");
  }
  ::_exit(static_cast<int>(ExitStatus::Connection));
}

/// libzmq gives up by abort() where it gets no memory or no thread, and says so in a line of its own.
[[noreturn]] void end_of_a_library(int) noexcept {
  make_safe("abort", __FILE__, __LINE__);
  say(g_program);
  say(": a library gave up, mostly for want of memory or threads: raise the limits, then start again\n");
  ::_exit(static_cast<int>(ExitStatus::Connection));
}

}  // namespace

void install_last_words(const char* program) noexcept {
  g_program = program;
  mark_for_journal();
  std::set_terminate(end_with_words);
  std::signal(SIGABRT, end_of_a_library);
}

}  // namespace biteline
