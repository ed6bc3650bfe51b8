#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/temporary_folder.h"

namespace relume::test {

/// Writes a small file that tests make by hand, and returns its path.
inline std::string writeFile(const TemporaryFolder& folder, const std::string& name,
                             const std::string& text) {
    const std::string path = folder.path(name);
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    std::ofstream(path, std::ios::binary) << text;
    return path;
}

/// A floor of two triangles in .obj, facing up, without material or normals.
inline const char* kFloorObj = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 4 3 2 1\n";

/// A file of COLLADA with one square of 100 x 100 cm in the plane of X and Y, Z up, that stands in two nodes,
/// one of them mirrored; with a point light, a sun, a spot, an ambient light and a camera.
inline const char* kRoomDae = R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
  <library_cameras><camera id="View" name="View"><optics><technique_common><perspective>
    <xfov>90</xfov><aspect_ratio>2</aspect_ratio><znear>10</znear><zfar>10000</zfar>
  </perspective></technique_common></optics></camera></library_cameras>
  <library_lights>
    <light id="Lamp"><technique_common><point><color>2 1 0</color><constant_attenuation>0</constant_attenuation>
      <linear_attenuation>0</linear_attenuation><quadratic_attenuation>0.0004</quadratic_attenuation>
    </point></technique_common></light>
    <light id="Sun"><technique_common><directional><color>3 3 3</color></directional></technique_common></light>
    <light id="Spot"><technique_common><spot><color>1 1 1</color><falloff_angle>60</falloff_angle>
      <falloff_exponent>0.15</falloff_exponent></spot></technique_common></light>
    <light id="Sky"><technique_common><ambient><color>0.1 0.2 0.3</color></ambient></technique_common></light>
  </library_lights>
  <library_effects><effect id="Paint-fx"><profile_COMMON><technique sid="common"><lambert>
    <emission><color>0 4 0 1</color></emission><diffuse><color>0.25 0.5 0.75 1</color></diffuse>
  </lambert></technique></profile_COMMON></effect></library_effects>
  <library_materials><material id="Paint" name="Paint"><instance_effect url="#Paint-fx"/></material>
  </library_materials>
  <library_geometries><geometry id="Square" name="Square"><mesh>
    <source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 100 100 0 0 100 0</float_array>
      <technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
      <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <polylist material="m" count="1"><input semantic="VERTEX" source="#v" offset="0"/>
      <vcount>4</vcount><p>0 1 2 3</p></polylist>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="S">
    <node id="Floor"><instance_geometry url="#Square"><bind_material><technique_common>
      <instance_material symbol="m" target="#Paint"/></technique_common></bind_material></instance_geometry></node>
    <node id="Mirrored"><translate>0 0 200</translate><scale>1 -1 3</scale>
      <instance_geometry url="#Square"><bind_material><technique_common>
      <instance_material symbol="m" target="#Paint"/></technique_common></bind_material></instance_geometry></node>
    <node id="LampNode"><translate>100 200 300</translate><instance_light url="#Lamp"/></node>
    <node id="SunNode"><instance_light url="#Sun"/></node>
    <node id="SpotNode"><rotate>1 0 0 90</rotate><instance_light url="#Spot"/></node>
    <node id="SkyNode"><instance_light url="#Sky"/></node>
    <node id="ViewNode"><translate>0 0 100</translate><rotate>1 0 0 90</rotate>
      <instance_camera url="#View"/></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#S"/></scene>
</COLLADA>
)";

/// A .fbx file (as text) in metres, Z up, with a floor of 2 x 3 m at a height of 5 m and a sun.
inline const char* kFloorFbx = R"(; FBX 7.3.0 project file
FBXHeaderExtension:  {
 FBXHeaderVersion: 1003
 FBXVersion: 7300
 Creator: "Made by hand"
}
GlobalSettings:  {
 Version: 1000
 Properties70:  {
  P: "UpAxis", "int", "Integer", "",2
  P: "UpAxisSign", "int", "Integer", "",1
  P: "FrontAxis", "int", "Integer", "",1
  P: "FrontAxisSign", "int", "Integer", "",-1
  P: "CoordAxis", "int", "Integer", "",0
  P: "CoordAxisSign", "int", "Integer", "",1
  P: "UnitScaleFactor", "double", "Number", "",100
 }
}
Objects:  {
 Geometry: 1000, "Geometry::Floor", "Mesh" {
  Vertices: *12 {
   a: 0,0,0,2,0,0,2,3,0,0,3,0
  }
  PolygonVertexIndex: *4 {
   a: 0,1,2,-4
  }
  GeometryVersion: 124
  LayerElementMaterial: 0 {
   Version: 101
   Name: ""
   MappingInformationType: "AllSame"
   ReferenceInformationType: "IndexToDirect"
   Materials: *1 {
    a: 0
   }
  }
  Layer: 0 {
   Version: 100
   LayerElement:  {
    Type: "LayerElementMaterial"
    TypedIndex: 0
   }
  }
 }
 Model: 2000, "Model::Floor", "Mesh" {
  Version: 232
  Properties70:  {
   P: "Lcl Translation", "Lcl Translation", "", "A",0,0,5
  }
 }
 NodeAttribute: 3000, "NodeAttribute::Lamp", "Light" {
  Properties70:  {
   P: "LightType", "enum", "", "",1
   P: "Color", "Color", "", "A",1,0.5,0.25
   P: "Intensity", "Number", "", "A",200
   P: "DecayType", "enum", "", "",0
  }
  TypeFlags: "Light"
 }
 Model: 4000, "Model::Lamp", "Light" {
  Version: 232
 }
 Material: 5000, "Material::Paint", "" {
  Version: 102
  ShadingModel: "lambert"
  Properties70:  {
   P: "DiffuseColor", "Color", "", "A",0.25,0.5,0.75
   P: "Opacity", "double", "Number", "",0.5
  }
 }
}
Connections:  {
 C: "OO",2000,0
 C: "OO",4000,0
 C: "OO",1000,2000
 C: "OO",3000,4000
 C: "OO",5000,2000
}
)";

/// A chunk of a .3ds file.
inline std::string chunk3ds(uint16_t id, const std::string& content) {
    const auto length = static_cast<uint32_t>(6 + content.size());
    std::string head(6, '\0');
    std::memcpy(head.data(), &id, sizeof(id));
    std::memcpy(head.data() + 2, &length, sizeof(length));
    return head + content;
}

template<typename T>
std::string bytesOf(std::initializer_list<T> values) {
    return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(T)};
}

/// A mesh of a .3ds file: two triangles that meet at a right angle; the chunk of their smoothing groups.
inline std::string wedge3ds(const std::string& groups) {
    const std::string vertices =
        bytesOf<uint16_t>({4}) + bytesOf<float>({0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 1});
    const std::string faces = bytesOf<uint16_t>({2, 0, 1, 2, 0, 0, 2, 3, 0}) + groups;
    return chunk3ds(0x4100, chunk3ds(0x4110, vertices) + chunk3ds(0x4120, faces));
}

/// A .3ds file of objects, each a name and a chunk, and what is behind them.
inline std::string file3ds(const std::vector<std::pair<std::string, std::string>>& objects,
                           const std::string& behind = "") {
    std::string all;
    for (const auto& [name, content] : objects)
        all += chunk3ds(0x4000, name + '\0' + content);
    return chunk3ds(0x4d4d, chunk3ds(0x3d3d, all) + behind);
}

/// A .3ds file of one triangle.
inline std::string triangle3ds() {
    const std::string vertices = bytesOf<uint16_t>({3}) + bytesOf<float>({0, 0, 0, 2, 0, 0, 0, 3, 0});
    const std::string faces = bytesOf<uint16_t>({1, 0, 1, 2, 0});
    return file3ds({{"Wedge", chunk3ds(0x4100, chunk3ds(0x4110, vertices) + chunk3ds(0x4120, faces))}});
}

/// Good files, each with its ending, to be mutated.
inline std::vector<std::pair<std::string, std::string>> filesToMutate() {
    return {{".obj", std::string("mtllib m.mtl\nusemtl m\ns 1\n") + kFloorObj + "f -4 -3 -2\n"},
            {".dae", kRoomDae},
            {".3ds", triangle3ds()}};
}

/// Changes some bytes of a text, by numbers that are the same every time.
inline std::string mutated(std::string text, uint32_t seed) {
    std::mt19937 random(seed);
    const uint32_t changes = 1 + random() % 3;
    for (uint32_t i = 0; i < changes && !text.empty(); ++i) {
        const size_t at = random() % text.size();
        const uint32_t kind = random() % 4;
        if (kind == 0) text[at] = static_cast<char>(random());
        if (kind == 1) text[at] = static_cast<char>('0' + random() % 10);
        if (kind == 2) text.erase(at, 1 + random() % 16);
        if (kind == 3) text.insert(at, text.substr(random() % text.size(), 1 + random() % 32));
    }
    return text;
}

} // namespace relume::test
