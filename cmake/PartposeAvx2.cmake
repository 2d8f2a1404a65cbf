# Sets PARTPOSE_AVX2_FLAGS. AUTO asks the processor of the machine that builds; OFF gives a binary for any x86-64 (or
# other) machine. Eigen's alignment is fixed at 16 bytes either way, so that a consumer built without AVX2 links safely.
include(CheckCXXSourceRuns)
set(PARTPOSE_AVX2_FLAGS "")
if(PARTPOSE_AVX2 STREQUAL "AUTO" AND NOT CMAKE_CROSSCOMPILING)
  check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") ? 0 : 1; }"
                        PARTPOSE_MACHINE_HAS_AVX2)
endif()
if(PARTPOSE_AVX2 STREQUAL "ON" OR (PARTPOSE_AVX2 STREQUAL "AUTO" AND PARTPOSE_MACHINE_HAS_AVX2))
  set(PARTPOSE_AVX2_FLAGS -mavx2 -mfma)
endif()
message(STATUS "partpose: AVX2 flags: ${PARTPOSE_AVX2_FLAGS}")
