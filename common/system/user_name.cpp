// SPDX-License-Identifier: MIT
#include "common/system/user_name.hpp"

#include <pwd.h>
#include <unistd.h>

namespace biteline {

std::string user_name() {
  passwd entry{};
  passwd* found = nullptr;
  char buffer[1024];
  if (getpwuid_r(::getuid(), &entry, buffer, sizeof buffer, &found) == 0 && found != nullptr)
    return found->pw_name;
  return "user " + std::to_string(::getuid());
}

}  // namespace biteline
