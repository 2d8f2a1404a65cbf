# partpose_room(NAME rooms and libraries it stands on...)
# One room is one static library of all NAME/*.cpp that are not tests, and one test program of all NAME/*_test.cpp.
# The test program links the room's own list only, so a use of a room above it does not link.
function(partpose_room NAME)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${NAME}/*.cpp)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")

  add_library(partpose_${NAME} STATIC ${sources})
  add_library(partpose::${NAME} ALIAS partpose_${NAME})
  set_target_properties(partpose_${NAME} PROPERTIES EXPORT_NAME ${NAME})
  target_include_directories(partpose_${NAME} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(partpose_${NAME} PUBLIC cxx_std_20)
  target_link_libraries(partpose_${NAME} PUBLIC ${ARGN})
  partpose_compile_options(partpose_${NAME})
  set_property(GLOBAL APPEND PROPERTY PARTPOSE_ROOMS partpose_${NAME})

  if(PARTPOSE_BUILD_TESTS AND tests)
    add_executable(${NAME}_test ${tests})
    target_link_libraries(${NAME}_test PRIVATE partpose::${NAME} GTest::gtest_main)
    target_include_directories(${NAME}_test PRIVATE ${PROJECT_SOURCE_DIR})
    target_compile_definitions(${NAME}_test PRIVATE PARTPOSE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    partpose_compile_options(${NAME}_test)
    gtest_discover_tests(${NAME}_test TEST_PREFIX ${NAME}. DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600)
  endif()
endfunction()

function(partpose_compile_options TARGET)
  # GCC 12 takes vector loads for out of bounds and optional members for uninitialized; they are not.
  target_compile_options(${TARGET} PRIVATE -Wall -Wextra -Wno-sign-compare -Wno-array-bounds -Wno-maybe-uninitialized -fopenmp-simd -fno-math-errno -fno-trapping-math
    $<$<BOOL:${PARTPOSE_WERROR}>:-Werror> ${PARTPOSE_AVX2_FLAGS})
endfunction()
