#include "tests/support/server_process.h"

#include <cstdlib>

#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Rounded up: a wait of a millisecond is one, and reads what is there.
milliseconds Left(SteadyTime end) {
  return std::chrono::ceil<milliseconds>(end - SystemClock().Steady());
}

}  // namespace

ServerProcess::ServerProcess(const std::vector<std::string>& arguments,
                             const std::vector<std::string>& environment) {
  int ends[2];
  UPLINK_CHECK(pipe2(ends, O_CLOEXEC) == 0, "a test can open a pipe");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  std::vector<std::string> texts = arguments;
  std::vector<std::string> variables = environment;
  for (char** entry = environ; *entry != nullptr; ++entry) variables.emplace_back(*entry);
  const int spawned = posix_spawn(&pid_, arguments.front().c_str(), &actions, nullptr,
                                  Pointers(texts).data(), Pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  output_ = ends[0];
  UPLINK_CHECK(spawned == 0, arguments.front());
}

ServerProcess::~ServerProcess() {
  if (!exit_code_) {
    kill(pid_, SIGKILL);
    static_cast<void>(WaitForExit());
  }
  close(output_);
}

bool ServerProcess::ReadMore(milliseconds wait) {
  pollfd readable{.fd = output_, .events = POLLIN, .revents = 0};
  if (wait.count() <= 0 || poll(&readable, 1, static_cast<int>(wait.count())) <= 0) return false;
  char bytes[4096];
  const ssize_t n = read(output_, bytes, sizeof(bytes));
  if (n <= 0) return false;
  text_.append(bytes, static_cast<std::size_t>(n));
  return true;
}

bool ServerProcess::WaitFor(std::string_view part, milliseconds deadline, std::size_t from) {
  const SteadyTime end = SystemClock().Steady() + deadline;
  while (text_.find(part, from) == std::string::npos) {
    if (!ReadMore(Left(end))) return false;
  }
  return true;
}

void ServerProcess::Signal(int signal) const { kill(pid_, signal); }

std::optional<int> ServerProcess::WaitForExit(milliseconds deadline) {
  if (exit_code_) return exit_code_;
  const SteadyTime end = SystemClock().Steady() + deadline;
  // The pipe closes when the process has ended, so reading to its end is the wait.
  while (ReadMore(Left(end))) {
  }
  if (Left(end).count() <= 0) return std::nullopt;
  int status = 0;
  if (waitpid(pid_, &status, 0) != pid_) return std::nullopt;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return exit_code_;
}

std::optional<std::uint16_t> PortIn(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(std::string(key) + "=");
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view value = text.substr(at);
  value = value.substr(0, value.find_first_of(" \n"));
  const std::size_t colon = value.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const unsigned long port =
      std::strtoul(std::string(value.substr(colon + 1)).c_str(), nullptr, 10);
  return static_cast<std::uint16_t>(port);
}

std::uint16_t FreePort() {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  UPLINK_CHECK(bind(listener, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                   getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) == 0,
               "there is a free port");
  close(listener);
  return ntohs(address.sin_port);
}

std::optional<Ports> WaitForPorts(ServerProcess& process) {
  if (!process.WaitFor(" listening ")) return std::nullopt;
  const std::size_t at = process.text().find(" listening ");
  // A line may come in two pieces, and the first end in the middle of a port.
  if (!process.WaitFor("\n", std::chrono::seconds(30), at)) return std::nullopt;
  const std::string line = process.text().substr(at);
  const auto relay = PortIn(line, "relay");
  const auto http = PortIn(line, "http");
  if (!relay || !http) return std::nullopt;
  return Ports{*relay, *http};
}

}  // namespace uplink::testing
