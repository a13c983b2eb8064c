#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <absl/status/statusor.h>

#include "server/transport/listener.h"
#include "server/transport/options.h"

namespace uplink::relay {

/// The gRPC listener for robots: UplinkRelay over mutual TLS, on completion queues of its own.
class RelayServer final : public transport::Listener {
 public:
  /// Listens and serves.
  ///
  /// Errors: kUnavailable names the address and why nobody can listen there; kFailedPrecondition
  ///         names what is wrong with certificate, key or authority.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<RelayServer>> Start(
      const transport::RelayOptions& options, const transport::RelayContext& context);

  /// Shuts down at once if Shutdown was not called.
  ~RelayServer() override;
  RelayServer(const RelayServer&) = delete;
  RelayServer& operator=(const RelayServer&) = delete;

  // transport::Listener
  [[nodiscard]] std::uint16_t port() const override;
  [[nodiscard]] std::size_t streams() const override;
  [[nodiscard]] bool draining() const override;
  transport::FilesLook RefreshFiles() override;
  void Drain(milliseconds grace) override;
  [[nodiscard]] bool WaitForStreams(milliseconds wait) const override;
  void Shutdown(milliseconds wait) override;

 private:
  struct Impl;
  explicit RelayServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::relay
