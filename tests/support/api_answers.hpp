// SPDX-License-Identifier: MIT
#pragma once
/// \file Notes each answer of the API, for tests/web/check_api_answers.py to hold against openapi.yaml.

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/json.hpp"

namespace biteline::test {

/// One line of JSON at the end of the file that BITELINE_API_ANSWERS names; without it nothing is noted.
/// `path` is the API's own, after /api/v1; an empty one says that any path may answer so.
inline void note_answer(const std::string& method, const std::string& path, int status,
                        const std::string& type, const nlohmann::ordered_json& body) {
  const char* const file = std::getenv("BITELINE_API_ANSWERS");
  if (file == nullptr) return;
  const nlohmann::ordered_json line{
      {"method", method}, {"path", path}, {"status", status}, {"type", type}, {"body", body}};
  std::ofstream{file, std::ios::app} << test::text_of(line) << '\n';
}

}  // namespace biteline::test
