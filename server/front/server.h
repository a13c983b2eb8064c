#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/front/call/relay_context.h"
#include "server/transport/key_files.h"
#include "server/transport/methods.h"
#include "server/transport/options.h"

namespace uplink::front {

/// The listener for robots: UplinkRelay, and other methods, by gRPC over HTTP/2 over mutual TLS.
///
/// Life:   made listening; Drain; WaitForStreams, while the journal's writer still settles;
///         Shutdown; then the writer may stop. StreamRefs of its streams stay valid until it is
///         destroyed, so the writer and the fleet's last wake must be over by then.
/// Thread: main; streams(), draining() and port() from any; RefreshFiles on one.
class FrontServer final {
 public:
  /// Listens, and serves the relay and the methods that `others` makes for each thread. What those
  /// methods hold is destroyed with the server.
  ///
  /// Errors: kUnavailable names the address and why listening failed; kFailedPrecondition names
  ///         what is wrong with certificate, key or authority.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<FrontServer>> Start(
      const transport::RelayOptions& options, const RelayContext& context,
      transport::MethodsMaker others = {});

  /// Shuts down at once if Shutdown was not called.
  ~FrontServer();
  FrontServer(const FrontServer&) = delete;
  FrontServer& operator=(const FrontServer&) = delete;

  /// Where it listens.
  [[nodiscard]] std::uint16_t port() const;
  /// Streams that were admitted and have not ended.
  [[nodiscard]] std::size_t streams() const;
  [[nodiscard]] bool draining() const;

  /// Reads the PEM files. From now on (within kFilesRefresh) it serves new ones if they fit
  /// together, otherwise the last good ones. Without files, the result is that nothing is known.
  transport::FilesLook RefreshFiles();

  /// The deny list changed: ends the calls of connections whose certificates it names. Any thread;
  /// nothing once it is shut down.
  void LookAtDenied();

  /// Admits no more streams, and tells the open ones to drain, spread over a part of `grace`.
  void Drain(milliseconds grace);
  /// Waits until every stream has ended, for `wait` at most; true if they have.
  [[nodiscard]] bool WaitForStreams(milliseconds wait) const;
  /// Ends all remaining streams at once and stops the listener's threads. Idempotent.
  void Shutdown();

 private:
  struct Impl;
  explicit FrontServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::front
