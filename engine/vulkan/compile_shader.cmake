# compile_shader(SOURCE SPIRV [OPTION...]): compiles shaders/SOURCE to the file SPIRV, anew when an include has changed.
# Buffers need no binding numbers: they are counted in the order of their declaration.
find_program(GLSLANG glslangValidator REQUIRED)
set(POSEFUSION_SHADERS ${PROJECT_SOURCE_DIR}/shaders)
function(compile_shader source spirv)
  add_custom_command(
    OUTPUT ${spirv}
    COMMAND ${GLSLANG} --quiet --target-env vulkan1.2 --auto-map-bindings -I${POSEFUSION_SHADERS} --depfile ${spirv}.d
      -V ${ARGN} -o ${spirv} ${POSEFUSION_SHADERS}/${source}
    DEPENDS ${POSEFUSION_SHADERS}/${source}
    DEPFILE ${spirv}.d
    COMMENT "Compiling shader ${source} ${ARGN}")
endfunction()
