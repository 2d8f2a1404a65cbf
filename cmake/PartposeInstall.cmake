# find_package(partpose) after install: partpose::partpose is the whole library.
include(CMakePackageConfigHelpers)
get_property(rooms GLOBAL PROPERTY PARTPOSE_ROOMS)

install(TARGETS partpose ${rooms} EXPORT partposeTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS partpose_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY src/partpose DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.hpp" PATTERN "apps" EXCLUDE PATTERN "testing.hpp" EXCLUDE
        PATTERN "json.hpp" EXCLUDE PATTERN "packet.hpp" EXCLUDE)  # of use within the library alone, which hides its JSON library
install(DIRECTORY configs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/partpose/configs FILES_MATCHING PATTERN "*.json")
install(EXPORT partposeTargets NAMESPACE partpose:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/partpose)
configure_package_config_file(cmake/partposeConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/partposeConfig.cmake
        INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/partpose)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/partposeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/partposeConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/partposeConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/partpose)
