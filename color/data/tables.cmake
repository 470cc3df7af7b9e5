# Turns the CSV tables of this folder into one C++ source, at build time: cmake -DOUT=tables.cpp -P tables.cmake
# A table is: `#` comments, one line of column names, rows of numbers. Everything is copied, nothing is rounded.
file(GLOB files ${CMAKE_CURRENT_LIST_DIR}/*.csv)
set(arrays "")
set(list "")
foreach(file IN LISTS files)
  get_filename_component(name ${file} NAME_WE)
  file(STRINGS ${file} lines REGEX "^[^#]")
  list(POP_FRONT lines header)
  string(REPLACE "," "\", \"" columns "${header}")
  list(JOIN lines ",\n    " values)
  string(MAKE_C_IDENTIFIER ${name} id)
  string(APPEND arrays "constexpr std::string_view columns_${id}[] = {\"${columns}\"};\nconstexpr double values_${id}[] = {\n    ${values}};\n")
  string(APPEND list "    {\"${name}\", columns_${id}, values_${id}},\n")
endforeach()
file(WRITE ${OUT}.new "// Made by color/data/tables.cmake from color/data/*.csv.
#include \"color/tables.h\"

namespace latent::color {
namespace {

${arrays}
constexpr Table kTables[] = {
${list}};

}  // namespace

std::span<const Table> tables() { return kTables; }

}  // namespace latent::color
")
file(COPY_FILE ${OUT}.new ${OUT} ONLY_IF_DIFFERENT)
file(REMOVE ${OUT}.new)
