# Run by cmake --install with SOURCE_DIR, WORK_DIR (for files in between) and INCLUDE_DIR: installs posefusion.hpp of
# this folder, and every header that it includes directly or through others, as <posefusion/...>. In the source they
# include "engine/core/image.hpp", installed they include <posefusion/engine/core/image.hpp>. What is in this folder has
# none of its own there: <posefusion/version.hpp>.
cmake_policy(VERSION 3.25)  # an install script has none of its own
file(REMOVE_RECURSE ${WORK_DIR})
set(waiting hosts/library/posefusion.hpp)
set(done "")
while(waiting)
  list(POP_FRONT waiting header)
  list(APPEND done ${header})
  file(READ ${SOURCE_DIR}/${header} text)
  string(REGEX MATCHALL "#include \"[^\"\n]+\"" lines "${text}")
  foreach(line ${lines})
    string(REGEX REPLACE "#include \"(.+)\"" "\\1" included "${line}")
    if(NOT included IN_LIST done AND NOT included IN_LIST waiting)
      list(APPEND waiting ${included})
    endif()
  endforeach()
  string(REGEX REPLACE "#include \"([^\"\n]+)\"" "#include <posefusion/\\1>" text "${text}")
  string(REPLACE "<posefusion/hosts/library/" "<posefusion/" text "${text}")
  string(REPLACE "hosts/library/" "" installed ${header})
  file(WRITE ${WORK_DIR}/posefusion/${installed} "${text}")
endwhile()
file(INSTALL ${WORK_DIR}/posefusion DESTINATION ${INCLUDE_DIR})
