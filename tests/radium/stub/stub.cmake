# Radium::Core and Radium::Engine for the tests of plugins/radium where Radium is not installed. Every header of Radium that
# the adapter or its tests include is listed here, and leads to radium.hpp.
foreach(header Core/Asset/BlinnPhongMaterialData Core/Geometry/StandardAttribNames Core/Geometry/TriangleMesh Core/Tasks/Task
               Core/Tasks/TaskQueue Core/Types Core/Utils/Color Core/Utils/Index Engine/Data/BlinnPhongMaterial Engine/Data/Mesh
               Engine/FrameInfo Engine/RadiumEngine Engine/Rendering/RenderObject Engine/Rendering/RenderObjectManager
               Engine/Scene/Component Engine/Scene/Entity Engine/Scene/EntityManager Engine/Scene/GeometryComponent
               Engine/Scene/GeometrySystem Engine/Scene/System Engine/Scene/SystemDisplay)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/stub/${header}.hpp CONTENT "#include <radium.hpp>\n")
endforeach()
find_package(Eigen3 REQUIRED)
add_library(radium_stub INTERFACE)
target_include_directories(radium_stub INTERFACE ${CMAKE_CURRENT_BINARY_DIR}/stub ${CMAKE_CURRENT_LIST_DIR})
target_link_libraries(radium_stub INTERFACE Eigen3::Eigen)
add_library(Radium::Core ALIAS radium_stub)
add_library(Radium::Engine ALIAS radium_stub)
