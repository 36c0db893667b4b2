// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/add_user.hpp"

#include <termios.h>
#include <unistd.h>

#include <future>
#include <utility>

#include "common/core/text.hpp"
#include "host/interfaces/accounts/accounts.hpp"
#include "host/interfaces/accounts/first_token.hpp"
#include "host/interfaces/control/client.hpp"
#include "host/records/memory/memory.hpp"
#include "host/report/file_lock.hpp"

namespace biteline::web {
namespace {

/// As biteline-host calls it.
constexpr const char* k_lock_name = "biteline-host.lock";
constexpr std::size_t k_most_password_bytes = 200;

/// What is typed is not shown while it lives.
class Unseen {
 public:
  explicit Unseen(int terminal) : terminal_{terminal} {
    if (tcgetattr(terminal_, &before_) != 0) return;
    termios quiet = before_;
    quiet.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    changed_ = tcsetattr(terminal_, TCSAFLUSH, &quiet) == 0;
  }
  Unseen(const Unseen&) = delete;
  Unseen& operator=(const Unseen&) = delete;
  ~Unseen() {
    if (changed_) tcsetattr(terminal_, TCSAFLUSH, &before_);
  }

 private:
  int terminal_;
  termios before_{};
  bool changed_{false};
};

Result<std::string> read_one_line(std::FILE* input) {
  std::string line;
  for (int letter = std::fgetc(input); letter != EOF && letter != '\n'; letter = std::fgetc(input)) {
    line += static_cast<char>(letter);
    if (line.size() > k_most_password_bytes) {
      return fail(Errc::BadValue, "password: at most %zu bytes expected", k_most_password_bytes);
    }
  }
  return line;
}

Result<void> add_to_folder(const AddUserRequest& request, accounts::Role role, const std::string& password) {
  const std::string holder = "biteline-web --add-user " + std::to_string(getpid());
  BITELINE_ASSIGN(const report::FileLock lock, report::FileLock::take(request.out / k_lock_name, holder));
  BITELINE_ASSIGN(memory::Memory memory, memory::Memory::open(request.out / memory::k_memory_file));
  // Who can write the folder can do more than this: the rights of the files decide here.
  return accounts::Accounts{memory}.add(request.name, role, password, "cell", "command line");
}

/// Where the service keeps the first account's token, as it says with its hello; empty: it says nothing.
class ToldFolder {
 public:
  void hear(const control::Event& event) {
    if (event.name != "hello" || std::exchange(heard_, true)) return;
    const control::Json folder =
        event.data.is_object() ? event.data.value("accounts", control::Json{}) : control::Json{};
    told_.set_value(folder.is_string() ? folder.get<std::string>() : std::string{});
  }
  std::string wait() {
    constexpr auto k_patience = std::chrono::seconds{5};
    std::future<std::string> folder = told_.get_future();
    return folder.wait_for(k_patience) == std::future_status::ready ? folder.get() : std::string{};
  }

 private:
  bool heard_{false};  ///< the client's thread only
  std::promise<std::string> told_;
};

Result<void> add_by_service(const AddUserRequest& request, const std::string& password) {
  control::ClientConfig config{.endpoint = *request.control, .keys = {}};
  if (request.control_keys) {
    BITELINE_ASSIGN(config.keys, wire::read_host_keys(*request.control_keys));
  }
  ToldFolder told;
  BITELINE_ASSIGN(const auto client,
                  control::Client::open(config, [&told](const control::Event& event) { told.hear(event); }));
  control::Request question;
  if (const std::string folder = told.wait(); !folder.empty())
    question.token = accounts::read_first_token(folder);
  question.local = true;
  question.door = "command line";
  question.method = "POST";
  question.path = "/api/v1/users";
  question.body["name"] = request.name;
  question.body["role"] = request.role;
  question.body["password"] = password;
  const control::Answer answer = client->ask(std::move(question));
  if (answer.status == 201) return {};
  std::string words = "no words";
  if (answer.body.is_object() && answer.body.contains("error"))
    words = answer.body["error"].value("message", words);
  return fail(Errc::PeerRefused, "biteline-host at %s: %s", request.control->text().c_str(),
              clean_text(words, 180).c_str());
}

}  // namespace

Result<std::string> read_password(std::FILE* input) {
  const int terminal = fileno(input);
  if (isatty(terminal) == 0) return read_one_line(input);
  const Unseen unseen{terminal};
  std::fputs("password: ", stderr);
  BITELINE_ASSIGN(std::string first, read_one_line(input));
  std::fputs("\nthe same again: ", stderr);
  BITELINE_ASSIGN(const std::string second, read_one_line(input));
  std::fputs("\n", stderr);
  if (first != second) return fail(Errc::BadValue, "the two passwords differ: nothing was done");
  return first;
}

Result<void> add_user(const AddUserRequest& request, const std::string& password) {
  const auto role = accounts::role_of(request.role);
  if (!role) {
    return fail(Errc::InvalidArgument, "--role %s: viewer, operator, engineer or administrator expected",
                clean_text(request.role, 60).c_str());
  }
  return request.control ? add_by_service(request, password) : add_to_folder(request, *role, password);
}

}  // namespace biteline::web
