#include "server/relay/served_files.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

namespace uplink::relay {
namespace {

absl::Status SystemError(const char* what) {
  return absl::InternalError(
      fmt::format("{}: {}", what, std::error_code(errno, std::generic_category()).message()));
}

/// A memory file that holds the text.
absl::StatusOr<int> MemoryFile(const std::string& text) {
  const int fd = memfd_create("uplinkd-pem", MFD_CLOEXEC);
  if (fd < 0) return SystemError("memfd_create");
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = write(fd, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      absl::Status failed = SystemError("write to a memory file");
      close(fd);
      return failed;
    }
    written += static_cast<std::size_t>(n);
  }
  return fd;
}

}  // namespace

absl::StatusOr<std::unique_ptr<ServedFiles>> ServedFiles::Make(const transport::PemFiles& files) {
  std::unique_ptr<ServedFiles> served(new ServedFiles(files));
  if (absl::Status status = served->Refresh(); !status.ok()) return status;
  return served;
}

ServedFiles::~ServedFiles() {
  for (const int fd : descriptors_) {
    if (fd >= 0) close(fd);
  }
}

absl::Status ServedFiles::Refresh() {
  const auto fresh = files_.Refresh();
  if (!fresh.ok()) return fresh.status();
  if (!*fresh && served_) return absl::OkStatus();
  const transport::PemTexts& texts = files_.texts();
  absl::Status replaced = Replace({texts.certificate, texts.key, texts.client_ca});
  served_ = replaced.ok();
  return replaced;
}

absl::Status ServedFiles::Replace(const std::array<std::string, kFiles>& texts) {
  for (std::size_t i = 0; i < kFiles; ++i) {
    if (texts[i] == texts_[i]) continue;
    const auto fresh = MemoryFile(texts[i]);
    if (!fresh.ok()) return fresh.status();
    if (descriptors_[i] < 0) {
      descriptors_[i] = *fresh;
    } else {
      const bool swapped = dup3(*fresh, descriptors_[i], O_CLOEXEC) >= 0;
      absl::Status failed = swapped ? absl::OkStatus() : SystemError("dup3");
      close(*fresh);
      if (!swapped) return failed;
    }
    texts_[i] = texts[i];
  }
  const auto path = [this](std::size_t i) {
    return fmt::format("/proc/self/fd/{}", descriptors_[i]);
  };
  paths_ = {.certificate = path(0), .key = path(1), .client_ca = path(2)};
  return absl::OkStatus();
}

}  // namespace uplink::relay
