// SPDX-License-Identifier: MIT
#include "common/options/command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace biteline::options {
namespace {

template <typename Words>
std::optional<Leave> taken(CLI::App& app, const Words& parse) {
  try {
    parse();
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return Leave{.fault = error.what()};
    app.exit(error);  // prints what was asked for
    return Leave{};
  } catch (const Unfit& unfit) {
    return Leave{.fault = unfit.what()};
  }
}

}  // namespace

Option* Option::required(bool is) {
  parser_->required(is);
  return this;
}

Option* Option::check(const Check& check) {
  parser_->check(check.rule());
  return this;
}

Option* Option::needs(const Option* other) {
  parser_->needs(other->parser_);
  return this;
}

Option* Option::excludes(const Option* other) {
  parser_->excludes(other->parser_);
  return this;
}

Option* Option::type_name(const std::string& shown) {
  parser_->type_name(shown);
  return this;
}

Option* Option::capture_default_str() {
  parser_->capture_default_str();
  return this;
}

Option* Option::default_str(const std::string& shown) {
  parser_->default_str(shown);
  return this;
}

Option* Option::expected(int count) {
  parser_->expected(count);
  return this;
}

Option* Option::expected(int least, int most) {
  parser_->expected(least, most);
  return this;
}

Option* Option::delimiter(char between) {
  parser_->delimiter(between);
  return this;
}

Option* Option::take_all() {
  parser_->take_all();
  return this;
}

Option* Option::allow_extra_args(bool are) {
  parser_->allow_extra_args(are);
  return this;
}

std::size_t Option::count() const {
  return parser_->count();
}

std::string Option::name() const {
  return parser_->get_name();
}

Command::Command(const std::string& what_it_does, const std::string& name)
    : own_{std::make_unique<CLI::App>(what_it_does, name)}, parser_{own_.get()} {}

Command::Command(CLI::App* parser) : parser_{parser} {}

Command::~Command() = default;

Option* Command::add(CLI::Option* parser) {
  return &options_.emplace_back(parser);
}

Option* Command::add_value(const std::string& names, Value value, const std::string& help) {
  return std::visit([&](auto* target) { return add(parser_->add_option(names, *target, help)); }, value);
}

Option* Command::add_chosen(const std::string& names, std::function<void(int)> take,
                            const std::map<std::string, int>& choices, const std::string& help) {
  return add(parser_->add_option_function<int>(names, take, help)
                 ->transform(CLI::CheckedTransformer(choices).description("")));
}

Option* Command::add_option_function(const std::string& names, std::function<void(const std::string&)> take,
                                     const std::string& help) {
  return add(parser_->add_option_function<std::string>(names, take, help));
}

Option* Command::add_flag(const std::string& names, bool& value, const std::string& help) {
  return add(parser_->add_flag(names, value, help));
}

Option* Command::add_flag_callback(const std::string& names, std::function<void()> said,
                                   const std::string& help) {
  return add(parser_->add_flag_callback(names, std::move(said), help));
}

void Command::set_version_flag(const std::string& names, const std::string& version) {
  parser_->set_version_flag(names, version);
}

Option* Command::get_option(const std::string& name) {
  const CLI::Option* parser = parser_->get_option(name);
  return &*std::ranges::find(options_, parser, &Option::parser_);
}

Command* Command::add_subcommand(const std::string& name, const std::string& help) {
  return &commands_.emplace_back(parser_->add_subcommand(name, help));
}

Command* Command::add_option_group(const std::string& name, const std::string& help) {
  return &commands_.emplace_back(parser_->add_option_group(name, help));
}

void Command::require_subcommand(int count) {
  parser_->require_subcommand(count);
}

void Command::require_option(int count) {
  parser_->require_option(count);
}

void Command::fallthrough() {
  parser_->fallthrough();
}

void Command::take_the_rest() {
  parser_->set_help_flag();
  parser_->fallthrough(false);
  parser_->prefix_command();
}

std::vector<std::string> Command::remaining() const {
  return parser_->remaining();
}

void Command::callback(std::function<void()> chosen) {
  parser_->callback(std::move(chosen));
}

std::optional<Leave> Command::parse(int argc, char** argv) {
  return taken(*parser_, [&] { parser_->parse(argc, argv); });
}

std::optional<Leave> Command::parse(std::vector<std::string> words) {
  std::ranges::reverse(words);  // as the parser takes them
  return taken(*parser_, [&] { parser_->parse(std::move(words)); });
}

const std::string& Command::name() const {
  return parser_->get_name();
}

std::vector<std::string> Command::long_names() const {
  std::vector<std::string> names;
  for (const CLI::Option* option : std::as_const(*parser_).get_options())
    names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
  return names;
}

}  // namespace biteline::options
