#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace uplink::mqtt {

// Limits of MQTT's own encoding.

/// The largest remaining length: four digits of seven bits.
inline constexpr std::uint32_t kRemainingLengthMax = 268'435'455;
/// Bytes of any text or binary field: its length has 16 bits.
inline constexpr std::size_t kFieldBytesMax = 65'535;

// What we take.

/// Bytes of a PUBLISH before its payload: topic, packet id and properties. The topic alone may have
/// 64 KiB; as much is left for properties, and we use at most kCorrelationBytesMax of those. A
/// larger head is skipped.
inline constexpr std::size_t kHeadBytesMax = std::size_t{128} * 1024;
/// Bytes of any other packet. A SUBACK has a byte for each of kFiltersPerAsk; a longer packet
/// consists of texts that we would not show.
inline constexpr std::size_t kAnswerBytesMax = std::size_t{128} * 1024;
/// Bytes of correlation data that are kept to be echoed; longer data is left out.
inline constexpr std::size_t kCorrelationBytesMax = 1024;
/// Bytes that are read from a connection at once.
inline constexpr std::size_t kReadBytes = std::size_t{64} * 1024;
/// How long a busy connection is not read after it was read empty: 20,000 messages per second then
/// wake us 880 times instead of 10,150.
inline constexpr std::chrono::milliseconds kReadPause{1};
/// Bytes that may wait to be written; past them no PUBLISH is added and nothing is read. That is
/// over a second of a thousand pongs each second.
inline constexpr std::size_t kQueueBytesMax = std::size_t{256} * 1024;
/// Bytes of an error's text in a status.
inline constexpr std::size_t kErrorBytesMax = 256;

// What we ask.

/// Topic filters of one client, and bytes of one.
inline constexpr std::size_t kFiltersMax = 1024;
inline constexpr std::size_t kFilterBytesMax = 1024;
/// Filters of one SUBSCRIBE or UNSUBSCRIBE: as many as the strictest known broker takes (AWS IoT
/// Core's limits, "subscriptions per subscribe request").
inline constexpr std::size_t kFiltersPerAsk = 8;
inline constexpr std::size_t kClientIdBytesMax = 256;
inline constexpr std::size_t kUsernameBytesMax = 1024;
/// Bytes of a file with a password.
inline constexpr std::size_t kPasswordBytesMax = 4096;
/// The largest window: a store remembers twice as many deliveries, and there are 65,535 packet ids.
inline constexpr std::size_t kUnackedMaxMax = 32'767;

// How long we wait.

inline constexpr std::chrono::seconds kResolveWait{10};
inline constexpr std::chrono::seconds kConnectWait{10};
inline constexpr std::chrono::seconds kTlsWait{10};
/// For a CONNACK, a SUBACK and an UNSUBACK.
inline constexpr std::chrono::seconds kAnswerWait{20};
/// For a PINGRESP, while nothing else comes.
inline constexpr std::chrono::seconds kPingWait{15};
/// For the system to take what we write.
inline constexpr std::chrono::seconds kWriteWait{30};
/// For a DISCONNECT to leave.
inline constexpr std::chrono::seconds kFarewellWait{1};
/// Until the core is asked again whether a connection may be made.
inline constexpr std::chrono::milliseconds kGatePause{250};
/// Until a refused filter is asked for again: the broker's rules may have been fixed.
inline constexpr std::chrono::seconds kRefusedPause{60};

}  // namespace uplink::mqtt
