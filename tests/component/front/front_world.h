#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "schema/model/ids.h"
#include "server/transport/turned_away.h"
#include "tests/support/raw_http2.h"
#include "tests/support/relay_world.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::testing {

/// The options, for the transport of our own.
[[nodiscard]] RelayWorld::Options Native(RelayWorld::Options options = {});

[[nodiscard]] KeyPair RobotKeys(const RelayWorld& world, int number);
/// Many streams on a connection; the relay does not serve its calls yet.
[[nodiscard]] KeyPair GatewayKeys(const RelayWorld& world);
/// A raw client that shows this identity; empty: none.
[[nodiscard]] RawHttp2::Options ClientOf(const RelayWorld& world, const KeyPair& identity,
                                         const std::string& source = {});

/// The headers of a call of Relay, with these in place of its own or beside them; an empty value
/// leaves the header out.
[[nodiscard]] http2::Fields RelayFields(const http2::Fields& changes = {});
/// HEADERS that open a call of Relay on the stream.
[[nodiscard]] std::string OpenRelay(std::uint32_t stream, const http2::Fields& changes = {});
/// The five bytes before a message.
[[nodiscard]] std::string Prefix(std::uint32_t bytes, char flag = '\0');
[[nodiscard]] std::string WithPrefix(std::string_view message);
/// Hello of the session that `number` tells apart, for a robot; a gateway names it.
[[nodiscard]] std::string HelloMessage(std::uint8_t number, const std::string& ruri = {});
/// A batch of faults, one for each seq from `first` on.
[[nodiscard]] std::string FaultsMessage(model::Seq first, std::size_t count);

/// What the server sent on the stream so far, of whole messages.
[[nodiscard]] std::vector<v1::RelayResponse> FramesOf(const RawStream& stream);
/// The highest through_seq and judged_seq of its Acks.
[[nodiscard]] v1::Ack LastAck(const RawStream& stream);
/// `grpc-status`, empty before the end.
[[nodiscard]] std::string StatusOf(const RawStream& stream);

/// Connections that were turned away for this.
[[nodiscard]] std::int64_t TurnedAwayFor(const RelayWorld& world, transport::TurnedAway cause);

/// A robot of this number connects and has one message stored, within `patience`.
[[nodiscard]] bool ServesNewRobot(const RelayWorld& world, int number,
                                  std::chrono::milliseconds patience = kPatience);

/// Memory that the process has now.
[[nodiscard]] std::size_t ResidentBytes();
/// Whether what a process takes says something about its code.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kMemoryCounts = false;
#else
inline constexpr bool kMemoryCounts = true;
#endif

/// While it lives, the process seems to have so many descriptors at most.
class DescriptorLimit final {
 public:
  explicit DescriptorLimit(std::size_t descriptors_max);
  ~DescriptorLimit();
  DescriptorLimit(const DescriptorLimit&) = delete;
  DescriptorLimit& operator=(const DescriptorLimit&) = delete;

 private:
  std::uint64_t before_ = 0;
};

}  // namespace uplink::testing
