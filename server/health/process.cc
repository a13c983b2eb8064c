#include "server/health/process.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <system_error>

#include <sys/resource.h>
#include <sys/sysinfo.h>
#include <unistd.h>

#include "server/health/memory_limit.h"

namespace uplink::health {
namespace {

std::size_t Cap(rlim_t limit) {
  return limit == RLIM_INFINITY ? std::numeric_limits<std::int32_t>::max()
                                : static_cast<std::size_t>(limit);
}

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6;
}

/// Entries of a folder of /proc; 0 if it cannot be read.
std::size_t Entries(const char* folder) {
  std::error_code error;
  std::size_t count = 0;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    ++count;
  }
  return count;
}

}  // namespace

ProcessFigures ReadProcess() {
  ProcessFigures figures;
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) {
    figures.cpu_seconds = Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
  }
  std::ifstream statm("/proc/self/statm");
  std::size_t total_pages = 0;
  std::size_t resident_pages = 0;
  if (statm >> total_pages >> resident_pages) {
    const auto page_bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    figures.resident_bytes = resident_pages * page_bytes;
    figures.virtual_bytes = total_pages * page_bytes;
  }
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    figures.virtual_max_bytes = limit.rlim_cur;
  }
  figures.threads = Entries("/proc/self/task");
  return figures;
}

std::size_t OpenDescriptors() {
  const std::size_t entries = Entries("/proc/self/fd");
  // One of them is the folder while it is read.
  return entries == 0 ? 0 : entries - 1;
}

std::size_t DescriptorsMax() {
  rlimit limit{};
  return getrlimit(RLIMIT_NOFILE, &limit) == 0 ? Cap(limit.rlim_cur) : 0;
}

std::size_t MemoryMax() {
  struct sysinfo machine {};
  if (sysinfo(&machine) != 0) return 0;
  return MemoryLimit(GroupFiles(), std::size_t{machine.totalram} * machine.mem_unit);
}

std::size_t RaiseDescriptorsMax() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < limit.rlim_max) {
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
  }
  return DescriptorsMax();
}

}  // namespace uplink::health
