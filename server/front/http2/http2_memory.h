#pragma once

#include <cstddef>
#include <vector>

#include <nghttp2/nghttp2.h>

namespace uplink::front {

/// Memory for nghttp2's sessions of one thread.
///
/// A session holds a buffer of 16 KiB for the frame that it sends, and uses some hundred bytes of
/// it. The C library would give it used memory, and all of that counts as resident. Here it gets
/// pages of its own, and untouched pages cost nothing: this saves 12 KiB per connection (measured).
/// Everything else is the C library's.
///
/// Bounded by the sessions: what they release is used again, and its pages go back to the system.
/// Thread: confined to one. Outlives its sessions.
class Http2Memory final {
 public:
  Http2Memory();
  ~Http2Memory();
  Http2Memory(const Http2Memory&) = delete;
  Http2Memory& operator=(const Http2Memory&) = delete;

  /// For nghttp2, which copies it.
  [[nodiscard]] nghttp2_mem functions();

 private:
  void* Allocate(std::size_t bytes);
  void Release(void* memory);
  void* Reallocate(void* memory, std::size_t bytes);
  /// A piece of kPieceBytes with untouched or clean pages.
  void* TakePiece();

  /// Slabs from the system, kSlabBytes each.
  std::vector<void*> slabs_;
  std::vector<void*> free_;
};

}  // namespace uplink::front
