#include "tests/bench/pinned_server.h"

#include <csignal>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <sys/wait.h>

namespace uplink::bench {
namespace {

constexpr milliseconds kStopWait{15'000};
/// Of the log, in a failure.
constexpr std::size_t kShownBytesMax = 2'000;

/// What is started meanwhile takes signals, though who starts it takes them in its own time.
class SignalsOfChildren final {
 public:
  SignalsOfChildren() {
    sigset_t none{};
    sigemptyset(&none);
    pthread_sigmask(SIG_SETMASK, &none, &before_);
  }
  ~SignalsOfChildren() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsOfChildren(const SignalsOfChildren&) = delete;
  SignalsOfChildren& operator=(const SignalsOfChildren&) = delete;

 private:
  sigset_t before_{};
};

std::string TailOf(const std::string& text) {
  return text.size() > kShownBytesMax ? text.substr(text.size() - kShownBytesMax) : text;
}

}  // namespace

std::unique_ptr<testing::ServerProcess> StartPinned(std::vector<std::string> command,
                                                    const std::vector<std::string>& environment) {
  // setpriv becomes the program, which then dies with this thread.
  command.insert(command.begin(), {"/usr/bin/setpriv", "--pdeathsig", "KILL"});
  const SignalsOfChildren taken;
  // What is started takes the core of who starts it.
  PinTo(kServerCore);
  auto process = std::make_unique<testing::ServerProcess>(command, environment);
  PinTo(kLoadCore);
  return process;
}

synthetic::ProcessUse UseOf(const testing::ServerProcess& process) {
  return synthetic::UseOf(process.pid()).value_or(synthetic::ProcessUse());
}

absl::StatusOr<std::unique_ptr<PinnedServer>> PinnedServer::Start(
    const testing::UplinkdFolder& folder, const Options& options) {
  std::vector<std::string> command = {options.program, "--config", folder.Path("uplinkd.toml")};
  if (options.descriptors_max > 0) {
    // prlimit becomes the program, too.
    command.insert(command.begin(),
                   {"/usr/bin/prlimit", fmt::format("--nofile={0}:{0}", options.descriptors_max)});
  }
  std::unique_ptr<PinnedServer> server(
      new PinnedServer(StartPinned(std::move(command), options.environment)));
  const auto ports = testing::WaitForPorts(*server->process_);
  if (!ports) {
    return absl::UnavailableError(
        fmt::format("{} does not listen: {}", options.program, TailOf(server->process_->text())));
  }
  server->ports_ = *ports;
  return server;
}

bool PinnedServer::ended() const {
  siginfo_t info{};
  const auto pid = static_cast<id_t>(process_->pid());
  return waitid(P_PID, pid, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid != 0;
}

void PinnedServer::ReadLog() {
  // No line of a log says that: it reads what is there.
  static_cast<void>(process_->WaitFor("\n\n\n", milliseconds(1), process_->text().size()));
}

std::string PinnedServer::Stop() {
  const bool by_itself = ended();
  if (!by_itself) process_->Signal(SIGTERM);
  auto code = process_->WaitForExit(kStopWait);
  if (!code) {
    process_->Signal(SIGKILL);
    code = process_->WaitForExit(kStopWait);
    return fmt::format("did not end within {} s, and was killed", kStopWait.count() / 1000);
  }
  if (by_itself) {
    return fmt::format("ENDED BY ITSELF with {}: {}", *code, TailOf(process_->text()));
  }
  return *code == 0 ? "drained" : fmt::format("ended with {}", *code);
}

}  // namespace uplink::bench
