#include "schema/rules/path.h"

#include "schema/base/utf8.h"

namespace uplink::schema {

std::string Path::Text() const {
  std::string text = above_ == nullptr ? std::string() : above_->Text();
  if (!name_.empty()) {
    if (!text.empty()) text += '.';
    text += foreign_ ? PrintableUtf8(name_, kKeyBytesMax) : std::string(name_);
  }
  if (index_) {
    text += '[';
    text += std::to_string(*index_);
    text += ']';
  }
  return text;
}

}  // namespace uplink::schema
