#include "tests/unit/server/view/heap_use.h"

#include <atomic>
#include <cstdlib>
#include <new>

#include <malloc.h>

namespace {

std::atomic<std::size_t> held{0};
std::atomic<std::size_t> peak{0};

void Free(void* memory) {
  held -= malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

// In a file of its own: where they were inlined beside a `new`, the compiler would take malloc and
// free for a mismatch.
void* operator new(std::size_t size) {
  void* const memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) std::abort();
  const std::size_t now = held += malloc_usable_size(memory);
  std::size_t most = peak.load();
  while (now > most && !peak.compare_exchange_weak(most, now)) {
  }
  return memory;
}
void operator delete(void* memory) noexcept { Free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { Free(memory); }

namespace uplink::view {

std::size_t HeapBytes() { return held.load(); }
std::size_t HeapBytesPeak() { return peak.load(); }
void BeginPeak() { peak.store(held.load()); }

}  // namespace uplink::view
