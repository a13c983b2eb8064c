#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <absl/status/statusor.h>

#include "server/relay/options.h"

namespace uplink::relay {

/// What a look at the PEM files found. A value.
struct FilesLook {
  /// Not OK: why the files on disk are not served.
  absl::Status status;
  /// Of the certificate that is served.
  SystemTime expiry;
};

/// The gRPC listener for robots: UplinkRelay over mutual TLS, on completion queues of its own.
///
/// Life:   Start; Drain; WaitForStreams, while the journal's writer still settles; Shutdown; then
///         the writer may stop. StreamRefs of its streams stay valid until it is destroyed, so the
///         writer and the fleet's last wake must be over by then.
/// Thread: main; streams(), draining() and port() from any.
class RelayServer final {
 public:
  /// Listens and serves.
  ///
  /// Errors: kUnavailable names the address and why nobody can listen there; kFailedPrecondition
  ///         names what is wrong with certificate, key or authority.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<RelayServer>> Start(
      const RelayOptions& options, const RelayContext& context);

  /// Shuts down at once if Shutdown was not called.
  ~RelayServer();
  RelayServer(const RelayServer&) = delete;
  RelayServer& operator=(const RelayServer&) = delete;

  /// Where it listens.
  [[nodiscard]] std::uint16_t port() const;
  /// Streams that were admitted and have not ended.
  [[nodiscard]] std::size_t streams() const;
  [[nodiscard]] bool draining() const;

  /// Looks at the PEM files and serves new ones from now on (within kFilesRefresh), if they are
  /// good together; else the last good ones. One thread. Without files: nothing is known.
  FilesLook RefreshFiles();

  /// Admits no stream any more and tells those that are here, spread over a part of `grace`.
  void Drain(milliseconds grace);
  /// Waits until every stream has ended, for `wait` at most; true if they have.
  [[nodiscard]] bool WaitForStreams(milliseconds wait) const;
  /// Ends what is left within `wait` and stops the queues' threads. Idempotent.
  void Shutdown(milliseconds wait);

 private:
  struct Impl;
  explicit RelayServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::relay
