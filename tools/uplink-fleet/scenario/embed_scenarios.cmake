# cmake -DOUTPUT=x.cc -DFILES=a.toml,b.toml -P embed_scenarios.cmake
# Writes the scenario files as one C++ source, so that their names are known wherever the program runs.
string(REPLACE "," ";" FILES "${FILES}")
set(TEXT "#include \"tools/uplink-fleet/scenario/scenario_files.h\"\n\nnamespace uplink::synthetic {\nnamespace {\n\n")
string(APPEND TEXT "constexpr ScenarioFile kFiles[] = {\n")
foreach(FILE IN LISTS FILES)
  get_filename_component(NAME "${FILE}" NAME_WE)
  file(READ "${FILE}" TOML)
  string(APPEND TEXT "    {\"${NAME}\", R\"scenario(${TOML})scenario\"},\n")
endforeach()
string(APPEND TEXT "};\n\n}  // namespace\n\nstd::span<const ScenarioFile> ScenarioFiles() { return kFiles; }\n\n")
string(APPEND TEXT "}  // namespace uplink::synthetic\n")
file(WRITE "${OUTPUT}" "${TEXT}")
