// SPDX-License-Identifier: MIT
#include "common/system/last_words.hpp"

#include <CppUTest/TestHarness.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

#include "common/core/contracts.hpp"

namespace biteline {
namespace {

struct Ending {
  int status{-1};
  int signal{0};
  std::string words;
};

/// A child that installs the last words and then does what kills it.
Ending ending_of(const std::function<void()>& deadly) {
  int ends[2];
  CHECK(::pipe(ends) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(ends[1], STDERR_FILENO);
    install_last_words("biteline-test");
    deadly();
    ::_exit(0);
  }
  ::close(ends[1]);
  Ending ending;
  char letter = 0;
  while (::read(ends[0], &letter, 1) == 1) ending.words += letter;
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status)) ending.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ending.signal = WTERMSIG(status);
  return ending;
}

}  // namespace

TEST_GROUP(LastWords){};

TEST(LastWords, NoMemoryInAnyThreadIsOneLineAndStatusFour) {
  const Ending sut = ending_of([] { std::thread{[] { throw std::bad_alloc{}; }}.join(); });
  LONGS_EQUAL(4, sut.status);
  STRCMP_EQUAL("biteline-test: out of memory: raise the limit or free some, then start again\n",
               sut.words.c_str());
}

TEST(LastWords, NoThreadAndWhateverElseAreOneLineToo) {
  const Ending sut = ending_of([] {
    std::thread{[] { throw std::system_error{EAGAIN, std::generic_category()}; }}.join();
  });
  LONGS_EQUAL(4, sut.status);
  STRCMP_CONTAINS("no more threads or memory", sut.words.c_str());
  const Ending other = ending_of([] { std::thread{[] { throw std::logic_error{"x"}; }}.join(); });
  LONGS_EQUAL(4, other.status);
  STRCMP_CONTAINS("report this as a defect\n", other.words.c_str());
}

TEST(LastWords, LibraryThatAbortsIsOneLineToo) {
  const Ending sut = ending_of([] { std::thread{[] { std::abort(); }}.join(); });
  LONGS_EQUAL(4, sut.status);
  STRCMP_EQUAL(
      "biteline-test: a library gave up, mostly for want of memory or threads: raise the limits, then start "
      "again\n",
      sut.words.c_str());
}

TEST(LastWords, BrokenContractStillEndsByItsSignal) {
  const Ending sut = ending_of([] {
    const rlimit no_dump{};
    ::setrlimit(RLIMIT_CORE, &no_dump);
    BITELINE_EXPECTS(1 + 1 == 3);
  });
  LONGS_EQUAL(SIGABRT, sut.signal);
  STRCMP_CONTAINS("contract broken", sut.words.c_str());
}

TEST(LastWords, MachineIsMadeSafeFirst) {
  const Ending sut = ending_of([] {
    set_contract_handler([](const char*, const char*, int) noexcept {
      [[maybe_unused]] const auto ignored = ::write(STDERR_FILENO, "dark ", 5);
    });
    std::thread{[] { throw std::bad_alloc{}; }}.join();
  });
  STRCMP_CONTAINS("dark biteline-test: out of memory", sut.words.c_str());
}

}  // namespace biteline
