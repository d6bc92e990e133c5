# Language, warnings, floating point and instruction set, for every target.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O2")

# The instruction set fixes the SIMD width, never the bits of a result.
set(GNOMON_ARCH native CACHE STRING "Instruction set: native, x86-64-v2, x86-64-v3, x86-64-v4, armv8-a")
set_property(CACHE GNOMON_ARCH PROPERTY STRINGS native x86-64-v2 x86-64-v3 x86-64-v4 armv8-a)
if(NOT GNOMON_ARCH MATCHES "^(native|x86-64-v[234]|armv8-a)$")
    message(FATAL_ERROR "GNOMON_ARCH is '${GNOMON_ARCH}'; expected native, x86-64-v2, x86-64-v3, x86-64-v4 or armv8-a")
endif()
add_compile_options(-march=${GNOMON_ARCH})
if(GNOMON_ARCH MATCHES "^x86-64-v[34]$")
    # Highway takes AVX2 and AVX-512 only together with these; every processor of these levels has them.
    add_compile_options(-maes -mpclmul)
endif()
add_compile_definitions(HWY_COMPILE_ONLY_STATIC)

# Same bits everywhere: no contraction to fused multiply-add, no fast-math.
add_compile_options(-ffp-contract=off)

add_compile_options(-Wall -Wextra -Wconversion -Wsign-conversion -Wshadow -Werror -Werror=switch)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 warns about Highway's uninitialised vectors and about the layout of vector types across language versions.
    add_compile_options(-Wno-psabi -Wno-maybe-uninitialized -Wno-uninitialized -Wno-ignored-attributes)
endif()

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    # Lane values are 64 bytes on AVX-512: copied in halves they would stall the loads of the whole.
    add_compile_options(-mprefer-vector-width=512 -mmove-max=512 -mstore-max=512)
endif()

if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    add_compile_options(-Wreserved-identifier)
    # clang 19 spells out AVX10 for -march=native on newer processors and then warns about its own spelling.
    add_compile_options(-Wno-invalid-feature-combination)
    # Profiles may flush denormals: clang must not turn comparisons into tests of bits as if nobody did.
    add_compile_options(-fdenormal-fp-math=dynamic)
endif()

set(GNOMON_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize=")
if(GNOMON_SANITIZE)
    add_compile_options(-fsanitize=${GNOMON_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    add_link_options(-fsanitize=${GNOMON_SANITIZE})
endif()

include_directories("${CMAKE_SOURCE_DIR}")

# What most files include is parsed once per build: by gnomon_sim, for everything above it. Every file includes what it uses all
# the same; the linter reads them without (CMAKE_DISABLE_PRECOMPILE_HEADERS). No headers of our own: they would lose their warnings.
set(GNOMON_PRECOMPILED
    <algorithm> <array> <bit> <cmath> <cstddef> <cstdint> <cstdio> <cstring> <filesystem> <functional> <limits> <map> <memory>
    <mutex> <numeric> <optional> <set> <span> <sstream> <string> <string_view> <tuple> <variant> <vector>
    <fmt/format.h> <glm/geometric.hpp> <glm/mat4x4.hpp> <hwy/highway.h> <oneapi/tbb/parallel_for.h> <oneapi/tbb/task_arena.h>)

# One static library per layer; `gnomon_layer(name SOURCES ... LINKS ...)`.
function(gnomon_layer name)
    cmake_parse_arguments(LAYER "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
    add_library(gnomon_${name} STATIC ${LAYER_SOURCES})
    target_link_libraries(gnomon_${name} PUBLIC ${LAYER_LINKS} PRIVATE ${LAYER_PRIVATE_LINKS})
    if(name STREQUAL "sim")
        target_precompile_headers(gnomon_sim PRIVATE ${GNOMON_PRECOMPILED})
    else()
        target_precompile_headers(gnomon_${name} REUSE_FROM gnomon_sim)
    endif()
endfunction()
