#include <utility>

#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

namespace uplink::schema {

std::optional<model::Value> JudgeValue(Violations& violations, const Path& path,
                                       wire::Value::Reader in) {
  switch (in.which()) {
    case wire::Value::STRING: {
      auto text = Text(violations, path, View(in.getString()), kDescriptionBytesMax);
      if (!text) return std::nullopt;
      return model::Value(*std::move(text));
    }
    case wire::Value::INT:
      return model::Value(in.getInt());
    case wire::Value::NUMBER: {
      const auto number = Finite(violations, path, in.getNumber());
      if (!number) return std::nullopt;
      return model::Value(*number);
    }
    case wire::Value::BOOL:
      return model::Value(in.getBool());
    case wire::Value::ENUM: {
      auto name = Text(violations, path, View(in.getEnum()), kDescriptionBytesMax);
      if (!name) return std::nullopt;
      return model::Value(model::EnumName{*std::move(name)});
    }
  }
  violations.Content(UnknownVariant(path, static_cast<unsigned>(in.which())));
  return std::nullopt;
}

}  // namespace uplink::schema
