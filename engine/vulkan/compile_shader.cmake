# How shaders are built, those of the engine's kernels and those of the viewer alike.
find_program(GLSLANG glslangValidator REQUIRED)
find_program(SPIRV_CROSS spirv-cross REQUIRED)

# embed_shader(SOURCE NAME HEADER [OPTION...]): compiles shaders/SOURCE, anew when an include has changed, and writes it
# as C++ to HEADER: code and interface, as the Shader that is called like NAME with _ for every / and dot.
# Buffers need no binding numbers: they are counted in the order of their declaration. Those of a fragment shader are in
# a set of their own, as it knows nothing of those of its vertex shader.
function(embed_shader source name header)
  set(root ${PROJECT_SOURCE_DIR}/shaders)
  set(script ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/embed_shader.cmake)
  string(MAKE_C_IDENTIFIER ${name} symbol)
  set(spirv ${CMAKE_CURRENT_BINARY_DIR}/shaders/${symbol}.spv)
  set(options ${ARGN})
  if(source MATCHES "\\.frag$")
    list(APPEND options --resource-set-binding 1)
  endif()
  add_custom_command(
    OUTPUT ${spirv}
    COMMAND ${GLSLANG} --quiet --target-env vulkan1.2 --auto-map-bindings -I${root} --depfile ${spirv}.d -V ${options}
      -o ${spirv} ${root}/${source}
    DEPENDS ${root}/${source}
    DEPFILE ${spirv}.d
    COMMENT "Compiling shader ${source} ${ARGN}")
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -D SPIRV_CROSS=${SPIRV_CROSS} -D NAME=${name} -D SYMBOL=${symbol} -D SPIRV=${spirv}
      -D HEADER=${header} -P ${script}
    DEPENDS ${spirv} ${script}
    COMMENT "Embedding shader ${name}")
endfunction()
