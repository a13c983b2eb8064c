#include "schema/rules/path.h"

#include "schema/base/utf8.h"

namespace uplink::schema {

std::string Path::Text(Keys keys) const {
  std::string text = above_ == nullptr ? std::string() : above_->Text(keys);
  if (!name_.empty()) {
    if (!text.empty()) text += '.';
    if (!foreign_) {
      text += name_;
    } else if (keys == Keys::kShown) {
      text += PrintableUtf8(name_, kKeyBytesMax);
    } else {
      text += '*';
    }
  }
  if (index_) {
    text += '[';
    text += std::to_string(*index_);
    text += ']';
  }
  return text;
}

}  // namespace uplink::schema
