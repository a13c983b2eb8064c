#include "server/front/tls/hello_size.h"

#include <algorithm>

namespace uplink::front {
namespace {

/// The range of record types.
constexpr std::uint8_t kFirstRecordType = 20;
constexpr std::uint8_t kHandshakeRecord = 22;
constexpr std::uint8_t kLastRecordType = 24;
/// The type of a message.
constexpr std::uint8_t kClientHello = 1;

}  // namespace

void HelloSize::Take(std::string_view bytes) {
  for (const char each : bytes) {
    if (done_) return;
    const auto byte = static_cast<std::uint8_t>(each);
    if (record_head_ < kRecordHeadBytes) {
      TakeRecordHead(byte);
      continue;
    }
    if (record_type_ == kHandshakeRecord) TakeMessage(byte);
    if (--record_left_ == 0) record_head_ = 0;
  }
}

void HelloSize::TakeRecordHead(std::uint8_t byte) {
  // A type, two bytes of a version, two of the content's size.
  if (record_head_ == 0) {
    record_type_ = byte;
    record_left_ = 0;
    done_ = byte < kFirstRecordType || byte > kLastRecordType;
  }
  if (record_head_ >= 3) record_left_ = record_left_ << 8U | byte;
  // A record without content is skipped.
  if (++record_head_ == kRecordHeadBytes && record_left_ == 0) record_head_ = 0;
}

void HelloSize::TakeMessage(std::uint8_t byte) {
  if (message_left_ > 0) {
    --message_left_;
    return;
  }
  if (message_head_ == 0) {
    done_ = byte != kClientHello;
    message_size_ = 0;
  } else {
    message_size_ = message_size_ << 8U | byte;
  }
  if (++message_head_ < kMessageHeadBytes) return;
  size_ = std::max(size_, message_size_);
  message_left_ = message_size_;
  message_head_ = 0;
}

}  // namespace uplink::front
