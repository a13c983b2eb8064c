#pragma once

#include <cstddef>
#include <cstdint>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/identity/served_pems.h"

namespace uplink::transport {

/// What a look at the PEM files found. A value.
struct FilesLook {
  /// Not OK: why the files on disk are not served.
  absl::Status status;
  /// What is served.
  identity::ServedPems served;
};

/// The listener for robots: UplinkRelay over mutual TLS.
///
/// Life:   made listening; Drain; WaitForStreams, while the journal's writer still settles;
///         Shutdown; then the writer may stop. StreamRefs of its streams stay valid until it is
///         destroyed, so the writer and the fleet's last wake must be over by then.
/// Thread: main; streams(), draining() and port() from any; RefreshFiles on one.
class Listener {
 public:
  virtual ~Listener() = default;

  /// Where it listens.
  [[nodiscard]] virtual std::uint16_t port() const = 0;
  /// Streams that were admitted and have not ended.
  [[nodiscard]] virtual std::size_t streams() const = 0;
  [[nodiscard]] virtual bool draining() const = 0;

  /// Looks at the PEM files and serves new ones from now on (within kFilesRefresh), if they are
  /// good together; else the last good ones. Without files: nothing is known.
  virtual FilesLook RefreshFiles() = 0;

  /// Admits no stream any more and tells those that are here, spread over a part of `grace`.
  virtual void Drain(milliseconds grace) = 0;
  /// Waits until every stream has ended, for `wait` at most; true if they have.
  [[nodiscard]] virtual bool WaitForStreams(milliseconds wait) const = 0;
  /// Ends what is left within `wait` and stops the listener's threads. Idempotent.
  virtual void Shutdown(milliseconds wait) = 0;
};

}  // namespace uplink::transport
