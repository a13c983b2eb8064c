#include "server/relay/served_files.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/config/file_modes.h"
#include "server/identity/authorities.h"
#include "server/identity/server_pair.h"

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

absl::StatusOr<std::unique_ptr<ServedFiles>> ServedFiles::Make(const PemFiles& files) {
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
  const auto certificate = identity::ReadPem(files_.certificate);
  if (!certificate.ok()) return certificate.status();
  const auto key = identity::ReadPem(files_.key);
  if (!key.ok()) return key.status();
  const auto client_ca = identity::ReadPem(files_.client_ca);
  if (!client_ca.ok()) return client_ca.status();
  // Whoever may write them chooses which robots are let in. After they were read: what is
  // checked before may be written in between.
  for (const std::string& path : {files_.certificate, files_.key, files_.client_ca}) {
    if (absl::Status good = config::CheckWriters(path); !good.ok()) return good;
  }
  const std::array<std::string, kFiles> texts = {certificate->text, key->text, client_ca->text};
  if (texts == texts_) return absl::OkStatus();
  if (absl::Status fit = identity::CheckServerPair(*certificate, *key); !fit.ok()) return fit;
  if (absl::Status good = identity::CheckAuthorities(*client_ca); !good.ok()) return good;
  const auto expiry = identity::ExpiryOf(*certificate);
  if (!expiry.ok()) return expiry.status();
  if (absl::Status replaced = Replace(texts); !replaced.ok()) return replaced;
  expiry_ = *expiry;
  texts_ = texts;
  return absl::OkStatus();
}

absl::Status ServedFiles::Replace(const std::array<std::string, kFiles>& texts) {
  for (std::size_t i = 0; i < kFiles; ++i) {
    if (texts[i] == texts_[i]) continue;
    const auto fresh = MemoryFile(texts[i]);
    if (!fresh.ok()) return fresh.status();
    if (descriptors_[i] < 0) {
      descriptors_[i] = *fresh;
      continue;
    }
    const bool swapped = dup3(*fresh, descriptors_[i], O_CLOEXEC) >= 0;
    absl::Status failed = swapped ? absl::OkStatus() : SystemError("dup3");
    close(*fresh);
    if (!swapped) return failed;
  }
  const auto path = [this](std::size_t i) {
    return fmt::format("/proc/self/fd/{}", descriptors_[i]);
  };
  paths_ = {.certificate = path(0), .key = path(1), .client_ca = path(2)};
  return absl::OkStatus();
}

}  // namespace uplink::relay
