#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace uplink::front {

/// The announced size of a peer's ClientHello, known before it has arrived: OpenSSL allocates up to
/// 128 KiB for it once it has read its first four bytes. There may be two, with records between
/// them that OpenSSL ignores.
///
/// Source: RFC 8446, 4, 4.1.4 and 5.1. Confined to its connection's thread.
class HelloSize final {
 public:
  /// Takes the next bytes.
  void Take(std::string_view bytes);
  /// Bytes of the largest ClientHello's body; 0 until one announces it, or if this is not TLS.
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
  /// Another message than a ClientHello, or no TLS, has come: no ClientHello follows.
  bool done_ = false;
};

}  // namespace uplink::front
