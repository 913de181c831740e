# The headers of the small solver alone; the library of the large one is not used.
if(NOT TARGET Ceres::ceres)
  add_library(Ceres::ceres INTERFACE IMPORTED)
endif()
