#include "server/rcan/text_pool.h"

#include <utility>

namespace uplink::rcan {

std::shared_ptr<std::string> TextPool::Take(std::size_t out_max, const Reader& reader) {
  std::unique_ptr<std::string> text;
  {
    const std::lock_guard lock(mutex_);
    if (out_ >= out_max || out_by_reader_.Of(reader.name) >= reader.out_max) return nullptr;
    ++out_;
    out_by_reader_.Add(reader.name);
    if (!free_.empty()) {
      text = std::move(free_.back());
      free_.pop_back();
    }
  }
  if (text == nullptr) text = std::make_unique<std::string>();
  return {text.release(), [pool = shared_from_this(), name = reader.name](std::string* done) {
            pool->GiveBack(std::unique_ptr<std::string>(done), name);
          }};
}

void TextPool::GiveBack(std::unique_ptr<std::string> text, const std::string& reader) {
  const std::lock_guard lock(mutex_);
  --out_;
  out_by_reader_.Drop(reader);
  free_.push_back(std::move(text));
}

}  // namespace uplink::rcan
