# How every target of this project is compiled, and the three kinds of target there are.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
# Where programs look for the modules that they load on demand. The build has the folders of an installation, so the same path serves
# both: CMake would pad a path that it means to rewrite with an empty entry, and that is the current folder (tests/packaging).
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
set(CMAKE_INSTALL_RPATH "$ORIGIN/../lib/latent")
set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON)  # libraries that are installed elsewhere than the system's
# Debian's hardening, for what reads strangers' files: checked stacks and buffers, and addresses of functions that are read-only before
# main begins. It costs 1.9 % of the instructions of a render, 1.5 % of develop's. Jumps are checked where the compiler does so by itself:
# programs linked with Debian 12's start files cannot be.
set(hardening "-fstack-protector-strong -fstack-clash-protection")
if(NOT CMAKE_CXX_FLAGS MATCHES "_FORTIFY_SOURCE")  # scripts/package gives its own
  string(APPEND hardening " -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2")
endif()
set(CMAKE_C_FLAGS_RELEASE "-O2 -DNDEBUG ${hardening}")
set(CMAKE_CXX_FLAGS_RELEASE "${CMAKE_C_FLAGS_RELEASE}")
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
add_link_options(-Wl,-z,relro,-z,now)
# The search path of a program serves the libraries of its libraries too, as a bundle needs (scripts/bundle): DT_RPATH, not DT_RUNPATH.
add_link_options(-Wl,--disable-new-dtags)
add_link_options(-Wl,--as-needed)  # a library that no symbol is used of would take its time at every start
if(LATENT_PACKAGE)  # what is shipped leaves out the functions that a program never calls: 4 % of a bundle
  add_compile_options(-ffunction-sections -fdata-sections)
  string(APPEND CMAKE_EXE_LINKER_FLAGS " -Wl,--gc-sections")
endif()
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(CCACHE ccache)
if(CCACHE)
  # Paths count from the top of the clone, so all clones share what was compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE})
endif()

# latent_options: no contraction, so that the same bits come out on every processor (docs/format.md, "Determinism"); on x86 the
# baseline is SSE4.2 with AES and PCLMUL, which is Highway's SSE4 target: faster instructions are chosen at run time. On 64-bit ARM it is
# Highway's NEON target, which includes AES, and the only one: SVE vectors have no size that C++ knows, and our structs hold vectors.
add_library(latent_options INTERFACE)
target_include_directories(latent_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(latent_options INTERFACE LATENT_VERSION="${PROJECT_VERSION}")
target_compile_options(latent_options INTERFACE -ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(latent_options INTERFACE -msse4.2 -maes -mpclmul)
  if(CMAKE_CXX_FLAGS MATCHES "-march=")  # Highway 1.0.3 refuses to be compiled for processors that have this target
    target_compile_definitions(latent_options INTERFACE HWY_DISABLED_TARGETS=HWY_AVX3_DL)
  endif()
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  target_compile_options(latent_options INTERFACE -march=armv8-a+crypto)
  target_compile_definitions(latent_options INTERFACE "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")
endif()
target_compile_options(latent_options INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual)
if(LATENT_WERROR)
  target_compile_options(latent_options INTERFACE -Werror)
endif()

# latent_unity(TARGET): where CMAKE_UNITY_BUILD is set, as in all presets but debug, the sources of TARGET are compiled together,
# eight at a time, and read their headers once: that halves the time of a build (sixteen at a time would save a tenth more, but one source
# that is touched would cost twice as much). So no two sources of a target may define the same name, not even in unnamed namespaces.
function(latent_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 8
    UNITY_BUILD_CODE_BEFORE_INCLUDE "// NOLINTNEXTLINE(bugprone-suspicious-include)")
endfunction()

# latent_alone(a.cpp ...): these sources share a translation unit with no other.
function(latent_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# latent_library(NAME [SHAREABLE] [SOURCES a.cpp ...] [COLD b.cpp ...] LINK latent_base ...): the library of one folder. COLD: sources that
# do little of the work, such as arguments, reports and the meaning of scene files: they are optimised less, which takes a third less of
# the compiler's time. SHAREABLE: fit to be a part of a shared library, which exports none of its names.
function(latent_library name)
  cmake_parse_arguments(ARG "SHAREABLE" "" "SOURCES;COLD;LINK" ${ARGN})
  set(targets ${name})
  add_library(${name} STATIC ${ARG_SOURCES})
  if(ARG_COLD)
    list(APPEND targets ${name}_cold)
    add_library(${name}_cold OBJECT ${ARG_COLD})
    target_compile_options(${name}_cold PRIVATE $<$<CONFIG:Release>:-O1>)
    target_sources(${name} PRIVATE $<TARGET_OBJECTS:${name}_cold>)
  endif()
  foreach(target ${targets})
    if(ARG_SHAREABLE)
      set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    endif()
    set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX)
    target_link_libraries(${target} PUBLIC latent_options ${ARG_LINK})
    latent_unity(${target})
  endforeach()
endfunction()

# latent_tool(VERB [SOURCES arguments.cpp ...] LINK latent_merge ...): the executable latent-VERB from main.cpp and SOURCES. They are not
# worth much of the compiler's time, and are compiled together, for each source that reads CLI11 takes seconds.
function(latent_tool verb)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(latent-${verb} main.cpp ${ARG_SOURCES})
  latent_unity(latent-${verb})
  target_link_libraries(latent-${verb} PRIVATE latent_options latent_cli ${ARG_LINK})
  target_compile_options(latent-${verb} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# latent_test(NAME [TIER tier] SOURCES a.cpp ... LINK latent_x ...): a GoogleTest binary NAME, each of its tests known to CTest by the
# label TIER/NAME. Tiers: quick, the default; statistics, which draws millions of samples; machines, which starts many processes, servers
# or clusters, or needs much memory or disk. `scripts/test quick` runs the first alone.
# Compiled with -O1: a test's own code is compiled more often than it runs. An hour is enough for the longest on a machine ten times
# slower than ours. Tests find the source tree and the tools by tests/support/paths.h.
function(latent_test name)
  cmake_parse_arguments(ARG "" "TIER" "SOURCES;LINK" ${ARGN})
  if(NOT ARG_TIER)
    set(ARG_TIER quick)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  latent_unity(${name})
  target_link_libraries(${name} PRIVATE latent_options ${ARG_LINK} latent_test_paths GTest::gtest_main GTest::gmock)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  gtest_discover_tests(${name} NO_PRETTY_VALUES DISCOVERY_TIMEOUT 600 PROPERTIES TIMEOUT 3600 LABELS ${ARG_TIER}/${name})
endfunction()
