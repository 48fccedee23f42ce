# Embeds shaders/* into one library, so that a program needs no file beside it.
# Included: kerf_embed_shaders(TARGET) adds a generated source that defines kerf::gl::embedded_shaders().
# Run by the build (cmake -P): writes that source to OUTPUT from the files of FOLDER.

if(CMAKE_SCRIPT_MODE_FILE)
  file(GLOB shaders ${FOLDER}/*.vert ${FOLDER}/*.frag)
  set(rows "")
  foreach(shader ${shaders})
    get_filename_component(name ${shader} NAME)
    file(READ ${shader} text)
    string(APPEND rows "      {\"${name}\", R\"glsl(${text})glsl\"},\n")
  endforeach()
  file(WRITE ${OUTPUT} "#include \"gl/shaders.h\"\n\nnamespace kerf::gl {\n\n"
    "std::span<const Shader> embedded_shaders() {\n  static const Shader shaders[] = {\n${rows}  };\n"
    "  return shaders;\n}\n\n} // namespace kerf::gl\n")
  return()
endif()

function(kerf_embed_shaders target)
  set(script ${PROJECT_SOURCE_DIR}/cmake/embed_shaders.cmake)
  set(folder ${PROJECT_SOURCE_DIR}/shaders)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded_shaders.cc)
  file(GLOB shaders CONFIGURE_DEPENDS ${folder}/*.vert ${folder}/*.frag)
  add_custom_command(OUTPUT ${output} DEPENDS ${script} ${shaders} VERBATIM
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${folder} -DOUTPUT=${output} -P ${script})
  target_sources(${target} PRIVATE ${output})
endfunction()
