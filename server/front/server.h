#pragma once

#include <memory>

#include <absl/status/statusor.h>

#include "server/config/config.h"
#include "server/transport/listener.h"
#include "server/transport/options.h"

namespace uplink::front {

/// The listener for robots: gRPC over HTTP/2 over mutual TLS.
class FrontServer final : public transport::Listener {
 public:
  /// Listens and serves.
  ///
  /// Errors: kUnavailable names the address and why nobody can listen there; kFailedPrecondition
  ///         names what is wrong with certificate, key or authority.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<FrontServer>> Start(
      const transport::RelayOptions& options, const transport::RelayContext& context);

  /// Shuts down at once if Shutdown was not called.
  ~FrontServer() override;
  FrontServer(const FrontServer&) = delete;
  FrontServer& operator=(const FrontServer&) = delete;

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
  explicit FrontServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::front
