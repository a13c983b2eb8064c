#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/server_process.h"
#include "tests/support/temp_folder.h"

namespace uplink::testing {

/// How a broker is configured. A value.
struct MosquittoOptions {
  /// Users and their passwords; none: anybody may come.
  std::vector<std::pair<std::string, std::string>> users;
  /// Lines of its ACL file; empty: everybody may do everything.
  std::string acl;
  /// TLS: the broker's certificate and key, and who vouches for clients; empty: none.
  std::string certificate;
  std::string key;
  std::string client_ca;
  /// Further lines of its configuration.
  std::string lines;
  /// Whether its log names each packet. A test that asks for that must keep reading, or the broker
  /// stands still once its pipe is full.
  bool tells_packets = true;
  /// All of its configuration, in place of one that follows from the above: `FOLDER` stands for
  /// where `acl`, `passwords`, `cert.pem`, `key.pem` and its store are, `PORT` for its port.
  std::string configuration;
};

/// A mosquitto of this test on a loopback port of its own, with its store in a folder of its own.
/// Without the program the test ends and names the remedy. Confined to one thread.
class Mosquitto final {
 public:
  explicit Mosquitto(const MosquittoOptions& options = {});
  ~Mosquitto();
  Mosquitto(const Mosquitto&) = delete;
  Mosquitto& operator=(const Mosquitto&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// The path of the plugin that can refuse a SUBSCRIBE, which mosquitto's own ACL never does.
  [[nodiscard]] static std::string SecurityPlugin();
  /// Ends it in order, with its sessions saved; starts it again on the same port.
  void Stop();
  void Start();
  /// Whether its log holds `part` by now; it does not wait.
  [[nodiscard]] bool Logged(const std::string& part);

 private:
  void WriteConfiguration();

  const TempFolder folder_;
  const MosquittoOptions options_;
  std::uint16_t port_ = 0;
  std::unique_ptr<ServerProcess> process_;
};

}  // namespace uplink::testing
