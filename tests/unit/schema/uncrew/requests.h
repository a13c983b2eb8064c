#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

#include "schema/base/check.h"
#include "schema/model/uncrew/types.h"
#include "uncrew/v1/avatar.pb.h"

namespace uplink::uncrew::test {

/// The bytes of the request of that type which `text` spells in protobuf's text format.
inline std::string RequestOf(model::uncrew::SampleType type, std::string_view text) {
  namespace pb = google::protobuf;
  // By a message of the contract's file, so that its descriptors are linked.
  const pb::Descriptor* descriptor =
      ::uncrew::v1::Metadata::descriptor()->file()->FindMessageTypeByName(
          std::string(model::uncrew::RowOf(type).method) + "Request");
  UPLINK_CHECK(descriptor != nullptr, "the contract has a request for each type");
  const std::unique_ptr<pb::Message> request(
      pb::MessageFactory::generated_factory()->GetPrototype(descriptor)->New());
  UPLINK_CHECK(pb::TextFormat::MergeFromString(std::string(text), request.get()),
               "the text is a request of that type");
  return request->SerializeAsString();
}

}  // namespace uplink::uncrew::test
