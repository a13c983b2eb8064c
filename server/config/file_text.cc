#include "server/config/file_text.h"

#include <cerrno>
#include <fstream>

#include <fmt/core.h>
#include <sys/stat.h>

#include "schema/base/unread.h"

namespace uplink::config {

FileText ReadFileText(const std::string& path, std::size_t bytes_max) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {{}, UnreadText(path, errno)};
  if (S_ISDIR(status.st_mode)) return {{}, UnreadText(path, EISDIR)};
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return {{}, UnreadText(path, errno)};
  std::string text(bytes_max + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) return {{}, UnreadText(path, errno)};
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() <= bytes_max) return {std::move(text), {}};
  return {{}, fmt::format("is larger than {} bytes; name the right file", bytes_max)};
}

}  // namespace uplink::config
