# Writes page.cpp: the files of the page, OpenSeadragon with its licence among them, as strings.
# Usage: cmake -DOUT=FILE -DVIEWER=FOLDER -P embed.cmake
set(folder ${CMAKE_CURRENT_LIST_DIR})
set(strings "")
set(table "")
function(embed name type content)
  string(MAKE_C_IDENTIFIER "k_${name}" id)
  string(APPEND strings "constexpr char ${id}[] = R\"latentpage(${content})latentpage\";\n")
  string(APPEND table "    {\"${name}\", \"${type}; charset=utf-8\", {${id}, sizeof ${id} - 1}},\n")
  set(strings "${strings}" PARENT_SCOPE)
  set(table "${table}" PARENT_SCOPE)
endfunction()

file(READ ${folder}/page.html page)
embed("" text/html "${page}")
file(READ ${folder}/page.css style)
embed(page.css text/css "${style}")
file(GLOB modules RELATIVE ${folder} ${folder}/*.js)
foreach(module ${modules})
  file(READ ${folder}/${module} script)
  embed(${module} text/javascript "${script}")
endforeach()
file(READ ${VIEWER}/LICENSE.txt licence)
file(READ ${VIEWER}/build/openseadragon/openseadragon.min.js viewer)
string(REGEX REPLACE "\n//# sourceMappingURL=[^\n]*" "" viewer "${viewer}")
embed(openseadragon.js text/javascript "/*\n${licence}\n*/\n${viewer}")

file(WRITE ${OUT} "// Made by tools/darkroom/page/embed.cmake.
#include \"tools/darkroom/server/page.h\"

namespace latent::darkroom {
namespace {
${strings}constexpr PageFile kFiles[] = {
${table}};
}  // namespace
std::span<const PageFile> page_files() { return kFiles; }
}  // namespace latent::darkroom
")
