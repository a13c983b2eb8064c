#include "server/identity/pem_file.h"

#include <array>
#include <cerrno>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/base/unread.h"

namespace uplink::identity {
namespace {

/// How many bytes are read at once.
constexpr std::size_t kReadBytes = std::size_t{16} * 1024;

absl::Status Unfit(const std::string& path, const std::string& text) {
  return absl::FailedPreconditionError(fmt::format("{}: {}", path, text));
}

absl::Status Unread(const std::string& path, int error) {
  return Unfit(path, UnreadText(path, error));
}

absl::StatusOr<NamedPem> ReadOpen(const std::string& path, int file) {
  struct stat info {};
  if (fstat(file, &info) != 0) return Unread(path, errno);
  if (!S_ISREG(info.st_mode)) return Unfit(path, "is not a regular file; name a PEM file");
  NamedPem pem{path, {}};
  // The text grows as it is read: a small file takes little memory.
  std::array<char, kReadBytes> piece{};
  while (pem.text.size() <= kPemBytesMax) {
    const ssize_t n = read(file, piece.data(), piece.size());
    if (n < 0) return Unread(path, errno);
    if (n == 0) return pem;
    pem.text.append(piece.data(), static_cast<std::size_t>(n));
  }
  return Unfit(path, fmt::format("is larger than {} bytes; name the right PEM file", kPemBytesMax));
}

}  // namespace

absl::StatusOr<NamedPem> ReadPem(const std::string& path) {
  // If it is a pipe, do not wait for its writer.
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return Unread(path, errno);
  absl::StatusOr<NamedPem> pem = ReadOpen(path, file);
  close(file);
  return pem;
}

}  // namespace uplink::identity
