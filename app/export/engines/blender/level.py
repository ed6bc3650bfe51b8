# Opens a level that Relume exported, lit by its lightmap (Blender 3.4 or newer):
#
#     blender --python level.py
#
# Every lit material shows lightmap x base colour as emission; no lamp and no bake is needed. Lightmap and emission are
# in cd/m^2; the scene's exposure (Render Properties, Color Management) brings them to the screen.
import json
import os
import struct

import bpy
import numpy

folder = os.path.dirname(os.path.abspath(__file__))
exposure = @EV@  # [EV], at which Relume showed the level
LONGEST_NAME = 60  # [bytes]; Blender before 5.0 cuts names at 63, at a whole letter


def lit_materials(path):
    """Returns the pages of the lightmap by the names of the materials that they light."""
    with open(path, "rb") as file:
        length = struct.unpack("<5I", file.read(20))[3]
        materials = json.loads(file.read(length)).get("materials", [])
    return {m["name"]: m.get("extras", {}).get("relume", {}).get("page", 0)
            for m in materials if "MOZ_lightmap" in m.get("extensions", {})}


def light(material, picture):
    """Adds lightmap x base colour x (1 - metallic) to what a material of the glTF importer emits."""
    tree = material.node_tree
    nodes, links = tree.nodes, tree.links
    surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")

    def value_of(name):
        """Returns a socket with what the surface's input of that name has."""
        socket = surface.inputs[name]
        if socket.is_linked:
            return socket.links[0].from_socket
        is_color = socket.type == "RGBA"
        node = nodes.new("ShaderNodeRGB" if is_color else "ShaderNodeValue")
        node.outputs[0].default_value = socket.default_value
        return node.outputs[0]

    def emission_of(color, strength):
        node = nodes.new("ShaderNodeEmission")
        links.new(color, node.inputs["Color"])
        links.new(strength, node.inputs["Strength"])
        return node.outputs[0]

    uv = nodes.new("ShaderNodeUVMap")
    uv.uv_map = "UVMap.001"  # TEXCOORD_1
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = picture
    texture.extension = "EXTEND"
    links.new(uv.outputs[0], texture.inputs[0])
    product = nodes.new("ShaderNodeVectorMath")
    product.operation = "MULTIPLY"
    links.new(texture.outputs["Color"], product.inputs[0])
    links.new(value_of("Base Color"), product.inputs[1])
    diffuse = nodes.new("ShaderNodeMath")
    diffuse.operation = "SUBTRACT"
    diffuse.inputs[0].default_value = 1.0
    links.new(value_of("Metallic"), diffuse.inputs[1])
    reflected = emission_of(product.outputs[0], diffuse.outputs[0])
    # Since Blender 4.0 the input has another name.
    color = "Emission Color" if "Emission Color" in surface.inputs else "Emission"
    emitted = emission_of(value_of(color), value_of("Emission Strength"))
    both = nodes.new("ShaderNodeAddShader")
    links.new(reflected, both.inputs[0])
    links.new(emitted, both.inputs[1])
    shown = both.outputs[0]
    if surface.inputs["Alpha"].is_linked:
        mix = nodes.new("ShaderNodeMixShader")
        links.new(value_of("Alpha"), mix.inputs[0])
        links.new(nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
        links.new(shown, mix.inputs[2])
        shown = mix.outputs[0]
    links.new(shown, output.inputs["Surface"])


def page_of(material, lit):
    """Returns the page that lights a material, whose name Blender may have cut, or None."""
    name = material.name
    if name in lit:
        return lit[name]
    if len(name.encode()) < LONGEST_NAME or not any(whole.startswith(name) for whole in lit):
        return None
@ONE@    return 0
@MANY@    return dict(material.get("relume", {})).get("page", 0)  # the file's extras


# Debian 12 has Blender 3.4 with NumPy 1.24, which left out a name that this Blender's importer asks for.
if not hasattr(numpy, "bool"):
    numpy.bool = bool
bpy.ops.wm.read_factory_settings(use_empty=True)
level = os.path.join(folder, "scene.glb")
bpy.ops.import_scene.gltf(filepath=level)
@ONE@names = ["lightmap.exr"]
@MANY@names = [f"lightmap.{page}.exr" for page in range(@PAGES@)]
lightmaps = [bpy.data.images.load(os.path.join(folder, name)) for name in names]
for lightmap in lightmaps:
    lightmap.colorspace_settings.name = "Non-Color"
lit = lit_materials(level)
for material in bpy.data.materials:
    page = page_of(material, lit)
    if page is not None:
        light(material, lightmaps[page])
scene = bpy.context.scene
scene.view_settings.exposure = exposure
cameras = [thing for thing in scene.objects if thing.type == "CAMERA"]
if cameras:
    scene.camera = cameras[0]
