#include "server/rcan/text_pool.h"

#include <utility>

namespace uplink::rcan {

std::shared_ptr<std::string> TextPool::Take(std::size_t out_max) {
  std::unique_ptr<std::string> text;
  {
    const std::lock_guard lock(mutex_);
    if (out_ >= out_max) return nullptr;
    ++out_;
    if (!free_.empty()) {
      text = std::move(free_.back());
      free_.pop_back();
    }
  }
  if (text == nullptr) text = std::make_unique<std::string>();
  return {text.release(), [pool = shared_from_this()](std::string* done) {
            pool->GiveBack(std::unique_ptr<std::string>(done));
          }};
}

void TextPool::GiveBack(std::unique_ptr<std::string> text) {
  const std::lock_guard lock(mutex_);
  --out_;
  free_.push_back(std::move(text));
}

}  // namespace uplink::rcan
