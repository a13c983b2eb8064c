#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "schema/base/clock.h"

namespace uplink::testing {

/// A child process whose standard output and error are read as one text. Killed by the destructor
/// if it still runs. Confined to one thread.
class ServerProcess final {
 public:
  /// `arguments[0]` is the program's path; `environment` (`NAME=value`) is added to this one's.
  explicit ServerProcess(const std::vector<std::string>& arguments,
                         const std::vector<std::string>& environment = {});
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  /// Reads on until the text holds `part` (from `from` on); false if it ended or `deadline` passed
  /// first.
  [[nodiscard]] bool WaitFor(std::string_view part,
                             milliseconds deadline = std::chrono::seconds(30),
                             std::size_t from = 0);
  void Signal(int signal) const;
  /// The exit code; 128 plus the signal's number if one ended it; nothing after `deadline`.
  [[nodiscard]] std::optional<int> WaitForExit(milliseconds deadline = std::chrono::seconds(30));
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  bool ReadMore(milliseconds wait);

  pid_t pid_ = -1;
  int output_ = -1;
  std::string text_;
  std::optional<int> exit_code_;
};

/// A port of the loopback that was free a moment ago; another program may take it meanwhile.
[[nodiscard]] std::uint16_t FreePort();

/// Where an uplinkd listens.
struct Ports {
  std::uint16_t relay = 0;
  std::uint16_t http = 0;
};
/// Reads an uplinkd's log until it names both; nothing if it ended first.
[[nodiscard]] std::optional<Ports> WaitForPorts(ServerProcess& process);

/// The port after `key=host:` in a log line: `listening relay=[::]:7443`.
[[nodiscard]] std::optional<std::uint16_t> PortIn(std::string_view text, std::string_view key);

}  // namespace uplink::testing
