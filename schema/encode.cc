#include "schema/encode.h"

#include <variant>

#include <capnp/message.h>
#include <capnp/serialize.h>

#include "schema/encode/encode_body.h"

namespace uplink::schema {

std::string Framed(capnp::MessageBuilder& builder) {
  const kj::Array<capnp::word> words = capnp::messageToFlatArray(builder);
  const auto bytes = words.asChars();
  return {bytes.begin(), bytes.size()};
}

std::string Encode(const model::Body& body) {
  capnp::MallocMessageBuilder builder;
  const auto message = builder.initRoot<wire::UplinkMsg>();
  std::visit([&](const auto& member) { EncodeMember(member, message); }, body);
  return Framed(builder);
}

}  // namespace uplink::schema
