#include "tests/bench/cyberwave/sink_count.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "schema/base/check.h"

namespace uplink::bench {

SinkCount::SinkCount(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  UPLINK_CHECK(file >= 0 && ftruncate(file, sizeof(Count)) == 0, "a benchmark can make a file");
  void* memory = mmap(nullptr, sizeof(Count), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  UPLINK_CHECK(memory != MAP_FAILED, "a benchmark can map a file");
  close(file);
  // A new file is zero, which is a count of none.
  count_ = static_cast<Count*>(memory);
}

SinkCount::~SinkCount() { munmap(count_, sizeof(Count)); }

}  // namespace uplink::bench
