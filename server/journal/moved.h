#pragma once

#include <string>

namespace uplink::journal {

/// An OpenStream of the robot found it in another fleet in the store, and moved it. A value.
struct Moved {
  std::string ruri;
  /// The fleet in which the store had it, and that of the OpenStream.
  std::string from;
  std::string to;
  /// The subject of the gateway that the stream came through; empty: it came by the robot's own
  /// certificate, or from a broker.
  std::string gateway;
};

}  // namespace uplink::journal
