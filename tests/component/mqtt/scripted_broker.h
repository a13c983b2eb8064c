#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace uplink::testing {

/// A broker that sends only the bytes that the test gives it; it listens on a loopback port.
/// Nothing here waits; the test does. Confined to one thread.
class ScriptedBroker final {
 public:
  ScriptedBroker();
  ~ScriptedBroker();
  ScriptedBroker(const ScriptedBroker&) = delete;
  ScriptedBroker& operator=(const ScriptedBroker&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Connections that were taken so far; a new one replaces the older one, and what that said.
  std::size_t Poll();
  /// What the present connection said so far.
  [[nodiscard]] const std::string& received();
  /// True if the client ended the present connection.
  [[nodiscard]] bool ended();
  /// The whole of it; a test sends no more than the system takes at once.
  void Send(std::string_view bytes);
  /// Ends the present connection.
  void Hang();

 private:
  int listener_ = -1;
  int socket_ = -1;
  std::uint16_t port_ = 0;
  std::size_t accepted_ = 0;
  bool ended_ = false;
  std::string received_;
};

}  // namespace uplink::testing
