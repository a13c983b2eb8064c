#include "server/mqtt/reason_codes.h"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "server/mqtt/limits.h"

namespace uplink::mqtt {
namespace {

struct Reason {
  std::uint8_t code;
  std::string_view name;
};

/// Codes that a broker may send to a subscriber.
constexpr Reason kReasons[] = {
    {0x00, "normal disconnection"},
    {0x80, "unspecified error"},
    {0x81, "malformed packet"},
    {0x82, "protocol error"},
    {0x83, "implementation specific error"},
    {0x84, "unsupported protocol version"},
    {0x85, "client identifier not valid"},
    {0x86, "bad user name or password"},
    {0x87, "not authorized"},
    {0x88, "server unavailable"},
    {0x89, "server busy"},
    {0x8A, "banned"},
    {0x8B, "server shutting down"},
    {0x8C, "bad authentication method"},
    {0x8D, "keep alive timeout"},
    {0x8E, "session taken over"},
    {0x8F, "topic filter invalid"},
    {0x90, "topic name invalid"},
    {0x91, "packet identifier in use"},
    {0x93, "receive maximum exceeded"},
    {0x94, "topic alias invalid"},
    {0x95, "packet too large"},
    {0x96, "message rate too high"},
    {0x97, "quota exceeded"},
    {0x98, "administrative action"},
    {0x99, "payload format invalid"},
    {0x9A, "retain not supported"},
    {0x9B, "QoS not supported"},
    {0x9C, "use another server"},
    {0x9D, "server moved"},
    {0x9E, "shared subscriptions not supported"},
    {0x9F, "connection rate exceeded"},
    {0xA0, "maximum connect time"},
    {0xA1, "subscription identifiers not supported"},
    {0xA2, "wildcard subscriptions not supported"},
};

constexpr std::array<std::string_view, 6> kConnackReasons311 = {
    "accepted",           "unacceptable protocol version", "identifier rejected",
    "server unavailable", "bad user name or password",     "not authorized"};

std::string Joined(std::string_view name, std::uint8_t code, std::string_view text) {
  std::string reason = fmt::format("{} (0x{:02X})", name, code);
  if (text.empty()) return reason;
  const std::size_t room = kErrorBytesMax / 2;
  return fmt::format("{}: {}", reason, PrintableUtf8(text, room));
}

}  // namespace

std::string ReasonText(std::uint8_t code, std::string_view text) {
  const auto* const found = std::ranges::find(kReasons, code, &Reason::code);
  return Joined(found != std::end(kReasons) ? found->name : "unknown reason", code, text);
}

bool IsRefusalOf311(std::uint8_t code) { return code > 0 && code < kConnackReasons311.size(); }

std::string ConnackText(Version version, std::uint8_t code, std::string_view text) {
  const bool of_311 = IsRefusalOf311(code);
  if (version == Version::k5 && !of_311) return ReasonText(code, text);
  std::string reason = Joined(of_311 ? kConnackReasons311.at(code) : "unknown reason", code, text);
  if (version == Version::k311) return reason;
  return reason + ": it answers by MQTT 3.1.1: set mqtt.version = \"3.1.1\" for a broker without 5";
}

std::uint8_t FarewellCode(EndReason reason) {
  switch (reason) {
    case EndReason::kMalformed:
    case EndReason::kUnknownProperty:
      return 0x81;
    case EndReason::kUnexpectedPacket:
    case EndReason::kUnexpectedAnswer:
      return 0x82;
    case EndReason::kTopicAlias:
      return 0x94;
    case EndReason::kTooLarge:
      return 0x95;
    case EndReason::kQos2:
      return 0x9B;
    case EndReason::kPingLate:
    case EndReason::kTimeout:
    case EndReason::kWriteStalled:
      return 0x80;
    case EndReason::kStopped:
    case EndReason::kSettings:
    case EndReason::kResolve:
    case EndReason::kConnect:
    case EndReason::kTls:
    case EndReason::kRefused:
    case EndReason::kClosed:
    case EndReason::kBroken:
    case EndReason::kDisconnected:
    case EndReason::kIdTaken:
    case EndReason::kBehind:
      return 0;
  }
  return 0;
}

}  // namespace uplink::mqtt
