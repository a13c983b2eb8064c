#include "server/rpc/query_text.h"

#include <memory>
#include <string>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/timestamp.pb.h>
#include <gtest/gtest.h>

#include "server/rpc/fleet_methods.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::rpc {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

TEST(QueryText, AnEmptyRequestAsksForEverything) {
  EXPECT_EQ(QueryOf(v1::ListRobotsRequest()), "");
}

TEST(QueryText, EachFieldThatIsSetStandsUnderItsNameInJson) {
  v1::ListRobotsRequest request;
  request.set_fleet("north & south");
  request.set_page_size(-3);
  request.add_parts("motion");
  request.add_parts("agentInfo");
  request.mutable_offline_before()->set_seconds(1);
  request.set_battery_below(0);
  request.set_estop(false);
  EXPECT_EQ(QueryOf(request),
            "fleet=north%20%26%20south&pageSize=-3&parts=motion%2CagentInfo&"
            "offlineBefore=1970-01-01T00%3A00%3A01Z&batteryBelow=0&estop=false");
}

TEST(QueryText, SeveralRobotsAreSeveralParameters) {
  v1::ListFaultsRequest request;
  request.add_ruri("rcan://a/b");
  request.add_ruri("ä\n");
  request.set_active(true);
  EXPECT_EQ(QueryOf(request), "ruri=rcan%3A%2F%2Fa%2Fb&ruri=%C3%A4%0A&active=true");
}

/// Sets every field of a request to something.
void Fill(Message& request) {
  const auto& fields = *request.GetReflection();
  for (int i = 0; i < request.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = request.GetDescriptor()->field(i);
    SCOPED_TRACE(field->full_name());
    if (field->is_repeated()) {
      ASSERT_EQ(field->cpp_type(), FieldDescriptor::CPPTYPE_STRING);
      fields.AddString(&request, field, "x");
      continue;
    }
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_STRING:
        fields.SetString(&request, field, "x");
        break;
      case FieldDescriptor::CPPTYPE_BOOL:
        fields.SetBool(&request, field, true);
        break;
      case FieldDescriptor::CPPTYPE_INT32:
        fields.SetInt32(&request, field, 1);
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        fields.SetDouble(&request, field, 1);
        break;
      default:
        ASSERT_EQ(field->message_type(), google::protobuf::Timestamp::descriptor());
        fields.MutableMessage(&request, field);
    }
  }
}

TEST(QueryText, HasEveryFieldOfEveryRequest) {
  const auto* service = v1::ListRobotsRequest::descriptor()->file()->FindServiceByName("FleetView");
  for (const PathMethod& row : kViewMethods) {
    const auto* method = service->FindMethodByName(std::string(row.name));
    ASSERT_NE(method, nullptr) << row.name;
    const std::unique_ptr<Message> request(google::protobuf::MessageFactory::generated_factory()
                                               ->GetPrototype(method->input_type())
                                               ->New());
    Fill(*request);
    const std::string query = "&" + QueryOf(*request);
    for (int i = 0; i < method->input_type()->field_count(); ++i) {
      const std::string name = method->input_type()->field(i)->json_name();
      EXPECT_NE(query.find("&" + name + "="), std::string::npos) << row.name << ' ' << name;
    }
  }
}

}  // namespace
}  // namespace uplink::rpc
