// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/late_work.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "host/apps/biteline-host/service_words.hpp"

namespace biteline::service {
namespace {

constexpr int k_nice_beside_an_arm = 19;

}  // namespace

void name_thread(const char* name, bool gives_way) {
  pthread_setname_np(pthread_self(), name);
  if (gives_way)
    static_cast<void>(::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), k_nice_beside_an_arm));
}

std::future<Result<void>> begin_beside_arm(std::function<Result<void>()> work) {
  return std::async(std::launch::async, [work = std::move(work)]() -> Result<void> {
    name_thread("bl-pages", true);
    const Result<ExitStatus> done = without_exceptions([&]() -> Result<ExitStatus> {
      if (work) BITELINE_TRY(work());
      return ExitStatus::Done;
    });
    if (!done) return tl::unexpected<Error>{done.error()};
    return {};
  });
}

}  // namespace biteline::service
