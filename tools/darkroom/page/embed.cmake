# Writes page.cpp: the files of the page, OpenSeadragon with its licence among them, as strings.
# Usage: cmake -DOUT=FILE -DVIEWER=FOLDER -P embed.cmake
set(folder ${CMAKE_CURRENT_LIST_DIR})
file(READ ${VIEWER}/LICENSE.txt licence)
file(READ ${VIEWER}/build/openseadragon/openseadragon.min.js viewer)
string(REGEX REPLACE "\n//# sourceMappingURL=[^\n]*" "" viewer "${viewer}")
set(viewer "/*\n${licence}\n*/\n${viewer}")
file(READ ${folder}/page.html page)
file(READ ${folder}/page.css style)
foreach(module page plot ruler)
  file(READ ${folder}/${module}.js ${module}_js)
endforeach()
set(text "// Made by tools/darkroom/page/embed.cmake.\n#include \"tools/darkroom/server/page.h\"\n\nnamespace latent::darkroom {\nnamespace {\n")
foreach(name page style page_js plot_js ruler_js viewer)
  string(APPEND text "constexpr char k_${name}[] = R\"latentpage(${${name}})latentpage\";\n")
endforeach()
file(WRITE ${OUT} "${text}constexpr PageFile kFiles[] = {{\"\", \"text/html; charset=utf-8\", {k_page, sizeof k_page - 1}},
    {\"page.css\", \"text/css; charset=utf-8\", {k_style, sizeof k_style - 1}},
    {\"page.js\", \"text/javascript; charset=utf-8\", {k_page_js, sizeof k_page_js - 1}},
    {\"plot.js\", \"text/javascript; charset=utf-8\", {k_plot_js, sizeof k_plot_js - 1}},
    {\"ruler.js\", \"text/javascript; charset=utf-8\", {k_ruler_js, sizeof k_ruler_js - 1}},
    {\"openseadragon.js\", \"text/javascript; charset=utf-8\", {k_viewer, sizeof k_viewer - 1}}};
}  // namespace
std::span<const PageFile> page_files() { return kFiles; }
}  // namespace latent::darkroom\n")
