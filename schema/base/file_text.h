#pragma once

#include <cstddef>
#include <string>

namespace uplink {

/// A file's text, or why it cannot be had: a sentence without the path.
struct FileText {
  std::string text;
  std::string problem;
};

/// Reads a regular file of at most `bytes_max`.
///
/// Thread: any; blocks on the file, never on a pipe.
[[nodiscard]] FileText ReadFileText(const std::string& path, std::size_t bytes_max);

}  // namespace uplink
