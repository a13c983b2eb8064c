#pragma once

#include <utility>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/config/config.h"
#include "server/health/certificate.h"
#include "server/store/open.h"
#include "storage/types.h"

namespace uplink {

/// What is opened before the rest of the server can be built on it.
struct Opened {
  store::Stores stores;
  SystemTime certificate_expiry;
};

/// Errors: of the store and of the certificate, each naming its file or address.
[[nodiscard]] inline absl::StatusOr<Opened> Open(const config::Config& config,
                                                 const storage::ProcessId& process,
                                                 const Clock& clock) {
  Opened opened;
  const auto expiry = health::CertificateExpiry(config.tls.certificate_file);
  if (!expiry.ok()) return expiry.status();
  opened.certificate_expiry = *expiry;
  auto stores = store::OpenStores(config, process, clock);
  if (!stores.ok()) return stores.status();
  opened.stores = *std::move(stores);
  return opened;
}

}  // namespace uplink
