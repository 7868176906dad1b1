# Files of a page become part of the program: makes a C++ source that defines the function
# `std::span<const posefusion::PageAsset> NAME()` (hosts/report/page_asset.hpp).
#   source  variable that receives the path of that source
#   name    of the function
#   ARGN    files, relative to the caller's folder
function(embed_page source name)
  set(text "#include \"hosts/report/page_asset.hpp\"\nnamespace posefusion {\nstatic constexpr PageAsset kFiles[]{\n")
  foreach(path ${ARGN})
    set(file ${CMAKE_CURRENT_SOURCE_DIR}/${path})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(READ ${file} content)
    cmake_path(GET file FILENAME file_name)
    string(APPEND text "{\"${file_name}\", R\"asset(${content})asset\"},\n")
  endforeach()
  string(APPEND text "};\nstd::span<const PageAsset> ${name}() { return kFiles; }\n}\n")
  set(file ${CMAKE_CURRENT_BINARY_DIR}/page_assets.cpp)
  file(GENERATE OUTPUT ${file} CONTENT "${text}")
  set_source_files_properties(${file} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  set(${source} ${file} PARENT_SCOPE)
endfunction()
