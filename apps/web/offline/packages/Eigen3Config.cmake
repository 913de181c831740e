# Headers alone; the folder of headers is on the path of the compiler (tools/make-offline-page).
if(NOT TARGET Eigen3::Eigen)
  add_library(Eigen3::Eigen INTERFACE IMPORTED)
endif()
