// SPDX-License-Identifier: MIT
// A model as one file: out of the cell, and in from another.
#include <algorithm>

#include "common/core/base64.hpp"
#include "common/core/text_bounds.hpp"
#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"

namespace biteline::api {

using control::Answer;

namespace {

namespace fs = std::filesystem;

constexpr std::size_t k_most_piece_text = 384 * 1024;

/// The door numbers what it brings: one session may bring several files at once.
std::string owner_of(const control::Request& request) {
  std::string owner = request.token;
  if (const auto number = request.query.find("upload"); number != request.query.end())
    owner.append(1, ':').append(number->second);
  return owner;
}

/// People know no file of the service's own.
Answer told_of_file(const Error& error, const fs::path& file, const fs::path& library) {
  std::string line = to_line(error);
  const auto put = [&line](const std::string& path, const char* words) {
    for (std::size_t at = line.find(path); at != std::string::npos; at = line.find(path, at))
      line.replace(at, path.size(), words);
  };
  put(file.string(), "the file");
  put(library.string(), "the library");
  put("--replace", "replace");
  Answer answer = answer_of(error);
  // What was brought is the door's, not a broken file of the service's.
  const bool of_the_file = error.code == Errc::SizeMismatch || error.code == Errc::FileUnreadable;
  if (of_the_file) answer = control::refusal(400, "bad_request", line);
  answer.body["error"]["message"] = line;
  return answer;
}

}  // namespace

Answer Api::export_model(const Call& call) {
  const std::string& name = call.names.front();
  const Result<fs::path> file = rooms_.exchange.outgoing();
  if (!file) return answer_of(file.error());
  const Result<Catalogue> catalogue = this->catalogue();
  if (!catalogue) return answer_of(catalogue.error());
  if (const Result<void> written = catalogue->models.export_to(name, *file); !written)
    return told_of_file(written.error(), *file, catalogue->models.folder());
  Answer answer;
  answer.type = "application/x-tar";
  answer.file = file->lexically_relative(rooms_.results).string();
  return answer;
}

Answer Api::add_to_import(const Call& call) {
  Fields fields{call.request.body};
  const auto at = fields.number("at", 0, static_cast<double>(Exchange::k_most_bytes));
  const std::optional<std::string> piece = from_base64(fields.text("bytes", k_most_piece_text));
  const bool last = fields.boolean("last").value_or(false);
  const std::string name = fields.text("name", bounds::k_name);
  const bool replace = fields.boolean("replace").value_or(false);
  if (!at) fields.fault("at", "the byte where this piece begins expected");
  if (!piece) fields.fault("bytes", "base64 expected");
  if (!name.empty() && !is_name(name))
    fields.fault("name", "letters, digits, '.', '_', '-', at most 64, expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  Exchange& exchange = rooms_.exchange;
  const std::string owner = owner_of(call.request);
  if (!name.empty() && !replace && rooms_.models.has(name)) {
    exchange.drop(owner);
    return control::refusal(409, "exists", "model " + name + " exists; say replace, or choose another name");
  }
  if (const Result<void> added = exchange.add(owner, static_cast<std::uint64_t>(*at), *piece); !added)
    return answer_of(added.error());
  if (!last) return ok({{"at", static_cast<std::uint64_t>(*at) + piece->size()}});
  const fs::path file = exchange.brought_by(owner);
  const Result<transfer::ModelInfo> model = rooms_.models.import_from(file, name, replace);
  exchange.drop(owner);
  if (!model) {
    Answer told = told_of_file(model.error(), file, rooms_.models.folder());
    // All that is left of wrong arguments: the file's own name is taken.
    if (model.error().code == Errc::InvalidArgument)
      told = control::refusal(409, "exists", told.body["error"]["message"].get<std::string>());
    return told;
  }
  return tell_of_model(call, *model, "import model", "");
}

Answer Api::drop_import(const Call& call) {
  rooms_.exchange.drop(owner_of(call.request));
  return nothing();
}

}  // namespace biteline::api
