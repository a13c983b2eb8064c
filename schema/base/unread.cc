#include "schema/base/unread.h"

#include <cerrno>
#include <system_error>

namespace uplink {
namespace {

const char* RemedyOf(const std::string& path, int error) {
  const bool absolute = path.starts_with('/');
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return absolute ? "; correct the path, or make the file"
                      : "; correct the path, which starts at the working directory, or make the "
                        "file";
    case EACCES:
    case EPERM:
      return "; let this user read it";
    case EISDIR:
      return "; name a file";
    case EMFILE:
    case ENFILE:
      return "; allow more open files";
    default:
      return "";
  }
}

}  // namespace

std::string UnreadText(const std::string& path, int error) {
  return "cannot be read: " + std::generic_category().message(error) + RemedyOf(path, error);
}

}  // namespace uplink
