#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/limits/key_counts.h"

namespace uplink::rcan {

/// Texts whose memory is used again once their last reader is done. Thread-safe. Hold it by
/// shared_ptr: texts that are being read keep it alive.
class TextPool final : public std::enable_shared_from_this<TextPool> {
 public:
  /// Who reads texts, and how many it may have. A value.
  struct Reader {
    std::string name = {};
    std::size_t out_max = 0;
  };
  /// An unused text, with its previous content; null if `out_max` are in use, or so many as the
  /// reader may have by that reader.
  [[nodiscard]] std::shared_ptr<std::string> Take(std::size_t out_max, const Reader& reader);

 private:
  void GiveBack(std::unique_ptr<std::string> text, const std::string& reader);

  std::mutex mutex_;
  std::vector<std::unique_ptr<std::string>> free_;
  std::size_t out_ = 0;
  /// Those of each reader that has any.
  limits::KeyCounts<std::string> out_by_reader_;
};

}  // namespace uplink::rcan
