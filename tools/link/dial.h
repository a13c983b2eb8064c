#pragma once

#include <functional>
#include <memory>
#include <string>

#include "tools/link/loop.h"
#include "tools/link/stream_connection.h"

namespace uplink::link {

/// Where a connection goes, and who it is; in PEM. A value.
struct DialOptions {
  /// HOST:PORT; the host is what the server's certificate must say.
  std::string target;
  std::string server_ca;
  std::string certificate;
  std::string key;
};

/// Makes a connection, not connected yet. The references outlive it.
using Dial =
    std::function<std::unique_ptr<StreamConnection>(Loop&, const DialOptions&, StreamEvents&)>;

}  // namespace uplink::link
