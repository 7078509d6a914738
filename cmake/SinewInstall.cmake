# cmake --install: the program, the report's program, the libraries, their headers, and find_package(sinew).
include(CMakePackageConfigHelpers)

set(sinew_headers ${CMAKE_INSTALL_INCLUDEDIR}/sinew)
foreach(folder base datasets models identify problems)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${sinew_headers} FILES_MATCHING PATTERN "*.h")
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/sinew DESTINATION ${sinew_headers} FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_SOURCE_DIR}/cli/run_command_line.h DESTINATION ${sinew_headers}/cli)

install(TARGETS sinew_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/cli/report DESTINATION ${CMAKE_INSTALL_DATADIR}/sinew
        FILES_MATCHING PATTERN "*.py" PATTERN "*.j2" PATTERN "__pycache__" EXCLUDE)

get_property(libraries GLOBAL PROPERTY SINEW_LIBRARIES)
install(TARGETS sinew_compiler ${libraries} EXPORT sinewTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT sinewTargets NAMESPACE sinew:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sinew)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/sinewConfig.cmake.in ${PROJECT_BINARY_DIR}/sinewConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sinew)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sinewConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sinewConfig.cmake ${PROJECT_BINARY_DIR}/sinewConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/SinewDependencies.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sinew)
