#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace uplink::rcan {

/// Texts whose memory is used again once their last reader is done. Thread-safe. Hold it by
/// shared_ptr: texts that are being read keep it alive.
class TextPool final : public std::enable_shared_from_this<TextPool> {
 public:
  /// An unused text, with its previous content; null if `out_max` are in use.
  [[nodiscard]] std::shared_ptr<std::string> Take(std::size_t out_max);

 private:
  void GiveBack(std::unique_ptr<std::string> text);

  std::mutex mutex_;
  std::vector<std::unique_ptr<std::string>> free_;
  std::size_t out_ = 0;
};

}  // namespace uplink::rcan
