# Writes a source that holds a text of the tree, at build time:
# cmake -DINPUT=FILE -DHEADER=openapi_text.h -DFUNCTION=uplink::http::OpenapiText -DOUTPUT=FILE -P embed.cmake.
file(READ "${INPUT}" text)
string(FIND "${text}" ")embedded\"" ends)
if(NOT ends EQUAL -1)
  message(FATAL_ERROR "${INPUT} has what ends the source's string")
endif()
file(WRITE "${OUTPUT}"
     "#include \"${HEADER}\"\n\nstd::string_view ${FUNCTION}() { return R\"embedded(${text})embedded\"; }\n")
