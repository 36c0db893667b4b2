// SPDX-License-Identifier: MIT
#include "host/records/centre_word/centre_word.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/core/text_bounds.hpp"
#include "common/system/file.hpp"
#include "host/report/report.hpp"

namespace biteline::centre_word {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t k_most_bytes = 4 << 20;

std::string text_of(const Json& json, const char* key, std::size_t most_bytes) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? bounds::fitted(found->get<std::string>(), most_bytes)
                                                   : std::string{};
}

std::int64_t whole_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
}

}  // namespace

bool CentreWord::add(DeadLetter letter) {
  const bool known = std::ranges::any_of(
      letters, [&](const DeadLetter& one) { return one.book == letter.book && one.seq == letter.seq; });
  if (known) return false;
  letters.push_back(std::move(letter));
  ++count;
  if (letters.size() > k_most_letters) letters.erase(letters.begin());
  return true;
}

Result<CentreWord> read(const std::filesystem::path& results) {
  CentreWord word;
  const Result<std::string> text = read_regular_file(results / k_file, k_most_bytes);
  if (!text && text.error().code == Errc::FileNotFound) return word;
  if (!text) return tl::unexpected<Error>{text.error()};
  const Json json = Json::parse(*text, nullptr, false);
  const auto letters = json.is_object() ? json.find("letters") : json.end();
  if (!json.is_object() || letters == json.end() || !letters->is_array())
    return fail(Errc::BadFormat, "%.150s: what the centre said cannot be read; remove it, it is written anew",
                (results / k_file).c_str());
  for (const Json& one : *letters) {
    if (!one.is_object() || word.letters.size() >= k_most_letters) continue;
    word.letters.push_back({.book = text_of(one, "book", bounds::k_name),
                            .seq = whole_of(one, "seq"),
                            .scan = text_of(one, "scan", bounds::k_name),
                            .why = text_of(one, "why", bounds::k_title),
                            .time = text_of(one, "time", bounds::k_name)});
  }
  word.count = std::max<std::int64_t>(whole_of(json, "count"), std::ssize(word.letters));
  word.held = text_of(json, "held", bounds::k_title);
  return word;
}

Result<void> write(const std::filesystem::path& results, const CentreWord& word) {
  Json json{{"count", word.count}, {"held", word.held}, {"letters", Json::array()}};
  for (const DeadLetter& one : word.letters)
    json["letters"].push_back(
        {{"book", one.book}, {"seq", one.seq}, {"scan", one.scan}, {"why", one.why}, {"time", one.time}});
  return report::write_file_atomically(results / k_file,
                                       json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace biteline::centre_word
