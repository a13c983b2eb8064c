#include "server/front/http2/http2_memory.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <nghttp2/nghttp2.h>
#include <sys/mman.h>

namespace uplink::front {
namespace {

/// The header of each block, which keeps it aligned as malloc does.
struct alignas(16) Header {
  std::size_t bytes = 0;
  bool is_piece = false;
};
constexpr std::size_t kHeaderBytes = sizeof(Header);

/// Blocks over the first and up to the second, with their header, are pieces: nghttp2's buffer of a
/// frame has 16,394 bytes.
constexpr std::size_t kPieceBytesMin = 8 * 1024;
constexpr std::size_t kPageBytes = 4096;
constexpr std::size_t kPieceBytes = 5 * kPageBytes;
constexpr std::size_t kPiecesPerSlab = 64;
constexpr std::size_t kSlabBytes = kPiecesPerSlab * kPieceBytes;

char* Bytes(void* memory) { return static_cast<char*>(memory); }

Header& HeaderOf(void* memory) {
  return *static_cast<Header*>(static_cast<void*>(Bytes(memory) - kHeaderBytes));
}

}  // namespace

Http2Memory::Http2Memory() = default;

Http2Memory::~Http2Memory() {
  for (void* slab : slabs_) ::munmap(slab, kSlabBytes);
}

void* Http2Memory::TakePiece() {
  if (free_.empty()) {
    void* slab = ::mmap(nullptr, kSlabBytes, PROT_READ | PROT_WRITE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (slab == MAP_FAILED) return nullptr;
    // A huge page would be touched whole.
    ::madvise(slab, kSlabBytes, MADV_NOHUGEPAGE);
    slabs_.push_back(slab);
    for (std::size_t i = kPiecesPerSlab; i > 0; --i) {
      free_.push_back(Bytes(slab) + (i - 1) * kPieceBytes);
    }
  }
  void* piece = free_.back();
  free_.pop_back();
  return piece;
}

void* Http2Memory::Allocate(std::size_t bytes) {
  const std::size_t whole = bytes + kHeaderBytes;
  const bool is_piece = whole > kPieceBytesMin && whole <= kPieceBytes;
  void* block = is_piece ? TakePiece() : std::malloc(whole);
  if (block == nullptr) return nullptr;
  void* memory = Bytes(block) + kHeaderBytes;
  HeaderOf(memory) = {bytes, is_piece};
  return memory;
}

void Http2Memory::Release(void* memory) {
  if (memory == nullptr) return;
  void* block = Bytes(memory) - kHeaderBytes;
  if (!HeaderOf(memory).is_piece) return std::free(block);
  ::madvise(block, kPieceBytes, MADV_DONTNEED);
  free_.push_back(block);
}

void* Http2Memory::Reallocate(void* memory, std::size_t bytes) {
  if (memory == nullptr) return Allocate(bytes);
  const std::size_t before = HeaderOf(memory).bytes;
  void* moved = Allocate(bytes);
  if (moved == nullptr) return nullptr;
  std::memcpy(moved, memory, std::min(before, bytes));
  Release(memory);
  return moved;
}

nghttp2_mem Http2Memory::functions() {
  return {
      .mem_user_data = this,
      .malloc = [](std::size_t bytes,
                   void* user) { return static_cast<Http2Memory*>(user)->Allocate(bytes); },
      .free = [](void* memory, void* user) { static_cast<Http2Memory*>(user)->Release(memory); },
      .calloc =
          [](std::size_t count, std::size_t size, void* user) {
            void* memory = static_cast<Http2Memory*>(user)->Allocate(count * size);
            if (memory != nullptr) std::memset(memory, 0, count * size);
            return memory;
          },
      .realloc =
          [](void* memory, std::size_t bytes, void* user) {
            return static_cast<Http2Memory*>(user)->Reallocate(memory, bytes);
          }};
}

}  // namespace uplink::front
