#pragma once

#include <cstddef>
#include <string>

/// What is counted, answered or passed over, and never kept as a robot's state.
namespace uplink::model::cyberwave {

/// The head of a command, or a driver's answer to one; what it carries is not kept. A value.
struct CommandHead {
  /// `command`, or `type` in its place; empty for an answer without.
  std::string command;
  /// Of an answer; empty for a command.
  std::string status;
  /// Of a navigation; empty for other commands.
  std::string action_id;

  friend bool operator==(const CommandHead&, const CommandHead&) = default;
};

/// A position, a rotation or joints as somebody wants them: a command by their source. A value.
struct Commanded {
  /// Joints in it; 0 for a position or a rotation.
  std::size_t setpoints = 0;

  friend bool operator==(const Commanded&, const Commanded&) = default;
};

/// An offer, an answer or a candidate of WebRTC. It carries secrets, so it is not read. A
/// value.
struct Signalling {
  friend bool operator==(const Signalling&, const Signalling&) = default;
};

/// A depth frame or a point cloud, which is not read. A value.
struct Media {
  std::size_t bytes = 0;

  friend bool operator==(const Media&, const Media&) = default;
};

/// A ping, to be answered under the name in its topic. A value.
struct Ping {
  friend bool operator==(const Ping&, const Ping&) = default;
};

/// A message of a topic that we do not subscribe to. A value.
struct Ignored {
  friend bool operator==(const Ignored&, const Ignored&) = default;
};

}  // namespace uplink::model::cyberwave
