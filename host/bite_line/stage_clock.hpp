// SPDX-License-Identifier: MIT
#pragma once
/// \file Wall time of the extraction's stages.

#include <chrono>
#include <vector>

#include "host/bite_line/extract.hpp"

namespace biteline::bite_line {

class StageClock {
 public:
  StageClock(std::vector<Stage>& stages, const StageCallback& on_stage)
      : stages_{stages}, on_stage_{on_stage} {}

  template <class Work>
  auto run(const char* name, Work&& work) {
    if (on_stage_) on_stage_(name);
    const auto begin = std::chrono::steady_clock::now();
    auto result = work();
    stages_.push_back(
        {name, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
    return result;
  }

 private:
  std::vector<Stage>& stages_;
  const StageCallback& on_stage_;
};

}  // namespace biteline::bite_line
