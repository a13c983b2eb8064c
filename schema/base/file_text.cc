#include "schema/base/file_text.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/base/unread.h"

namespace uplink {
namespace {

FileText ReadOpen(const std::string& path, int file, std::size_t bytes_max) {
  struct stat status {};
  if (fstat(file, &status) != 0) return {{}, UnreadText(path, errno)};
  if (S_ISDIR(status.st_mode)) return {{}, UnreadText(path, EISDIR)};
  if (!S_ISREG(status.st_mode)) return {{}, "is not a regular file; name one"};
  std::string text(bytes_max + 1, '\0');
  std::size_t size = 0;
  while (size < text.size()) {
    const ssize_t n = read(file, text.data() + size, text.size() - size);
    if (n < 0) return {{}, UnreadText(path, errno)};
    if (n == 0) break;
    size += static_cast<std::size_t>(n);
  }
  text.resize(size);
  if (size <= bytes_max) return {std::move(text), {}};
  return {{}, "is larger than " + std::to_string(bytes_max) + " bytes; name the right file"};
}

}  // namespace

FileText ReadFileText(const std::string& path, std::size_t bytes_max) {
  // If it is a pipe, do not wait for its writer.
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return {{}, UnreadText(path, errno)};
  FileText text = ReadOpen(path, file, bytes_max);
  close(file);
  return text;
}

}  // namespace uplink
