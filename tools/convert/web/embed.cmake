# Writes viewer_assets.cpp: the page's template with OpenSeadragon and its licence put in, as one string.
# Usage: cmake -DOUT=FILE -P embed.cmake
set(folder ${CMAKE_CURRENT_LIST_DIR})
set(package ${folder}/node_modules/openseadragon)
file(READ ${folder}/page.html page)
file(READ ${package}/LICENSE.txt licence)
file(READ ${package}/build/openseadragon/openseadragon.min.js viewer)
string(REGEX REPLACE "\n//# sourceMappingURL=[^\n]*" "" viewer "${viewer}")
string(REPLACE "</script" "<\\/script" viewer "${viewer}")
string(REPLACE "@LICENCE@" "${licence}" page "${page}")
string(REPLACE "@OPENSEADRAGON@" "${viewer}" page "${page}")
file(WRITE ${OUT} "// Made by tools/convert/web/embed.cmake.\n#include \"tools/convert/viewer_page.h\"\n\n\
namespace latent::convert {\nconst char* const kViewerPage = R\"latentpage(${page})latentpage\";\n}\n")
