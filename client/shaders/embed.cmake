# Writes a C++ file that holds every shader of FOLDER, so that the viewer needs no files at run time.
#   cmake -DFOLDER=client/shaders -DOUTPUT=shader_sources.cpp -P embed.cmake
file(GLOB files ${FOLDER}/*.glsl)
list(SORT files)
set(text "#include \"client/gl/shader_program.h\"\n\nnamespace terrane::gl {\n\n")
string(APPEND text "std::string_view shaderSource(std::string_view fileName) noexcept {\n")
foreach(file ${files})
  get_filename_component(name ${file} NAME)
  file(READ ${file} source)
  string(APPEND text "  if (fileName == \"${name}\") {\n    return R\"glsl(${source})glsl\";\n  }\n")
endforeach()
string(APPEND text "  return {};\n}\n\n}  // namespace terrane::gl\n")
file(WRITE ${OUTPUT} "${text}")
