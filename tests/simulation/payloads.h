#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace uplink::simulation {

/// What a modelled agent sends.
enum class Content : std::uint8_t {
  kFault,
  kEvent,
  kMotion,
  /// A fault without an id.
  kBadDurable,
  /// A motion message with a truncated payload.
  kBadLive,
  /// A fault that the store refuses for good, where it can be told to.
  kRefused,
  /// An Uplink without content.
  kEmpty,
  /// A fault with a long text, of a greedy agent.
  kLarge,
};
inline constexpr std::size_t kContents = 8;

/// True where the agent must keep the message until an Ack's through_seq.
[[nodiscard]] constexpr bool KeptUntilSettled(Content content) {
  return content != Content::kMotion && content != Content::kBadLive;
}

/// True where the server must reject the message when it judges it.
[[nodiscard]] constexpr bool RejectedAtJudgement(Content content) {
  return content == Content::kBadDurable || content == Content::kBadLive ||
         content == Content::kEmpty;
}

/// The serialized payloads, made once. Immutable.
class Payloads final {
 public:
  Payloads();
  [[nodiscard]] const std::string& Of(Content content) const {
    return bytes_[static_cast<std::size_t>(content)];
  }

 private:
  std::array<std::string, kContents> bytes_;
};

/// The faultId that marks a record for the store's refusal.
inline constexpr char kRefusedFaultId[] = "REFUSE-ME";

}  // namespace uplink::simulation
