# One call a room: its sources, its public headers, the rooms it may use and the third-party libraries it alone may see.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_VERIFY_INTERFACE_HEADER_SETS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
        CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${CCACHE_PROGRAM})
endif()

add_library(handpiece_options INTERFACE)
# No contraction, no fast-math: the same inputs give the same tooth, bit for bit.
target_compile_options(handpiece_options INTERFACE
    $<BUILD_INTERFACE:-Wall -Wextra -Wpedantic -Wshadow -Wno-psabi -ffp-contract=off>)
# Makes a fault in a reader of files harder to use. What the loader has written is read-only in every build; the checks
# of stacks and of lengths are for what is shipped, since an object that has them is another than one that has not.
if(NOT HANDPIECE_SANITIZE)
    # What a room is built with and this program does not use (PostgreSQL, by a station) is no need of it.
    target_link_options(handpiece_options INTERFACE $<BUILD_INTERFACE:LINKER:--as-needed,-z,relro,-z,now>
        $<BUILD_INTERFACE:$<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-pie>>)
endif()
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT HANDPIECE_SANITIZE)
    target_compile_options(handpiece_options INTERFACE $<BUILD_INTERFACE:-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2
        -fstack-protector-strong -fstack-clash-protection>)
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
        target_compile_options(handpiece_options INTERFACE $<BUILD_INTERFACE:-fcf-protection>)
    endif()
endif()
if(HANDPIECE_SANITIZE)
    target_compile_options(handpiece_options INTERFACE
        $<BUILD_INTERFACE:-fsanitize=${HANDPIECE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all>)
    target_link_options(handpiece_options INTERFACE $<BUILD_INTERFACE:-fsanitize=${HANDPIECE_SANITIZE}>)
    target_compile_definitions(handpiece_options INTERFACE $<BUILD_INTERFACE:HANDPIECE_SANITIZED=1>)
endif()

# Compiles SOURCE once per instruction set; each copy sees HANDPIECE_SIMD_LEVEL (0 baseline, 2 AVX2, 3 AVX-512) and
# HANDPIECE_SIMD_NS (simd_base, simd_avx2, simd_avx512). The room picks one at run time with core::simdLevel().
function(handpiece_simd_sources target)
    if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
        set(levels "base\;0\;")
    else()
        set(levels "base\;0\;" "avx2\;2\;-mavx2" "avx512\;3\;-mavx512f\\\;-mavx512dq\\\;-mavx512vl\\\;-mavx512bw\\\;-mprefer-vector-width=512")
    endif()
    foreach(level IN LISTS levels)
        list(GET level 0 name)
        list(GET level 1 number)
        list(GET level 2 flags)
        add_library(${target}_${name} OBJECT ${ARGN})
        # No Eigen and no standard containers here: an inline function compiled for AVX-512 could be the one the linker
        # keeps for everybody. Plain data in, plain data out.
        set_target_properties(${target}_${name} PROPERTIES UNITY_BUILD OFF)
        target_link_libraries(${target}_${name} PRIVATE handpiece_options)
        target_include_directories(${target}_${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
        target_compile_definitions(${target}_${name} PRIVATE
            HANDPIECE_SIMD_LEVEL=${number} HANDPIECE_SIMD_NS=simd_${name})
        target_compile_features(${target}_${name} PRIVATE cxx_std_20)
        target_compile_options(${target}_${name} PRIVATE ${flags} -O3)
        target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_${name}>)
    endforeach()
endfunction()

# What waits for people and files, not for the tick: a quarter less to compile at the first level of optimisation.
function(handpiece_off_tick target)
    target_compile_options(${target} PRIVATE -O1)
endfunction()

# Several sources in one: half of what a whole build costs.
option(HANDPIECE_UNITY "Compile several sources at once (off: one file that changed is compiled sooner)" ON)
set(CMAKE_UNITY_BUILD ${HANDPIECE_UNITY})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 8)
if(HANDPIECE_UNITY)
    # The warning is meant for types in headers; GCC takes each source that a unity file includes for one.
    target_compile_options(handpiece_options INTERFACE
        $<BUILD_INTERFACE:$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>>)
endif()
# Sources that call their own helpers as others in their folder do.
function(handpiece_alone)
    set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# HEADERS are public and installed; a room's other headers are its own affair (tools/check_headers.py).
# handpiece_room(wing/room HEADERS ... SOURCES ... USES room... THIRD_PARTY lib... THIRD_PARTY_PUBLIC lib...)
function(handpiece_room path)
    cmake_parse_arguments(R "" "" "HEADERS;SOURCES;USES;THIRD_PARTY;THIRD_PARTY_PUBLIC" ${ARGN})
    get_filename_component(room ${path} NAME)
    set(target handpiece_${room})
    if(R_SOURCES)
        add_library(${target} STATIC ${R_SOURCES})
        set(scope PUBLIC)
    else()
        add_library(${target} INTERFACE)
        set(scope INTERFACE)
    endif()
    add_library(handpiece::${room} ALIAS ${target})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${room})
    target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${R_HEADERS})
    target_compile_features(${target} ${scope} cxx_std_20)
    list(TRANSFORM R_USES PREPEND handpiece::)
    target_link_libraries(${target} ${scope} ${R_USES} ${R_THIRD_PARTY_PUBLIC})
    if(R_SOURCES)
        target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:handpiece_options> ${R_THIRD_PARTY})
        if(NOT room STREQUAL "core")
            target_precompile_headers(${target} REUSE_FROM handpiece_core)
        endif()
    endif()
    set_property(GLOBAL APPEND PROPERTY HANDPIECE_ROOMS ${target})
endfunction()

# Builds a text file into a target: `extern const char* const NAME;` in namespace handpiece::SPACE.
function(handpiece_embed target space name path)
    set(file ${path})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${path})
    file(READ ${PROJECT_SOURCE_DIR}/${path} content)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/embedded.cpp.in ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp @ONLY)
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
endfunction()

# Builds modules of plain JavaScript, in this order, into a target as one: kViewerScript, its SHA-256 in hex as
# kViewerSha256, for a page's content security policy; and a style as kViewerStyle. Their imports of one another fall away.
function(handpiece_embed_viewer target space folder style)
    set(all "")
    foreach(module IN LISTS ARGN)
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/${module})
        file(READ ${PROJECT_SOURCE_DIR}/${folder}/${module} content)
        string(REGEX REPLACE "import [^\n]* from \"\\./[^\n]*\n" "" content "${content}")
        string(REGEX REPLACE "(^|\n)export (async |)(class|function|const) " "\\1\\2\\3 " content "${content}")
        string(APPEND all "${content}")
    endforeach()
    string(SHA256 hash "${all}")
    set(file ${folder})
    foreach(name IN ITEMS kViewerScript kViewerSha256)
        set(content "${all}")
        if(name STREQUAL "kViewerSha256")
            set(content ${hash})
        endif()
        configure_file(${PROJECT_SOURCE_DIR}/cmake/embedded.cpp.in ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp @ONLY)
        target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
    endforeach()
    handpiece_embed(${target} ${space} kViewerStyle ${folder}/${style})
endfunction()

# Tests that take longest, by the clock of two laden cores [s]: CTest starts them first, so that none runs on alone at the
# end. A fresh clone has no history that would tell it.
set(HANDPIECE_LONG_TESTS school_server_test=330 docs_blocks=300 school_server_postgres_test=300 school_robust_test=290
    mouth_test=280 mouth_course_test=280 practice_window_test=230 exercise_window_test=220 marking_window_test=220
    golden_test=190 exam_window_test=190 shell_window_test=190 system_review=190 editor_window_test=170 books_test=160
    system_bad_input=160 system_picture=150 preparation_test=150 live_session_test=140 school_attacks_test=140
    system_score=140 draft_test=120 course_test=120 walk_school=110 lesion_test=100 backup_test=90 real_data_test=90
    marking_kill_test=85 said_window_test=80 system_case=80 tooth_form_test=80 scan_wizard_test=75 school_window_test=75
    system_permissions=75 system_make_mesh=70 device_window_test=70 system_exercise=70 system_trials=70 system_window=70
    packaging=65 result_window_test=65 first_minute_window_test=60 find_landmarks_test=60 scan_work_test=60
    proving_test=55 published_sizes_test=55)
# To be called where the test is added, once it is.
function(handpiece_start_early)
    foreach(name IN LISTS ARGN)
        if(HANDPIECE_LONG_TESTS MATCHES "(^|;)${name}=([0-9]+)")
            set_tests_properties(${name} PROPERTIES COST ${CMAKE_MATCH_2})
        endif()
    endforeach()
endfunction()

# handpiece_test(name SOURCES ... USES room... LIBS lib... LABELS ... [TRAPPED]): a test of CTest, of these sources in the program
# of their wing (the first folder under tests/), WING_tests. TRAPPED: in WING_trapped_tests, where malloc and locks are
# watched. Each source has a namespace of its own: several are compiled at once.
function(handpiece_test name)
    cmake_parse_arguments(T "TRAPPED" "" "SOURCES;USES;LIBS;LABELS" ${ARGN})
    file(RELATIVE_PATH wing ${PROJECT_SOURCE_DIR}/tests ${CMAKE_CURRENT_SOURCE_DIR})
    string(REGEX REPLACE "/.*" "" wing ${wing})
    set(program ${wing}_tests)
    if(T_TRAPPED)
        set(program ${wing}_trapped_tests)
        list(APPEND T_LIBS handpiece_realtime_trap)
    endif()
    set_property(GLOBAL APPEND PROPERTY HANDPIECE_TEST_PROGRAMS ${program})
    set_property(GLOBAL PROPERTY HANDPIECE_PROGRAM_OF_${name} ${program})
    list(TRANSFORM T_USES PREPEND handpiece::)
    foreach(part USES LIBS)
        set_property(GLOBAL APPEND PROPERTY ${program}_${part} ${T_${part}})
    endforeach()
    set(files "")
    foreach(source IN LISTS T_SOURCES)
        cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE OUTPUT_VARIABLE whole)
        set_property(GLOBAL APPEND PROPERTY ${program}_WHOLE ${whole})
        file(RELATIVE_PATH file ${PROJECT_SOURCE_DIR}/tests ${whole})
        list(APPEND files ${file})
    endforeach()
    list(JOIN files "," files)
    set_property(GLOBAL PROPERTY HANDPIECE_SOURCES_OF_${name} ${files})
    handpiece_test_again(${name} OF ${name})
    set_tests_properties(${name} PROPERTIES LABELS "${T_LABELS}")
endfunction()

# handpiece_test_again(name OF test): the same tests under another name, for other properties.
function(handpiece_test_again name of test)
    get_property(program GLOBAL PROPERTY HANDPIECE_PROGRAM_OF_${test})
    get_property(files GLOBAL PROPERTY HANDPIECE_SOURCES_OF_${test})
    add_test(NAME ${name} COMMAND ${program} --sources=${files})
    set_tests_properties(${name} PROPERTIES TIMEOUT 1800)
    handpiece_start_early(${name})
    handpiece_test_by_name(${name} ${program} ${files})
endfunction()

# By hand: ninja mouth_test && build/dev/bin/mouth_test --gtest_filter=...
function(handpiece_test_by_name name program files)
    add_custom_target(${name})
    set_property(GLOBAL APPEND PROPERTY HANDPIECE_NAMED_TESTS ${name} ${program})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/bin/${name} @ONLY
        CONTENT "#!/bin/sh\nexec \"$(dirname \"$0\")/@program@\" --sources=@files@ \"$@\"\n")
    file(CHMOD ${PROJECT_BINARY_DIR}/bin/${name} PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
endfunction()

# handpiece_test_with(name DEFINES ... INCLUDES folder... NEEDS program...): what else the test's program is built with.
function(handpiece_test_with name)
    cmake_parse_arguments(T "" "" "DEFINES;INCLUDES;NEEDS" ${ARGN})
    get_property(program GLOBAL PROPERTY HANDPIECE_PROGRAM_OF_${name})
    foreach(part DEFINES INCLUDES NEEDS)
        set_property(GLOBAL APPEND PROPERTY ${program}_${part} ${T_${part}})
    endforeach()
endfunction()

# The programs of all that handpiece_test() was told.
function(handpiece_test_programs)
    get_property(programs GLOBAL PROPERTY HANDPIECE_TEST_PROGRAMS)
    list(REMOVE_DUPLICATES programs)
    foreach(program IN LISTS programs)
        foreach(part WHOLE USES LIBS DEFINES INCLUDES NEEDS)
            get_property(${part} GLOBAL PROPERTY ${program}_${part})
            list(REMOVE_DUPLICATES ${part})
        endforeach()
        add_executable(${program} ${WHOLE})
        target_link_libraries(${program} PRIVATE handpiece_options ${USES} ${LIBS} handpiece_test_main handpiece_test_support GTest::gmock GTest::gtest)
        target_include_directories(${program} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
        target_include_directories(${program} SYSTEM PRIVATE ${INCLUDES})
        target_compile_definitions(${program} PRIVATE ${DEFINES})
        # As the library whose precompiled header it uses.
        target_compile_options(${program} PRIVATE -fPIC ${HANDPIECE_TEST_FLAGS})
        set_target_properties(${program} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
        target_precompile_headers(${program} REUSE_FROM handpiece_test_support)
        if(NEEDS)
            add_dependencies(${program} ${NEEDS})
        endif()
    endforeach()
    get_property(named GLOBAL PROPERTY HANDPIECE_NAMED_TESTS)
    while(named)
        list(POP_FRONT named name program)
        add_dependencies(${name} ${program})
    endwhile()
endfunction()
