#pragma once

#include <string>

namespace uplink::journal {

/// A robot that its stream moved to another fleet, in the store. A value.
struct Moved {
  std::string ruri;
  std::string from;
  std::string to;
  /// The subject of the gateway that the stream came through; empty: it came by the robot's own
  /// certificate, or from a broker.
  std::string gateway;
};

}  // namespace uplink::journal
