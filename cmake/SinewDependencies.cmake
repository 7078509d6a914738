# Every library that sinew stands on, in one place; packages.txt names the Debian packages.
find_package(PkgConfig REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(tl-expected REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(pugixml REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(TBB REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C)
# MAT files of MATLAB.
pkg_check_modules(MATIO REQUIRED IMPORTED_TARGET matio)
find_package(ZLIB REQUIRED)
# Headers of Boost.Math alone.
find_package(Boost REQUIRED)
find_package(Simbody REQUIRED)
find_package(Ceres REQUIRED)
# Ipopt 3.11 needs pkg-config's flags (HAVE_CSTDDEF); its headers are in coin/.
pkg_check_modules(IPOPT REQUIRED IMPORTED_TARGET ipopt)
# The C++ build of NLopt is the one that has StoGO and AGS.
find_library(SINEW_NLOPT_CXX nlopt_cxx REQUIRED)
find_path(SINEW_NLOPT_INCLUDE nlopt.h REQUIRED)
