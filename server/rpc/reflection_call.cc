#include "server/rpc/reflection_call.h"

#include <set>
#include <string>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include "grpc/health/v1/health.pb.h"
#include "grpc/reflection/v1/reflection.pb.h"
#include "grpc/reflection/v1alpha/reflection.pb.h"
#include "uplink/v1/admin.pb.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::rpc {
namespace {

namespace reflection = ::grpc::reflection::v1;
using google::protobuf::DescriptorPool;
using google::protobuf::FileDescriptor;

/// The files whose services are served. Naming a message of each links it.
std::array<const FileDescriptor*, 5> ServedFiles() {
  return {v1::ListRobotsRequest::descriptor()->file(), v1::ReloadRequest::descriptor()->file(),
          ::grpc::health::v1::HealthCheckRequest::descriptor()->file(),
          reflection::ServerReflectionRequest::descriptor()->file(),
          ::grpc::reflection::v1alpha::ServerReflectionRequest::descriptor()->file()};
}

/// The file, then those that it imports, each once.
// NOLINTNEXTLINE(misc-no-recursion): imports have no circles
void AddFile(const FileDescriptor& file, std::set<const FileDescriptor*>& added,
             reflection::FileDescriptorResponse& files) {
  if (!added.insert(&file).second) return;
  google::protobuf::FileDescriptorProto proto;
  file.CopyTo(&proto);
  // Readers look for what they asked for in the first one.
  files.add_file_descriptor_proto(proto.SerializeAsString());
  for (int i = 0; i < file.dependency_count(); ++i) AddFile(*file.dependency(i), added, files);
}

void TellFile(const FileDescriptor* file, reflection::ServerReflectionResponse& response) {
  if (file == nullptr) {
    response.mutable_error_response()->set_error_code(
        static_cast<int>(absl::StatusCode::kNotFound));
    response.mutable_error_response()->set_error_message("there is no such name here");
    return;
  }
  std::set<const FileDescriptor*> added;
  AddFile(*file, added, *response.mutable_file_descriptor_response());
}

reflection::ServerReflectionResponse AnswerTo(const reflection::ServerReflectionRequest& request) {
  using Asks = reflection::ServerReflectionRequest;
  const DescriptorPool& pool = *DescriptorPool::generated_pool();
  reflection::ServerReflectionResponse response;
  response.set_valid_host(request.host());
  *response.mutable_original_request() = request;
  switch (request.message_request_case()) {
    case Asks::kListServices:
      for (const FileDescriptor* file : ServedFiles()) {
        for (int i = 0; i < file->service_count(); ++i) {
          response.mutable_list_services_response()->add_service()->set_name(
              file->service(i)->full_name());
        }
      }
      break;
    case Asks::kFileByFilename:
      TellFile(pool.FindFileByName(request.file_by_filename()), response);
      break;
    case Asks::kFileContainingSymbol:
      TellFile(pool.FindFileContainingSymbol(request.file_containing_symbol()), response);
      break;
    case Asks::kAllExtensionNumbersOfType:
      // The contract extends no message.
      response.mutable_all_extension_numbers_response()->set_base_type_name(
          request.all_extension_numbers_of_type());
      break;
    case Asks::kFileContainingExtension:
    case Asks::MESSAGE_REQUEST_NOT_SET:
      TellFile(nullptr, response);
      break;
  }
  return response;
}

}  // namespace

void ReflectionCall::OnMessage(std::string_view bytes) {
  reflection::ServerReflectionRequest request;
  if (!request.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return call_.Finish(absl::InvalidArgumentError("the question is no ServerReflectionRequest"));
  }
  call_.Write(transport::WithPrefix(AnswerTo(request)));
}

void ReflectionCall::OnTooLarge(std::uint64_t /*bytes*/) {
  call_.Finish(absl::ResourceExhaustedError("the question is too large"));
}

void ReflectionCall::OnDrain(milliseconds /*grace*/) {
  call_.Finish(absl::UnavailableError("the connection ends; ask again"));
}

}  // namespace uplink::rpc
