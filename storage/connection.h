#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "schema/model/connection.h"
#include "schema/model/message_source.h"
#include "storage/identity.h"

namespace uplink::storage {

/// Connections of one robot that the store keeps. Ended ones go before open ones, and of each those
/// first that were written first: by no clock.
inline constexpr std::size_t kConnectionsPerRobotMax = 64;
/// Processes that Store::ProcessesWithOpenConnections names.
inline constexpr std::size_t kOpenProcessesMax = 64;

/// Names one connection: 16 random bytes, drawn when it begins.
using ConnectionId = std::array<std::uint8_t, 16>;

/// The client certificate of a connection. Empty texts where there was none.
struct CertificateFacts {
  /// Hexadecimal, in upper case, as `openssl x509 -serial` prints it.
  std::string serial;
  /// SHA-256 of the certificate (DER) and of its public key (SPKI, DER), hexadecimal, lower case.
  std::string sha256;
  std::string key_sha256;
  std::optional<SystemTime> not_after;
};

/// How a connection ended.
struct ConnectionEnded {
  SystemTime at;
  model::ConnectionEnd why = model::ConnectionEnd::kBroken;
  /// The status with which it ended, such as ABORTED; empty if none was sent or received.
  std::string code;
  /// One sentence for a person, at most kConnectionDetailMax bytes.
  std::string detail;
};
inline constexpr std::size_t kConnectionDetailMax = 512;
/// Of every other text of a connection.
inline constexpr std::size_t kConnectionTextMax = 256;
/// The detail of an end that Store::EndConnections wrote.
inline constexpr std::string_view kServerEndedDetail =
    "the server ended before it told the end of the connection";

/// One connection of a robot: a stream of its own on the relay, a twin's client at a broker, or a
/// drone's calls. Written when it begins and again when it ends; it has no number of its own:
/// writing it twice is writing it once (key: robot, id), and the end stays once it is there
/// (Replaces).
struct ConnectionItem {
  RobotRef robot;
  ConnectionId id{};
  model::MessageSource source = model::MessageSource::kUplink;
  SystemTime began_at;
  /// The process that served it, and the host and port of its relay.
  ProcessId process{};
  std::string server;
  /// Where the peer connected from: its own address behind a load balancer. A twin: its client id.
  std::string address;
  /// The subject of a gateway's certificate; empty: the robot connected by itself.
  std::string gateway;
  std::string agent_version;
  CertificateFacts certificate;
  // What it brought until now.
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  /// Older connections of the robot that it took over from.
  std::uint32_t takeovers = 0;
  /// How long it was held back in all, and for what last (HeldBack's words); empty: never.
  milliseconds held_back{0};
  std::string held_back_why;
  std::optional<ConnectionEnded> ended;
};

/// True if others wrote this end (Store::EndConnections), who took the process for dead.
[[nodiscard]] inline bool IsPresumed(const ConnectionEnded& ended) {
  return ended.why == model::ConnectionEnd::kServerEnded && ended.detail == kServerEndedDetail;
}

/// True if `newer`, which was noted after `older` of the same connection, takes its place: an end
/// stays, unless others only presumed it (kServerEnded) and the process itself tells another, or
/// that the connection goes on.
[[nodiscard]] inline bool Replaces(const ConnectionItem& newer, const ConnectionItem& older) {
  if (!older.ended) return true;
  if (newer.ended) return older.ended->why == model::ConnectionEnd::kServerEnded;
  return IsPresumed(*older.ended) && newer.process == older.process;
}

/// The item as stores take it: its texts are clean UTF-8 of at most their bounds.
[[nodiscard]] ConnectionItem Bounded(ConnectionItem item);

}  // namespace uplink::storage
