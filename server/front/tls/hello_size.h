#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::front {

/// How large a peer's ClientHello says it is, before it is there: OpenSSL takes the memory for up
/// to 128 KiB of it as soon as it has read its first four bytes. There may be two of them, and
/// between them records that OpenSSL passes over.
///
/// Source: RFC 8446, 4, 4.1.4 and 5.1. Confined to its connection's thread.
class HelloSize final {
 public:
  /// What came next.
  void Take(std::string_view bytes);
  /// Of the largest ClientHello's body; 0 as long as none has said it, or it is no TLS.
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  static constexpr std::size_t kRecordHeadBytes = 5;
  static constexpr std::size_t kMessageHeadBytes = 4;

  void TakeRecordHead(std::uint8_t byte);
  void TakeMessage(std::uint8_t byte);

  /// Bytes of the record's head that have come, and of its content that have not.
  std::size_t record_head_ = 0;
  std::size_t record_left_ = 0;
  std::uint8_t record_type_ = 0;
  /// Bytes of the message's head that have come, its size, and bytes of its body that have not.
  std::size_t message_head_ = 0;
  std::size_t message_size_ = 0;
  std::size_t message_left_ = 0;
  std::size_t size_ = 0;
  /// Another message than a ClientHello has come, or no TLS: no ClientHello follows.
  bool done_ = false;
};

}  // namespace uplink::front
