// SPDX-License-Identifier: MIT
#include "host/interfaces/line_control/jobs.hpp"

#include "common/config/yaml_reader.hpp"
#include "common/core/text_bounds.hpp"

namespace biteline::line_control {

Result<std::vector<Job>> read_jobs(const std::filesystem::path& file) {
  BITELINE_ASSIGN(auto reader, config::YamlReader::open(file));
  std::vector<Job> jobs;
  {
    config::YamlReader table = reader.child("jobs", true);
    for (int number = 1; number <= k_most_jobs; ++number) {
      const std::string key = std::to_string(number);
      if (!table.has(key)) continue;
      config::YamlReader job = table.child(key, true);
      jobs.push_back({.number = number,
                      .model = job.text_or("model", ""),
                      .process = job.text_or("process", ""),
                      .foot = job.text_or("foot", ""),
                      .size = job.text_or("size", "")});
      const Job& last = jobs.back();
      if (!last.foot.empty() && last.foot != "left" && last.foot != "right")
        job.fault(Errc::BadValue, "foot", "left or right expected");
      if (!bounds::fits(last.size, bounds::k_size))
        job.fault(Errc::BadValue, "size", bounds::expected(bounds::k_size));
    }
  }
  if (jobs.empty()) reader.fault(Errc::BadValue, "jobs", "at least one number from 1 to 999 expected");
  BITELINE_TRY(reader.finish());
  return jobs;
}

}  // namespace biteline::line_control
