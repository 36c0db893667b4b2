// SPDX-License-Identifier: MIT
#include "host/apps/biteline/method.hpp"

#include <map>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/published/published_line.hpp"

namespace biteline::app {

void add_method_option(options::Command& command, Method& method) {
  const std::map<std::string, Method> methods{{"default", Method::Default}, {"published", Method::Published}};
  command.add_choice("--method", method, methods, "default, or the published one, for comparison")
      ->type_name("default|published");
}

FoundLine find_line(const cloud::PointCloud& cloud, Method method) {
  if (method == Method::Published) {
    std::optional<published::Workings> workings;
    bite_line::Extraction extraction = published::find_bite_line(cloud.points, {}, &workings);
    return {std::move(extraction), results::stages_of(std::move(workings))};
  }
  std::optional<bite_line::Workings> workings;
  bite_line::Extraction extraction = bite_line::find_bite_line(cloud, {}, &workings);
  return {std::move(extraction), results::stages_of(std::move(workings))};
}

}  // namespace biteline::app
