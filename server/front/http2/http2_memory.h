#pragma once

#include <cstddef>
#include <vector>

#include <nghttp2/nghttp2.h>

namespace uplink::front {

/// Where nghttp2's sessions of one thread have their memory from.
///
/// A session holds a buffer of 16 KiB for the frame that it sends, of which it uses some hundred
/// bytes. The C library would hand it memory that others have written to, which then counts whole.
/// Here it lies on pages of its own, and those that were never touched cost nothing: 12 KiB per
/// connection (measured). Everything else is the C library's.
///
/// Bounded by the sessions: what they give back is used again, and its pages go back to the system.
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
  /// A piece of kPieceBytes, its pages untouched or clean.
  void* TakePiece();

  /// What the system gave, each kSlabBytes.
  std::vector<void*> slabs_;
  std::vector<void*> free_;
};

}  // namespace uplink::front
