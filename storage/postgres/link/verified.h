#pragma once

#include <optional>
#include <string>

#include "storage/postgres/link/url.h"

namespace uplink::storage::postgres {

/// A connection over a network whose server need not prove that it is the one that was named. A
/// value.
struct Unverified {
  /// The first host of the URL that is neither a Unix socket nor of this machine.
  std::string host;
  /// What `sslmode` is: the URL's, or what libpq takes (PGSSLMODE, else `prefer`).
  std::string sslmode;
};

/// Nothing if every place of the URL is a Unix socket or a loopback address, or `sslmode` is
/// `verify-full`. Any weaker mode lets a machine in between read and change everything, including
/// the password where the server may ask for it in clear.
///
/// Thread: any; libpq reads the environment for what the URL leaves out.
[[nodiscard]] std::optional<Unverified> FindUnverified(const Url& url);

}  // namespace uplink::storage::postgres
