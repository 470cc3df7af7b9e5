# Turns the CSV tables of this folder and of film/ into one C++ source, at build time: cmake -DOUT=tables.cpp -P tables.cmake
# A table is: `#` comments (among them "# what: ..." and "# source: ..."), one line of column names, rows of numbers. Everything is
# copied, nothing is rounded.
# film/materials.csv holds words, and is copied as text.
file(GLOB files RELATIVE ${CMAKE_CURRENT_LIST_DIR} ${CMAKE_CURRENT_LIST_DIR}/*.csv ${CMAKE_CURRENT_LIST_DIR}/film/*.csv)
list(REMOVE_ITEM files film/materials.csv)
file(READ ${CMAKE_CURRENT_LIST_DIR}/film/materials.csv materials)
set(arrays "")
set(list "")

# The text of a comment, as the inside of a C++ string.
function(read_comment key file out)
  file(STRINGS ${file} line REGEX "^# ${key}: " LIMIT_COUNT 1)
  string(REGEX REPLACE "^# ${key}: " "" text "${line}")
  string(REPLACE "\\;" ";" text "${text}")
  string(REPLACE "\"" "\\\"" text "${text}")
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

foreach(file IN LISTS files)
  string(REGEX REPLACE "\\.csv$" "" name ${file})
  set(file ${CMAKE_CURRENT_LIST_DIR}/${file})
  read_comment(what ${file} what)
  read_comment(source ${file} source)
  file(STRINGS ${file} lines REGEX "^[^#]")
  list(POP_FRONT lines header)
  string(REPLACE "," "\", \"" columns "${header}")
  list(JOIN lines ",\n    " values)
  string(MAKE_C_IDENTIFIER ${name} id)
  string(APPEND arrays "constexpr std::string_view columns_${id}[] = {\"${columns}\"};\nconstexpr double values_${id}[] = {\n    ${values}};\n")
  string(APPEND list "    {\"${name}\", \"${what}\",\n     \"${source}\", columns_${id}, values_${id}},\n")
endforeach()
file(WRITE ${OUT}.new "// Made by color/data/tables.cmake from the tables of color/data.
#include \"color/tables.h\"

namespace latent::color {
namespace {

${arrays}
constexpr Table kTables[] = {
${list}};

constexpr std::string_view kMaterials = R\"csv(${materials})csv\";

}  // namespace

std::span<const Table> tables() { return kTables; }
std::string_view film_materials() { return kMaterials; }

}  // namespace latent::color
")
file(COPY_FILE ${OUT}.new ${OUT} ONLY_IF_DIFFERENT)
file(REMOVE ${OUT}.new)
