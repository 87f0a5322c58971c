# Installs every room of CAROM_LIBRARIES, each as a component that find_package can ask for alone:
#
#   find_package(carom REQUIRED COMPONENTS collision)     # needs glm and Highway; neither TBB nor VTK is looked for
#
# A room's component brings the rooms it links, and asks only for the packages that these rooms need.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(CAROM_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/carom)

# Sorts what a room links into rooms of ours and packages from outside (with VTK's modules as its components).
function(carom_room_needs room out_rooms out_packages out_vtk)
  get_target_property(links carom_${room} LINK_LIBRARIES)
  set(rooms "")
  set(packages "")
  set(vtk "")
  foreach(link IN LISTS links)
    if(link MATCHES "^carom(::|_)(.+)$")
      list(APPEND rooms ${CMAKE_MATCH_2})
    elseif(link MATCHES "^VTK::(.+)$")
      list(APPEND vtk ${CMAKE_MATCH_1})
      list(APPEND packages VTK)
    elseif(link MATCHES "^([A-Za-z0-9_]+)::[A-Za-z0-9_-]+$")
      list(APPEND packages ${CMAKE_MATCH_1})
    elseif(link MATCHES "^\\$<BUILD_INTERFACE:")
      # Only our own sources need it.
    elseif(link)
      message(FATAL_ERROR "carom::${room} links ${link}: CaromInstall.cmake cannot tell which package an installed one needs")
    endif()
  endforeach()
  list(REMOVE_DUPLICATES packages)
  set(${out_rooms} "${rooms}" PARENT_SCOPE)
  set(${out_packages} "${packages}" PARENT_SCOPE)
  set(${out_vtk} "${vtk}" PARENT_SCOPE)
endfunction()

get_property(libraries GLOBAL PROPERTY CAROM_LIBRARIES)
set(CAROM_ROOMS "")
set(CAROM_ROOM_NEEDS "")
foreach(library IN LISTS libraries)
  string(REGEX REPLACE "^carom_" "" room ${library})
  carom_room_needs(${room} rooms packages vtk)
  install(TARGETS ${library} EXPORT carom-${room}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT carom-${room} NAMESPACE carom:: FILE carom-${room}-targets.cmake DESTINATION ${CAROM_CMAKE_DIR})
  list(APPEND CAROM_ROOMS ${room})
  string(APPEND CAROM_ROOM_NEEDS
    "set(_carom_${room}_rooms \"${rooms}\")\n"
    "set(_carom_${room}_packages \"${packages}\")\n"
    "set(_carom_${room}_vtk \"${vtk}\")\n")
endforeach()

configure_package_config_file(cmake/caromConfig.cmake.in ${PROJECT_BINARY_DIR}/caromConfig.cmake
  INSTALL_DESTINATION ${CAROM_CMAKE_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/caromConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/caromConfig.cmake ${PROJECT_BINARY_DIR}/caromConfigVersion.cmake
  DESTINATION ${CAROM_CMAKE_DIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/carom)
